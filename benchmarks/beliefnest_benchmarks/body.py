"""Benchmarks of making a body for a belief."""

import json
import tempfile
from collections.abc import Sequence
from pathlib import Path

from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_RUNS = 20
_WIDTH = 200
_HEIGHT = 64
_FLOOR = -52


def measure() -> Sequence[Metric]:
    """Return the times of forks of `/observer` with three agents: blocks, chests and bots."""
    body = "a body for a belief with three agents"
    return [
        Metric(body, _fork(Scenario.load("sally-anne")), "s", 0.3),
        Metric(f"{body} in {_WIDTH} x {_HEIGHT} x {_WIDTH} blocks", _fork(_plain()), "s", 0.3),
    ]


def _fork(scenario: Scenario) -> float:
    """Return the median time of a fork of `/observer`, in seconds."""
    numbers = iter(range(_RUNS + 1))
    with Nest.open(scenario) as nest:
        nest.play()
        belief = nest["/observer"]

        def fork() -> None:
            belief.switch("follow")
            belief.switch(f"try {next(numbers)}")

        fork()
        return median_seconds(fork, _RUNS)


def _plain() -> Scenario:
    """Return a plain with three agents between four houses; nobody sees into them."""
    feet, middle = _FLOOR + 1, _WIDTH // 2
    houses = [(middle + x, middle + z) for x in (-60, 20) for z in (-60, 20)]
    document = {
        "name": "plain",
        "box": [[0, _FLOOR, 0], [_WIDTH - 1, _FLOOR + _HEIGHT - 1, _WIDTH - 1]],
        "blocks": [
            {"block": "stone", "fill": [[0, _FLOOR, 0], [_WIDTH - 1, _FLOOR, _WIDTH - 1]]},
            *(
                {"block": "oak_planks", "walls": [[x, feet, z], [x + 9, feet + 4, z + 9]]}
                for x, z in houses
            ),
        ],
        "agents": {
            name: {"position": [middle + 3 * number + 0.5, feet, middle + 0.5]}
            for number, name in enumerate(("observer", "anne", "sally"))
        },
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plain.yaml"
        path.write_text(json.dumps(document))
        return Scenario.load(str(path))
