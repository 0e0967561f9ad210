"""Scenario files, what they mean, and how they are run and judged."""

from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected import (
    Answers,
    Arrives,
    Believes,
    Expectation,
    Expected,
    Hears,
    Holds,
    Intends,
    Judge,
    Opens,
    Reads,
    Says,
    Stands,
    Takes,
)
from beliefnest.scenarios.scenario import Scenario

__all__ = [
    "Answers",
    "Arrives",
    "Believes",
    "Expectation",
    "Expected",
    "Hears",
    "Holds",
    "Intends",
    "Judge",
    "Opens",
    "Probe",
    "Reads",
    "Says",
    "Scenario",
    "Stands",
    "Takes",
]
