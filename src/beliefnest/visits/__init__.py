"""Beliefs that stand in Minecraft for people to visit."""
