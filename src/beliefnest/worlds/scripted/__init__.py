"""Scripted world: no Minecraft, no physics; all in this process."""
