"""A built-in scenario that is stopped and resumed at any moment goes on as if it never stopped."""

import random
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from tests.profiles import at_night, few_by_day

import beliefnest as bn
from beliefnest.scenarios.sources import builtin_names
from beliefnest.timeline.journal import Entry, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.worlds.by_name import Worlds

SEED = 6
LEAP = """
await bot.look(6 * Math.random(), 0, true)
bot.setControlState('forward', true)
bot.setControlState('jump', true)
await bot.waitForTicks(4)
bot.chat('here ' + bot.entity.position + Math.random())"""

Act = Callable[[bn.Nest], object]


class StopError(Exception):
    """Ends the script half-way."""


def play_until(step: int) -> Act:
    def act(nest: bn.Nest) -> None:
        def on_progress(_what: str, done: int, _total: int) -> None:
            if done == step:
                raise StopError

        with suppress(StopError):
            nest.play(on_progress)

    return act


def acts_of(scenario: bn.Scenario) -> list[Act]:
    """Return the acts: steps of the script, then leaps in the simulators of probes."""
    acts = [play_until(step) for step in range(1, len(scenario.setting.script) + 1)]
    for number, probe in enumerate(scenario.probes):
        path, agent = probe.acts_in, probe.agent
        acts.append(lambda nest, path=path, name=f"plan {number}": nest[path].switch(name))
        acts += [lambda nest, path=path, agent=agent: nest[path].run(agent, LEAP)] * 2
        acts.append(lambda nest, path=path: nest[path].step(3))
        acts += [lambda nest, agent=agent: nest["/"].run(agent, LEAP)]
    return acts


def played(
    scenario: bn.Scenario, acts: list[Act], cuts: set[int], store: Path, worlds: Worlds
) -> dict[TimelineKey, tuple[int, list[Entry]]]:
    """All timelines, after a run that is stopped before some of its acts."""
    nest = bn.Nest.open(scenario, store=store, seed=SEED, worlds=worlds)
    for number, act in enumerate(acts):
        if number in cuts:
            nest.close()
            nest = bn.Nest.resume(store, worlds=worlds)
        act(nest)
    nest.close()
    with Journal.read(store) as journal:
        return {
            info.key: (info.head, list(journal.entries(info.key, 0, info.entries)))
            for info in journal.timelines()
        }


@pytest.fixture(scope="module")
def worlds():
    with Worlds(SEED) as lent:
        yield lent


@pytest.mark.parametrize("name", few_by_day(builtin_names(), 4))
def test_a_run_that_was_stopped(name, worlds, tmp_path):
    draw = random.Random(SEED)
    for number, scenario in enumerate(bn.Scenario.load_all(name)[: at_night(99, 1)]):
        acts = acts_of(scenario)
        wanted = played(scenario, acts, set(), tmp_path / f"{number}.bn", worlds)
        assert len(wanted) > 1 or not scenario.probes
        for time in range(at_night(10, 1)):
            cuts = set(draw.sample(range(1, len(acts)), min(3, len(acts) - 1)))
            found = played(scenario, acts, cuts, tmp_path / f"{number} {time}.bn", worlds)
            assert found == wanted, cuts
