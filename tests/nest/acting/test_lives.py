"""Node is killed, stopped, or ends: the run goes on, and the result says what happened."""

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

import pytest
from tests.nest.comparing import everything
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.nest.acting.frame_recorder import FrameRecorder
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.minecraft.channel import Channel

ROOM = {
    "name": "room",
    "box": [[0, 0, 0], [8, 4, 8]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]},
    ],
    "static_blocks": ["stone"],
    "containers": [{"block": "chest", "at": [4, 1, 4], "items": {"diamond": 3}}],
    "agents": {
        name: {"position": [2 * n + 1.5, 1, 1.5]} for n, name in enumerate(["ann", "bob", "cleo"])
    },
}
PATHS = ("/", "/ann", "/ann/bob")
AGENTS = ("ann", "bob", "cleo")
AWAY = "await goToPosition(bot, new Vec3(Math.floor(bot.entity.position.x), 1, 7), 0)"
TAKE = "await getItemFromChest(bot, new Vec3(4, 1, 4), {diamond: 1})"
TO_AND_FRO = """
for (let n = 0; ; n++) {
  bot.chat('here ' + n)
  await goToPosition(bot, new Vec3(4, 1, n % 2 ? 2 : 7), 0)
}"""
LONG = 100_000


@pytest.fixture(scope="module")
def worlds():
    """Lends the same world to all nests here: Node is started only where it had ended."""
    with Worlds(5) as there:
        yield there


@pytest.fixture
def opened(worlds):
    """Return a function that opens nests in the room."""

    def opening(store=None):
        return bn.Nest.open(bn.Scenario.from_mapping(ROOM), store=store, seed=5, worlds=worlds)

    return opening


def prepare(nest):
    """Three bodies with three agents each, all of them somewhere else."""
    for path in PATHS[1:]:
        nest[path].switch("own")
    for path, agent in zip(PATHS, AGENTS, strict=True):
        assert nest[path].run(agent, AWAY).ok


def go_on(nest):
    """Something in every body, and what each program came to."""
    for path in PATHS:
        nest[path].step(3)
    return [nest[path].run_all(dict.fromkeys(AGENTS, TAKE)) for path in PATHS]


def held(nest):
    return [
        (path, nest[path].branch, nest[path].tick, everything(nest[path].state))
        for path in (*PATHS, "/bob", "/ann/cleo", "/ann/bob/ann")
    ]


def frames(nest):
    journal = nest._recording.journal
    return {
        info.key: (info.head, list(journal.entries(info.key, 0, info.entries)))
        for info in journal.timelines()
    }


def world_of(nest):
    return nest._engine.bodies.world.inner


@contextmanager
def at_a_frame(monkeypatch, act, number=1) -> Iterator[None]:
    """Do something in another thread once that many frames have come, and wait for it."""
    seen = []
    take = FrameRecorder.__call__

    def watched(self, frame):
        take(self, frame)
        seen.append(frame)
        if len(seen) == number:
            thread = threading.Thread(target=act)
            thread.start()
            thread.join()

    with monkeypatch.context() as patched:
        patched.setattr(FrameRecorder, "__call__", watched)
        yield
    assert len(seen) >= number


@contextmanager
def killed_in(monkeypatch, op, times=1) -> Iterator[list[int]]:
    """Kill Node when it has been asked for something, so many times."""
    asked, killed = [], []
    begin, answer = Channel.begin, Channel._answer

    def asking(self, name, **arguments):
        asked.append(name)
        if name == op and len(killed) < times:
            # However long this process waits for its turn, Node does not get as far as an answer.
            os.kill(self.pid, signal.SIGSTOP)
        begin(self, name, **arguments)

    def answering(self, *handlers):
        if asked[-1] == op and len(killed) < times:
            killed.append(self.pid)
            os.kill(self.pid, signal.SIGKILL)
            self._child._process.wait()
        return answer(self, *handlers)

    with monkeypatch.context() as patched:
        patched.setattr(Channel, "begin", asking)
        patched.setattr(Channel, "_answer", answering)
        yield killed


@pytest.fixture(scope="module")
def undisturbed(worlds):
    """Return the result of a history in which no process was killed."""
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), seed=5, worlds=worlds) as nest:
        prepare(nest)
        results = go_on(nest)
        return results, held(nest), frames(nest)


ENDS = {
    "killed": (signal.SIGKILL, "ended by signal 9 (SIGKILL)"),
    "ended": (signal.SIGTERM, "ended by signal 15 (SIGTERM)"),
    "stopped": (signal.SIGSTOP, "gave no sign of life for 3 s and was killed"),
}


