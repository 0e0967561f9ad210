"""Scenario files, what they mean, and how they are run and judged."""

from beliefnest.scenarios.scenario import (
    Arrives,
    Expectation,
    Hears,
    Holds,
    Opens,
    Probe,
    Scenario,
    Stands,
)

__all__ = ["Arrives", "Expectation", "Hears", "Holds", "Opens", "Probe", "Scenario", "Stands"]
