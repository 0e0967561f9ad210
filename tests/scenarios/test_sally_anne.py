"""The built-in experiment, acted out by bots: what is believed, predicted, and repeated."""

import hashlib
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

import beliefnest as bn
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.outcome import Outcome
from beliefnest.scenarios.running import run_scenario
from beliefnest.timeline import codec
from beliefnest.timeline.store import Journal
from beliefnest.worlds.by_name import Worlds

pytestmark = pytest.mark.usefixtures("kept_worlds")

FILE = Path(bn.__file__).parent / "scenarios" / "builtin" / "sally-anne.yaml"
LEFT, RIGHT = (-2, -51, -4), (2, -51, -4)
BELIEFS = {
    1: {"/": RIGHT, "/observer": RIGHT, "/sally": LEFT, "/observer/sally": LEFT},
    2: {"/": RIGHT, "/observer": RIGHT, "/sally": RIGHT, "/observer/sally": RIGHT},
    3: {"/": RIGHT, "/observer": RIGHT, "/sally": RIGHT, "/observer/sally": LEFT},
}


def run(
    scenario: bn.Scenario,
    store: Path | None = None,
    seed: int = 0,
    worlds: Worlds | None = None,
) -> Outcome:
    with bn.Nest.open(scenario, store=store, seed=seed, worlds=worlds) as nest:
        return run_scenario(
            nest,
            scenario,
            OfflineModel(),
            seed,
            time.perf_counter(),
            lambda what, done, total: None,
        )


def diamonds(outcome: Outcome, path: str) -> list[tuple[int, int, int]]:
    containers = outcome.state(path).containers
    return [place for place, held in containers.items() if held.items.get("diamond")]


@pytest.mark.parametrize("condition", [1, 2, 3])
def test_beliefs_and_prediction_are_those_of_the_paper(condition: int) -> None:
    outcome = run(bn.Scenario.load("sally-anne", condition))
    assert {path: diamonds(outcome, path) for path in BELIEFS[condition]} == {
        path: [place] for path, place in BELIEFS[condition].items()
    }
    (probe,) = outcome.probes
    assert probe.opened[0] == BELIEFS[condition]["/observer/sally"]
    assert outcome.ok


def test_what_was_predicted_changed_nothing_anywhere_else() -> None:
    scenario = bn.Scenario.load("sally-anne", 2)
    with bn.Nest.open(scenario) as nest:
        nest.play()
        paths = ("/", "/observer", "/sally", "/observer/sally")
        before = {path: (nest[path].tick, nest[path].state.containers) for path in paths}
        nest["/observer"].switch("take it away")
        program = "await getItemFromChest(bot, new Vec3(2, -51, -4), {diamond: 1})"
        assert nest["/observer"].run("sally", program).ok
        assert not nest["/observer"].state.containers[RIGHT].items
        assert nest["/"].state.containers[RIGHT].items == {"diamond": 1}
        nest["/observer"].switch("follow")
        assert {p: (nest[p].tick, nest[p].state.containers) for p in paths} == before


def mirrored(value: Any) -> Any:
    """Exchange east and west in a scenario's content."""
    if isinstance(value, dict):
        return {key: mirrored(child) for key, child in value.items()}
    if isinstance(value, list) and len(value) == 3 and all(isinstance(v, int) for v in value):
        return [-value[0], *value[1:]]
    if isinstance(value, list) and len(value) == 3 and isinstance(value[0], float):
        return [1 - value[0], *value[1:]]
    if isinstance(value, list):
        return [mirrored(child) for child in value]
    if isinstance(value, str):
        value = re.sub(r"Vec3\((-?\d+)", lambda match: f"Vec3({-int(match[1])}", value)
        return {"east": "west", "west": "east"}.get(value, value)
    return value


@pytest.mark.parametrize("condition", [1, 2, 3])
def test_the_mirror_image_gives_mirrored_answers(condition: int) -> None:
    content = mirrored(YAML(typ="safe").load(FILE.read_text(encoding="utf-8")))
    outcome = run(bn.Scenario.from_mapping(content, condition))
    for path, (x, y, z) in BELIEFS[condition].items():
        assert diamonds(outcome, path) == [(-x, y, z)], path
    x, y, z = BELIEFS[condition]["/observer/sally"]
    assert outcome.probes[0].opened[0] == (-x, y, z)


@pytest.mark.parametrize(("x", "believed"), [(2, [RIGHT]), (3, []), (4, [LEFT])])
def test_answers_follow_when_sally_stands_a_block_to_either_side_of_the_edge_of_sight(
    x: int, believed: list[tuple[int, int, int]]
) -> None:
    # The wall begins at x = 3. Past its end she sees Anne at both chests; from right behind its
    # end only at the left one, so that the diamond is gone and nowhere; one block on nothing.
    content = YAML(typ="safe").load(FILE.read_text(encoding="utf-8"))
    content["script"][1]["program"] = f"await goToPosition(bot, new Vec3({x}, -51, 2), 0);"
    outcome = run(bn.Scenario.from_mapping(content))
    assert diamonds(outcome, "/sally") == believed
    assert diamonds(outcome, "/observer/sally") == believed
    assert diamonds(outcome, "/observer") == [RIGHT]
    if believed:
        assert outcome.probes[0].opened[0] == believed[0]


def fingerprint(store: Path) -> str:
    """Return a hash of everything recorded: every frame of every timeline, byte for byte."""
    digest = hashlib.sha256()
    with Journal.read(store) as journal:
        for info in journal.timelines():
            digest.update(repr((info.key, info.base, info.start, info.head)).encode())
            for entry in journal.entries(info.key, 0, info.entries):
                digest.update(codec.encode_entry(entry))
    return digest.hexdigest()


@pytest.mark.long
def test_the_same_seed_gives_the_same_frames_under_load_as_well(tmp_path: Path) -> None:
    def record(name: str) -> list[str]:
        prints = []
        with Worlds(7) as worlds:
            for scenario in bn.Scenario.load_all("sally-anne"):
                store = tmp_path / f"{name}-{scenario.condition}.bn"
                run(scenario, store, 7, worlds)
                prints.append(fingerprint(store))
        return prints

    first = record("first")
    assert len(set(first)) == 3
    load = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        assert record("loaded") == first
    finally:
        load.kill()
        load.wait()
