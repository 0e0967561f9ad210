"""Episodes: played, stopped, gone on with, replayed, branched; policies that fail."""

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.episodes.decided import Decision

TASK = "help-find"


class Waits:
    """Does nothing, and remembers what it was told."""

    def __init__(self) -> None:
        self.told: list[object] = []

    def act(self, view: bn.AgentView) -> str:
        self.told.append(view.last)
        return ""


class Fails:
    def act(self, view: bn.AgentView) -> str:
        raise ValueError("no idea")


def facts_of(episode: bn.Episode) -> list[object]:
    """All that happened, tick by tick, in reality and in everybody's belief."""
    nest = episode.nest
    paths = [(), *((name,) for name in nest.agents)]
    return [
        (entry.tick, {path: repr(state) for path, state in states().items()})
        for entry, states in nest.each_entry(paths, -1, nest.tick)
    ]


def test_helping_needs_that_the_other_is_told() -> None:
    task = bn.Task.load(TASK, seed=3)
    with bn.Episode(task, {"anne": Waits()}) as idle, bn.Episode(task) as helped:
        assert not idle.play().success
        assert idle.rounds == task.form.rounds
        assert helped.play().success
        assert helped.messages == 1
        ticks = [tick for _, tick in helped.conditions if tick is not None]
        assert len(ticks) == len(helped.conditions)
        tick = max(ticks)
        assert tick - helped.start == helped.ticks
        # Checked every tick, not once a round.
        sally = helped.nest.at(tick)["/"].state.agents["sally"].inventory
        before = helped.nest.at(tick - 1)["/"].state.agents["sally"].inventory
        assert len(before) == len(sally) - 1


def test_a_policy_that_fails_costs_its_own_round() -> None:
    task = bn.Task.load(TASK)
    with bn.Episode(task, {"anne": Fails()}) as episode:
        episode.play(2)
        line = Fails.act.__code__.co_firstlineno + 1
        assert [part.decisions["anne"].fault for part in episode.parts] == [
            f"test_episode.py:{line}: ValueError: no idea"
        ] * 2
        assert [part.ended["anne"].how for part in episode.parts] == ["lost", "lost"]
        assert [part.ended["sally"].how for part in episode.parts] == ["cut", "cut"]


def test_a_policy_that_is_slow_costs_its_own_round() -> None:
    released = threading.Event()

    class Slow:
        def act(self, view: bn.AgentView) -> str:
            released.wait()
            return ""

    with bn.Episode(bn.Task.load(TASK), {"anne": Slow()}, patience_s=3.0) as episode:
        try:
            episode.play(2)
        finally:
            released.set()
        faults = [part.decisions["anne"].fault for part in episode.parts]
        assert faults == ["it took more than 3 s", "it is still at an earlier round"]
        assert [part.ended["sally"].how for part in episode.parts] == ["cut", "cut"]


@pytest.mark.parametrize(
    "program",
    ["await goToPosition(bot, new Vec3(30, 1, 11), 0)", "await nonsense(", "throw 1", "\ud800"],
)
def test_what_went_wrong_is_told_as_its_agent_could_perceive_it(program: str) -> None:
    class Tries(Waits):
        def act(self, view: bn.AgentView) -> str:
            super().act(view)
            return program

    tries = Tries()
    with bn.Episode(bn.Task.load(TASK), {"anne": tries}) as episode:
        episode.play(2)
    first, last = tries.told
    assert getattr(first, "how", "") == "none"
    assert getattr(last, "how", "") in ("no_way", "failed", "lost")


def test_what_is_said_of_a_chest_that_its_agent_did_not_see_is_not_told() -> None:
    task = bn.Task.load(TASK)
    told = Waits()
    with bn.Episode(task, {"sally": told}) as episode:
        episode.play(1)
    assert all("diamond" not in str(each) for each in told.told)


@pytest.mark.parametrize("rounds", few_by_day([1, 0, 3]))
def test_a_stopped_episode_goes_on_as_if_it_had_not_stopped(tmp_path: Path, rounds: int) -> None:
    task = bn.Task.load(TASK, seed=1)
    with bn.Episode(task) as whole:
        expected = facts_of(whole.play())
        row = whole.measures
    with bn.Episode(task, store=tmp_path / "e.bn") as episode:
        episode.play(rounds)
    with bn.Episode.resume(tmp_path / "e.bn") as resumed:
        assert resumed.rounds == rounds
        assert facts_of(resumed.play()) == expected
        assert resumed.measures == row
    with bn.Episode.replay(tmp_path / "e.bn") as replayed:
        assert facts_of(replayed.play()) == expected
        assert replayed.measures == row


