"""Simulators, paths, modes, and beliefs folded from timelines."""
