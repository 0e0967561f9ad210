"""Scenario files, what they mean, and how they are run and judged."""

from beliefnest.scenarios.content import Arrives, Expectation, Hears, Holds, Opens, Probe, Stands
from beliefnest.scenarios.scenario import Scenario

__all__ = ["Arrives", "Expectation", "Hears", "Holds", "Opens", "Probe", "Scenario", "Stands"]
