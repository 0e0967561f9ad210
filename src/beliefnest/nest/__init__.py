"""Simulators of beliefs: their recorded past, their bodies, explanations, and their face."""
