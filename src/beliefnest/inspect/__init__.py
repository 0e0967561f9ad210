"""Scenarios, suites and episodes as tasks of Inspect AI (extra `inspect`)."""

import beliefnest.adapters.inspect_ai  # noqa: F401  # refuses to be imported without the extra
