"""Many branches: any of them can be read, and those not looked at take no memory."""

import random
from types import SimpleNamespace
from typing import Any

import pytest
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.nest.past import heads
from beliefnest.timeline.journal import TimelineKey

DEEP = 260
"""Branches of branches; calls within calls for each of them would be more than Python allows."""
STORES = [None, "run.bn"]


def opened(store: str | None) -> bn.Nest:
    """Return a nest of two agents, a chest and a wall."""
    world = bn.ScriptedWorld(
        ((0, 0, 0), (8, 3, 8)),
        blocks={(4, y, z): "stone" for y in (1, 2, 3) for z in range(6)},
        agents={"ann": (2.5, 1, 2.5), "bob": (2.5, 1, 6.5)},
        containers={(2, 1, 7): {"apple": 2}},
    )
    return bn.Nest(world, store=store)


def act(simulator: bn.Simulator, number: int) -> None:
    """Let Bob walk on a branch, and sometimes speak."""
    with simulator.scripted.tick():
        simulator.scripted.place_agent("bob", (number % 3 + 0.5, 1, 6.5), number / 5)
    if number % 7 == 0:
        simulator.scripted.say("bob", f"{number}")


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("store", "acts"),
    few_by_day([("run.bn", True), ("run.bn", False), (None, True), (None, False)]),
)
def test_a_branch_of_very_many_branches_is_read(store: str | None, acts: bool) -> None:
    with opened(store) as nest:
        ann = nest["/ann"]
        for number in range(DEEP):
            ann.switch(f"branch {number}")
            if acts:
                act(ann, number)
        belief = nest["/ann/bob"]
        written = repr(belief.state), list(belief.state.blocks), belief.state.chat
        bases = [ann.state.blocks.basis(place) for place in ((4, 1, 3), (0, 0, 0))]
        current = ann.state.blocks.current((4, 1, 3)), belief.state.blocks.current((4, 1, 3))
        assert any(bases) and any(current) and (len(written[2]) > 20) is acts
    if store is None:
        return
    with bn.Nest.read(store) as run:
        again = run["/ann/bob"].state
        assert (repr(again), list(again.blocks), again.chat) == written
        blocks = run["/ann"].state.blocks
        assert [blocks.basis(place) for place in ((4, 1, 3), (0, 0, 0))] == bases
        assert (blocks.current((4, 1, 3)), again.blocks.current((4, 1, 3))) == current


@pytest.fixture(scope="module")
def kept() -> list[str]:
    """Return what is seen where all forests are kept."""
    return walked(None)


@pytest.mark.parametrize("store", STORES, ids=["memory", "file"])
def test_branches_are_the_same_whose_forests_were_dropped(
    store: str | None, kept: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert walked(store, monkeypatch) == kept


def walked(store: str | None, monkeypatch: pytest.MonkeyPatch | None = None) -> list[str]:
    """Go to and fro between branches, act and look; with few forests if there is a monkeypatch."""
    if monkeypatch is not None:
        monkeypatch.setattr(heads, "_BYTES", 0)
        monkeypatch.setattr(heads, "_FEW", 2)
    chance, seen, made = random.Random(3), [], 0
    with opened(store) as nest:
        for number in range(150):
            simulator = nest[chance.choice(["/", "/ann", "/ann/bob"])]
            made += 1
            known = [info.key.branch for info in simulator.branches()]
            name = chance.choice([f"new {made}", *known[-6:]])
            simulator.switch(name)
            act(simulator, number)
            for path in chance.sample(["/", "/ann", "/bob", "/ann/bob", "/bob/ann"], 2):
                state = nest[path].state
                seen.append(f"{path} {state!r} {dict(state.agents)} {state.chat}")
    return seen


def test_forests_are_dropped_that_were_used_longest_ago() -> None:
    dropped: list[str] = []
    kept = heads.Heads(lambda key, forest: dropped.append(key.branch), most=1000)
    keys = [TimelineKey((), str(number)) for number in range(heads._FEW + 3)]
    for key in keys[: heads._FEW]:
        kept.put(key, forest(300))
    assert dropped == []
    assert kept.get(keys[0]) is not None
    kept.put(keys[-1], forest(300))
    assert dropped == ["1"]
    assert kept.get(keys[1]) is None
    small = heads.Heads(lambda key, forest: dropped.append(key.branch), most=10_000)
    grown = forest(10)
    small.put(keys[0], grown)
    grown.bytes = 20_000
    for key in keys[1:]:
        small.put(key, forest(10))
    assert dropped == ["1", "0"]


def forest(size: int) -> Any:
    """Return an object of the size of a forest."""
    return SimpleNamespace(bytes=size)
