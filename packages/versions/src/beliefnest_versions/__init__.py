"""Data of further Minecraft versions, one file each; BeliefNest finds them beside this module."""
