"""Belief states and how they are updated."""
