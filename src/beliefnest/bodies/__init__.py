"""Where simulators are acted out: worlds, bodies, and the channel to Minecraft."""
