"""Worlds in real time: Minecraft servers elsewhere, and our own server that people join."""
