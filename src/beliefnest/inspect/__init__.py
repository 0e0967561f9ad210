"""Scenarios and suites as tasks of Inspect AI (the extra `inspect`): `registry.py` has them all."""
