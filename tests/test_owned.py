"""A forked child can neither use what its parent has open nor end it, whatever it tries."""

import multiprocessing.connection
import os
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from tests.processes import started

import beliefnest as bn
from beliefnest.timeline.store import Journal
from beliefnest.worlds.minecraft.embedded import EmbeddedWorld

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")

WALK = "await goToPosition(bot, new Vec3(0, -51, -8))"


def in_child(act: Callable[[], object]) -> str:
    """Return the error of an act in a forked child, as text; `done` if there was none."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            act()
            told = "done"
        except BaseException as error:  # noqa: BLE001 - told to the parent
            told = f"{type(error).__name__}: {error}"
        os.write(write, told.encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read) as told_by_child:
        told = told_by_child.read()
    os.waitpid(child, 0)
    return told


KINDS = ["scripted", "embedded", "memory"]


@contextmanager
def opened(kind: str, folder: Path) -> Iterator[bn.Nest]:
    """Open a nest with a belief in control mode; with a run file, except `memory`."""
    scenario = bn.Scenario.load("sally-anne", 3)
    world, store = ("scripted", None) if kind == "memory" else (kind, folder / "run.bn")
    with bn.Nest.open(scenario, world=world, store=store) as nest:
        nest["/sally"].switch("plan")
        yield nest


@pytest.fixture(params=KINDS)
def nest(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[bn.Nest]:
    with opened(request.param, tmp_path) as nest:
        yield nest


@pytest.fixture(scope="module", params=KINDS)
def same_nest(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[bn.Nest]:
    """Return one nest for all acts that are refused, and so change nothing of it."""
    with opened(request.param, tmp_path_factory.mktemp("same")) as nest:
        yield nest


ACTS: dict[str, Callable[[bn.Nest], object]] = {
    "run": lambda nest: nest["/sally"].run("sally", WALK),
    "wait": lambda nest: nest.wait(timeout_s=1),
    "step": lambda nest: nest._engine.step((), 1),
    "edit": lambda nest: nest["/sally"].edit(blocks={(0, -51, 0): "stone"}),
    "switch": lambda nest: nest["/anne"].switch("other"),
    "state": lambda nest: nest["/"].state,
    "past": lambda nest: nest.at(0)["/sally"].state.chat,
    "keep": lambda nest: nest.keep("name", b"value"),
    "programs": lambda nest: nest.programs(),
    "play": lambda nest: nest.play(),
    "tick": lambda nest: nest.tick,
    "branch": lambda nest: nest["/sally"].branch,
    "seed": lambda nest: nest.seed,
}


@pytest.mark.parametrize("act", ACTS.values(), ids=ACTS)
def test_every_use_in_a_child_is_refused_in_one_line(
    same_nest: bn.Nest, act: Callable[[bn.Nest], object]
) -> None:
    told = in_child(lambda: act(same_nest))
    assert told.startswith("ForkedError: ")
    assert f"was opened by process {os.getpid()} and cannot be used in process" in told
    assert "\n" not in told


def test_parent_goes_on_after_a_child_tried_everything(nest: bn.Nest, tmp_path: Path) -> None:
    before = nest.tick
    for act in ACTS.values():
        in_child(lambda act=act: act(nest))
    assert in_child(nest.close) == "done"
    assert in_child(lambda: nest.__exit__(None, None, None)) == "done"
    result = nest["/sally"].run("sally", WALK)
    assert result.ok, result.error
    assert nest.tick == before
    assert nest["/"].run("anne", "think(bot, 'still here')").ok
    assert [program.ok for program in nest.programs()] == [True, True]
    nest.close()
    if (tmp_path / "run.bn").exists():
        with bn.Nest.read(tmp_path / "run.bn") as again:
            assert [program.ok for program in again.programs()] == [True, True]


def test_a_child_that_ends_by_itself_ends_nothing_of_its_parent(tmp_path: Path) -> None:
    """All that runs at the end of Python runs in the child: finalizers, `with`, collection."""
    script = """
        import gc, os, sys
        import beliefnest as bn

        scenario = bn.Scenario.load("sally-anne", 3)
        with bn.Nest.open(scenario, store=sys.argv[1]) as nest:
            nest["/sally"].switch("plan")
            child = os.fork()
            if child:
                assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
                assert os.path.exists(sys.argv[1] + "-lock")
                assert nest["/sally"].run("sally", "think(bot, 'on')").ok
                assert nest["/"].run("anne", "think(bot, 'on')").ok
            else:
                del nest
                gc.collect()
                sys.exit(7)
        with bn.Nest.read(sys.argv[1]) as again:
            assert len(again.programs()) == 2
        print("sound")
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script), str(tmp_path / "run.bn")],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert (done.stdout, done.stderr, done.returncode) == ("sound\n", "", 0)


