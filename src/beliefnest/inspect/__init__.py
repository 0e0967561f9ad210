"""Scenarios and suites as tasks of Inspect AI (the extra `inspect`): `registry.py` has them all."""

from importlib.util import find_spec

from beliefnest.errors import MissingExtraError

if find_spec("inspect_ai") is None:
    raise MissingExtraError("tasks of Inspect AI need it", "inspect")
