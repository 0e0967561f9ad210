"""Write src/beliefnest/scenarios/outlines.json from the built-in scenarios."""

from pathlib import Path

import msgspec

from beliefnest.scenarios.outline import Outline
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import builtin_names


def outlines() -> tuple[Outline, ...]:
    """Return the outlines of the built-in scenarios, sorted by name."""
    loaded = (Scenario.load_all(name)[0] for name in builtin_names())
    return tuple(Outline(each.name, each.description, each.conditions) for each in loaded)


if __name__ == "__main__":
    target = Path(__file__).parents[1] / "src" / "beliefnest" / "scenarios" / "outlines.json"
    target.write_bytes(msgspec.json.format(msgspec.json.encode(outlines())) + b"\n")
