"""Scenarios, suites and episodes as tasks of Inspect AI (extra `inspect`)."""

from beliefnest.adapters import inspect_ai

__all__ = ["inspect_ai"]
