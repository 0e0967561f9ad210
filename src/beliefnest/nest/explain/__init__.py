"""Explanations of beliefs, and differences between simulators."""
