"""Embedded Minecraft: Node, the channel to it, and the bodies in it. `node/` is its JavaScript."""
