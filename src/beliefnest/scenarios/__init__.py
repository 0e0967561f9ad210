"""Scenario files, what they mean, and how they are run and judged."""

from beliefnest.scenarios.scenario import Scenario

__all__ = ["Scenario"]
