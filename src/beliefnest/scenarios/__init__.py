"""Scenarios: files, their meaning, and how they are run and judged."""

from beliefnest.scenarios.scenario import Scenario

__all__ = ["Scenario"]
