"""Worlds in which simulators are acted out, the bodies in them, and the channel to Minecraft."""