def test_programs_under_which_node_ends(opened, monkeypatch, tmp_path, undisturbed):
    store = tmp_path / "run.bn"
    told = []
    with opened(store) as nest:
        prepare(nest)
        before, recorded = held(nest), frames(nest)
        for number, end in ENDS.values():
            first = world_of(nest).pid
            world_of(nest)._channel._silence = 3.0
            # More frames than are written at once, so that some were in the file already.
            with at_a_frame(monkeypatch, partial(os.kill, first, number), number=300):
                result = nest["/ann"].run("ann", TO_AND_FRO, timeout_ticks=LONG)
            assert not result.ok
            assert result.killed
            assert (result.error.kind, result.ticks, result.events) == ("killed", 0, ())
            assert f"/ann is at tick {before[1][2]}" in result.error.message
            assert f"Node {end} during 'run', after tick" in result.error.message
            told.append(str(result.error))
            assert frames(nest) == recorded
            assert held(nest) == before
            assert nest._engine.body(()).tick == before[0][2]
            assert world_of(nest).pid != first
        assert (go_on(nest), held(nest), frames(nest)) == undisturbed
    with bn.Nest.resume(store) as nest:
        assert (held(nest), frames(nest)) == undisturbed[1:]
        failed = [program.error for program in nest.programs() if not program.ok]
        assert failed[: len(told)] == told


def test_what_was_undone_is_not_replayed(opened, monkeypatch, tmp_path):
    store = tmp_path / "run.bn"
    with opened(store) as nest:
        with at_a_frame(monkeypatch, lambda: os.kill(world_of(nest).pid, 9)):
            nest["/"].run("ann", TO_AND_FRO, timeout_ticks=LONG)
        assert nest["/"].run("ann", TAKE).ok
    assert run_command_line(["replay", str(store)]) == 0


def test_all_agents_of_a_joint_run_are_told(opened, monkeypatch):
    with opened() as nest, at_a_frame(monkeypatch, lambda: os.kill(world_of(nest).pid, 9)):
        results = nest["/"].run_all(dict.fromkeys(AGENTS, TO_AND_FRO), timeout_ticks=LONG)
        assert results.keys() == set(AGENTS)
        assert all(result.killed for result in results.values())
        assert nest["/"].tick == 0


def test_node_dies_between_two_calls(opened, undisturbed):
    with opened() as nest:
        prepare(nest)
        world_of(nest)._channel.kill()
        assert (go_on(nest), held(nest), frames(nest)) == undisturbed


OPS = ["create_region", "step", "apply", "snapshot", "destroy_region"]


@pytest.mark.parametrize("op", few_by_day(OPS, 2))
def test_other_calls_are_made_again(opened, monkeypatch, op):
    def acts(nest):
        nest["/ann"].switch("own")
        nest["/ann"].step(4)
        nest["/ann"].switch("other", at=2)
        nest["/ann"].edit(blocks={(6, 1, 6): "stone"}, containers={(4, 1, 4): {"bread": 2}})
        nest["/ann"].switch("own")
        nest["/ann"].switch("follow")
        nest["/"].edit(containers={(4, 1, 4): {"bread": 1}})
        nest["/"].step(2)
        assert nest["/"].run("ann", TAKE.replace("diamond", "bread")).ok
        nest["/ann"].switch("other")
        return held(nest), frames(nest)

    with opened() as nest:
        expected = acts(nest)
    with opened() as nest, killed_in(monkeypatch, op) as killed:
        assert acts(nest) == expected
        assert killed == [killed[0]]
        assert world_of(nest).pid != killed[0]


def test_node_that_does_not_live(opened, monkeypatch, undisturbed):
    with opened() as nest:
        prepare(nest)
        world_of(nest)._channel.kill()
        with (
            killed_in(monkeypatch, "create_region", times=3) as killed,
            pytest.raises(bn.BodyError, match=r"ended 3 times during one call(.|\n)*doctor"),
        ):
            nest["/ann"].step(1)
        assert len(set(killed)) == 3
        with (
            killed_in(monkeypatch, "hello") as killed,
            pytest.raises(bn.BodyError, match="cannot be started; run `beliefnest doctor`"),
        ):
            nest["/ann"].step(1)
        assert len(killed) == 1
        assert (go_on(nest), held(nest), frames(nest)) == undisturbed


def test_a_call_that_is_interrupted_has_not_happened(opened, monkeypatch, undisturbed):
    def interrupt(self, frame):
        raise KeyboardInterrupt

    with opened() as nest:
        prepare(nest)
        with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
            patched.setattr(FrameRecorder, "__call__", interrupt)
            nest["/"].run("ann", TO_AND_FRO, timeout_ticks=LONG)
        assert (go_on(nest), held(nest), frames(nest)) == undisturbed


@pytest.mark.long
def test_a_script_is_played_to_its_end(worlds, monkeypatch, tmp_path):
    scenario = bn.Scenario.load("sally-anne", condition=1)
    with bn.Nest.open(scenario, worlds=worlds) as nest:
        nest.play()
        expected = frames(nest)
    store = tmp_path / "run.bn"
    with (
        bn.Nest.open(scenario, store=store, worlds=worlds) as nest,
        killed_in(monkeypatch, "run", times=2) as killed,
    ):
        nest.play()
        assert frames(nest) == expected
        assert len(killed) == 2
        undone = [p for p in nest.programs() if not p.kept]
        assert all("SIGKILL" in program.error for program in undone)
        assert undone
        nest.play()
        assert frames(nest) == expected
    with bn.Nest.open(scenario, worlds=worlds) as nest, killed_in(monkeypatch, "run", times=3):
        with pytest.raises(bn.BodyError, match=r"step 1.*SIGKILL"):
            nest.play()
        nest.play()
        assert frames(nest) == expected
