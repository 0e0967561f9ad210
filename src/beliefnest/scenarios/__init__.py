"""Scenario files, what they mean, and how they are run and judged."""