def test_an_episode_is_branched_at_any_round(tmp_path: Path) -> None:
    task = bn.Task.load(TASK, seed=2)
    with bn.Episode(task, {"anne": Waits()}, store=tmp_path / "e.bn") as episode:
        episode.play()
        before = facts_of(episode)
        fork = episode.at(0).fork(anne="search:1")
        fork.play()
        assert fork.branch != episode.branch
        assert fork.rounds <= episode.rounds
        said = [line[1] for line in fork.nest["/"].state.chat]
        assert said == ["anne"]
        assert fork.success
        # In the last round Sally has lost the time already.
        late = episode.at(episode.rounds - 1).fork(anne="search:1").play()
        assert not late.success
        assert facts_of(episode) == before
        assert not episode.success
        strange: list[Any] = [-1, 99, 1.5, None]
        for number in strange:
            with pytest.raises(bn.InputError, match=f"round {number} was not played"):
                episode.at(number)
    with bn.Episode.resume(tmp_path / "e.bn", {"anne": Waits()}) as resumed:
        assert resumed.branch == late.branch


@pytest.mark.parametrize("policy", [None, 5, object()])
def test_who_cannot_act_is_refused(policy: Any) -> None:
    with pytest.raises(bn.InputError, match=r"the policy of anne is .*act\(view\)"):
        bn.Episode(bn.Task.load(TASK), {"anne": policy})


def test_there_is_something_to_spend() -> None:
    for wrong in ({"ticks": 0}, {"tokens": -1}, {"cost": -0.5}):
        with pytest.raises(bn.InputError, match="of a budget is"):
            bn.Budget(**wrong)
    with pytest.raises(bn.InputError, match="patience is -1 s"):
        bn.Episode(bn.Task.load(TASK), patience_s=-1)


def test_policies_must_be_of_agents_and_exist() -> None:
    task = bn.Task.load(TASK)
    with pytest.raises(bn.InputError, match="zoe"):
        bn.Episode(task, {"zoe": "random"})
    with pytest.raises(bn.UnknownNameError, match="did you mean search:1"):
        bn.Episode(task, {"anne": "serach:1"})
    with pytest.raises(bn.InputError, match="no order"):
        bn.Episode(task, {"anne": "search:99"})
    with pytest.raises(bn.UnknownNameError, match="help-find"):
        bn.Task.load("no-such-task")
    with pytest.raises(bn.UnknownNameError, match="chests"):
        bn.Task.load(TASK, doors=3)
    with pytest.raises(bn.InputError, match="3 to 6"):
        bn.Task.load(TASK, chests=99)


def test_programs_of_files_are_cut_and_gone_on_with(tmp_path: Path) -> None:
    file = tmp_path / "walk.js"
    file.write_text("await goToPosition(bot, new Vec3(2, 1, 5), 0)")
    with bn.Episode(bn.Task.load(TASK), {"sally": f"program:{file}"}) as episode:
        episode.play()
        ended = [part.ended["sally"].how for part in episode.parts]
    assert ended[:4] == ["cut", "cut", "ok", "none"]


@pytest.mark.parametrize("round", [1, 3])
def test_a_program_begins_where_a_branch_does(tmp_path: Path, round: int) -> None:
    # Its agent's program was cut in round 1 and is over in round 3.
    walk, back, store = tmp_path / "walk.js", tmp_path / "back.js", tmp_path / "walk.bn"
    walk.write_text("await goToPosition(bot, new Vec3(2, 1, 5), 0)")
    back.write_text("await goToPosition(bot, new Vec3(14, 1, 5), 0)")
    with bn.Episode(bn.Task.load(TASK), {"sally": f"program:{walk}"}, store=store) as episode:
        fork = episode.play().at(round).fork(sally=f"program:{back}")
        fork.play(1)
    with bn.Episode.resume(store, branch=fork.branch) as resumed:
        resumed.play()
        programs = [part.decisions["sally"].program for part in resumed.parts]
        assert programs[round] == back.read_text()
        assert (
            programs.count(back.read_text())
            == sum(part.decisions["sally"].goes_on for part in resumed.parts[round:]) + 1
        )


KILLED = """
import os, sys
import beliefnest as bn
from beliefnest.nest.face.simulator import Simulator
count, store = int(sys.argv[1]), sys.argv[2]
calls = 0
def dying(method):
    def act(self, *args, **kwargs):
        global calls
        calls += 1
        if calls == count:
            os._exit(9)
        return method(self, *args, **kwargs)
    return act
Simulator.run_all, Simulator.step = dying(Simulator.run_all), dying(Simulator.step)
bn.Episode(bn.Task.load("help-find", seed=1), store=store).play()
"""


@pytest.mark.parametrize("count", few_by_day([2, 1, 5]))
def test_a_killed_episode_goes_on_without_asking_again_what_was_decided(
    tmp_path: Path, count: int
) -> None:
    store = tmp_path / "e.bn"
    killed = subprocess.run(
        [sys.executable, "-c", KILLED, str(count), str(store)], env=os.environ, check=False
    )
    assert killed.returncode == 9
    with bn.Episode(bn.Task.load(TASK, seed=1)) as whole:
        expected = facts_of(whole.play())
        parts = list(whole.parts)
    with bn.Episode.resume(store) as resumed:
        assert facts_of(resumed.play()) == expected
        assert list(resumed.parts) == parts
        assert all(isinstance(d, Decision) for p in resumed.parts for d in p.decisions.values())


@pytest.fixture(autouse=True)
def _no_thread_is_left() -> Iterator[None]:
    yield
    for thread in threading.enumerate():
        if thread.name.startswith("policy of"):
            thread.join(10)
