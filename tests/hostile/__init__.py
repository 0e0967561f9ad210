"""Hostile inputs of each reader: a command ends soon, whatever it reads, and says one line."""
