"""Nodes that join a head later: folded together, they are as if each was asked for alone."""

from typing import Any

import pytest

import beliefnest as bn
from beliefnest.belief.forest import Forest
from beliefnest.nest.past import history
from beliefnest.nest.past.history import StateHistory
from beliefnest.world.paths import path_text

AGENTS = ("ann", "bob", "carl")


def played() -> bn.Nest:
    """Return a nest after some ticks in which agents lose sight of each other."""
    world = bn.ScriptedWorld(
        ((0, 0, 0), (8, 3, 8)),
        blocks={(4, y, z): "stone" for y in (1, 2, 3) for z in range(6)},
        agents={"ann": (2.5, 1, 2.5), "bob": (6.5, 1, 7.5), "carl": (2.5, 1, 6.5)},
        containers={(2, 1, 7): {"apple": 2}},
    )
    nest = bn.Nest(world)
    world.place_agent("bob", (6.5, 1, 2.5))
    world.withdraw("carl", (2, 1, 7), {"apple": 1})
    world.place_agent("ann", (3.5, 1, 7.5))
    return nest


def test_nodes_of_several_imaginations_are_folded_as_each_alone() -> None:
    paths = [(one, *other) for one in AGENTS for other in ((), *((name,) for name in AGENTS))]
    paths = [path for path in paths if len(path) == 1 or path[0] != path[1]]
    with played() as nest:
        minds = {agent: nest[f"/{agent}"].imagination(1) for agent in AGENTS}
        together = {path: nest[path_text(path)].state for path in paths}
    for path in paths:
        with played() as alone:
            wanted = alone[path_text(path)].state
            assert together[path].agents == wanted.agents
            assert together[path].containers == wanted.containers
            assert list(together[path].blocks) == list(wanted.blocks)
            view = minds[path[0]].view(path[1:])
            assert view.grid.tolist() == wanted.blocks.grid.tolist()
            assert {n: a.position for n, a in view.agents.items()} == {
                n: a.position for n, a in wanted.agents.items()
            }


def test_beliefs_of_the_past_asked_one_by_one_share_few_forests(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    names = [f"a{number:02}" for number in range(16)]
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (20, 3, 20)),
        agents={name: (i + 0.5, 1, 1.5) for i, name in enumerate(names)},
    )
    nest = bn.Nest(world)
    recording = nest._recording
    for tick in range(12):
        with world.tick():
            world.place_agent("a03", (3.5, 1, tick + 2.5))
    begun = []
    whole = history.initial_forest

    def counted(*args: Any) -> Forest:
        begun.append(whole(*args))
        return begun[-1]

    monkeypatch.setattr(history, "initial_forest", counted)
    states = {}
    for tick in (3, 6, 9):
        past = nest.at(tick)
        states[tick] = [past[f"/{name}"].state for name in names]
    # Groups double; later ticks go on with what is folded.
    assert len(begun) <= 6
    kept = recording.history._pasts
    assert len(kept) <= 4
    assert len({id(state._forest) for each in states.values() for state in each}) == 1
    for tick, found in states.items():
        for name, state in zip(names, found, strict=True):
            alone = StateHistory(recording.journal, recording.setting)
            key = recording.controller(())
            moment = recording.moment((name,), tick)
            assert state == alone.state(key, (name,), moment.entries, tick)
