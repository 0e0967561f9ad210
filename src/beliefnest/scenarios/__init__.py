"""Scenarios: files, their meaning, and how they are run and judged."""
