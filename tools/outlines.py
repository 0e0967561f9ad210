"""Write src/beliefnest/scenarios/outlines.json from the built-in scenarios."""

from pathlib import Path

import msgspec

from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import builtin_names

TARGET = Path(__file__).parents[1] / "src" / "beliefnest" / "scenarios" / "outlines.json"


def outlines() -> bytes:
    """Return the names and descriptions of the built-in scenarios, sorted by name, as JSON."""
    loaded = (Scenario.load_all(name)[0] for name in builtin_names())
    keys = ("name", "description", "conditions")
    listed = [{key: getattr(each, key) for key in keys} for each in loaded]
    return msgspec.json.format(msgspec.json.encode(listed)) + b"\n"


if __name__ == "__main__":
    TARGET.write_bytes(outlines())
