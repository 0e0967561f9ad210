"""Scenarios and suites as tasks of Inspect AI (extra `inspect`); see `registry.py`."""

from importlib.util import find_spec

from beliefnest.errors import MissingExtraError

if find_spec("inspect_ai") is None:
    raise MissingExtraError("tasks of Inspect AI need inspect_ai", "inspect")
