"""Frozen values every room speaks, and the scripted world."""