def test_what_a_child_inherits_keeps_neither_node_nor_the_lock_alive(tmp_path: Path) -> None:
    """A parent that is killed ends its Node and gives up its run file, whatever its child does."""
    script = """
        import os, signal, sys
        import beliefnest as bn

        nest = bn.Nest.open(bn.Scenario.load("sally-anne", 3), store=sys.argv[1])
        begun, begin = os.pipe()
        child = os.fork()
        if child == 0:
            os.write(begin, b".")
            sys.stdin.read()
            os._exit(0)
        # A child gives up all that it inherits when it begins.
        os.read(begun, 1)
        print(nest._engine.world.pid, flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
    """
    with started(
        [sys.executable, "-c", textwrap.dedent(script), str(tmp_path / "run.bn")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as parent:
        assert parent.stdout is not None
        node = int(parent.stdout.readline())
        parent.wait()
        watch = os.pidfd_open(node) if _is_running(node) else None
        if watch is not None:
            multiprocessing.connection.wait([watch], timeout=30)
            os.close(watch)
        assert not _is_running(node)
        with bn.Nest.resume(tmp_path / "run.bn") as nest:
            assert nest["/"].run("anne", "think(bot, 'on')").ok
        parent.communicate("")


def _is_running(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def test_recorded_nests_journals_and_servers_are_refused(tmp_path: Path) -> None:
    store = tmp_path / "run.bn"
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), world="scripted", store=store):
        pass
    with bn.Nest.read(store) as recorded:
        for act in (
            lambda: recorded["/sally"].state,
            lambda: recorded.ticks("/"),
            recorded.branches,
            lambda: recorded.view()._repr_html_(),
        ):
            assert in_child(act).startswith("ForkedError: ")
        assert in_child(recorded.close) == "done"
        assert recorded["/sally"].state.agents["anne"].position is not None
    with Journal.open(store) as journal:
        assert in_child(journal.timelines).startswith("ForkedError: ")
        assert in_child(journal.close) == "done"
        assert journal.timelines()
    with bn.Nest.read(store) as fresh:

        def read_anew() -> None:
            with bn.Nest.read(store) as own:
                assert own["/sally"].state == own["/sally"].state

        assert in_child(read_anew) == "done"
        assert fresh["/"].state.tick == 0


def test_worlds_are_refused() -> None:
    world = EmbeddedWorld(0).start()
    try:
        assert in_child(lambda: world.pid) == "done"
        snapshot = bn.Scenario.load("sally-anne", 3).setting.snapshot
        told = in_child(lambda: world.open_body("/", "0", snapshot, lambda frame: None))
        assert told.startswith("ForkedError: ")
        assert in_child(world.interrupt) == "done"
        assert in_child(world.close) == "done"
        world.open_body("/", "0", snapshot, lambda frame: None).close()
    finally:
        world.close()


def test_episodes_are_refused(tmp_path: Path) -> None:
    task = bn.Task.load("tell-what-is-needed", seed=3)
    asked = tmp_path / "asked"

    class Idle:
        def act(self, view: bn.AgentView) -> str:
            with asked.open("a") as file:
                file.write("asked\n")
            return ""

    with bn.Episode(task, dict.fromkeys(task.agents, Idle()), world="scripted") as episode:
        episode.play(rounds=1)
        before = asked.read_text()
        assert in_child(lambda: episode.play(rounds=1)).startswith("ForkedError: ")
        assert asked.read_text() == before, "a policy was asked in the child"
        assert in_child(episode.close) == "done"
        episode.play(rounds=1)


def test_scripted_worlds_are_refused() -> None:
    world = bn.ScriptedWorld(((0, 0, 0), (4, 4, 4)), agents={"anne": (1.5, 1, 1.5)})
    copied = world.again()
    for act in (
        lambda: world.say("anne", "hello"),
        lambda: world.step(1),
        world.snapshot,
        lambda: world.agents,
        world.tick,
        copied.step,
    ):
        told = in_child(act)
        assert told.startswith("ForkedError: the scripted world was opened by process ")

    def fork_again() -> None:
        raise RuntimeError(in_child(world.step))

    assert f"was opened by process {os.getpid()} and" in in_child(fork_again)

    def make_anew() -> None:
        bn.ScriptedWorld(((0, 0, 0), (4, 4, 4))).step(1)

    assert in_child(make_anew) == "done"
    world.step(1)
    assert world.now == 1


def test_imagined_histories_are_refused() -> None:
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), world="scripted") as nest:
        nest.scripted_world.step(5)
        imagined = nest["/sally"].imagine(0, actors={"anne": {"idle": ""}}, n=2)
        history = imagined[0]
        simulator = history.fork()
        for act in (
            lambda: imagined.weights,
            lambda: imagined[0],
            lambda: imagined.share({"agent": "anne", "items": {}}),
            lambda: history.candidates,
            lambda: history.state,
            lambda: history.at(1),
            lambda: simulator.state,
            lambda: simulator.run("sally", "think(bot, 'here')"),
        ):
            assert in_child(act).startswith("ForkedError: ")
        assert simulator.run("sally", "think(bot, 'here')").ok


def test_environments_are_refused() -> None:
    from beliefnest.env import parallel_env

    env = parallel_env("sally-anne", world="scripted")
    with closing(env):
        env.reset(seed=3)
        assert in_child(lambda: env.step({})).startswith("ForkedError: ")
        assert in_child(env.state).startswith("ForkedError: ")
        assert in_child(env.close) == "done"
        env.state()
