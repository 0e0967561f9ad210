"""Suites: batteries of stories with questions, and of films with judgments of people."""

__all__ = ["FILMS", "SUITES"]

FILMS = "food-trucks"
"""Name of the suite of films."""

SUITES = ("hi-tom", "tomi", "stories", FILMS)
"""Names of the suites."""
