"""Programs tried at the same time come to what they come to one after the other."""

import os
import signal
import sqlite3
from contextlib import closing

import pytest
from tests.nest.comparing import everything
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.nest.face import exploration as exploring
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.minecraft.channel import Channel

ROOM = {
    "name": "room",
    "box": [[0, 0, 0], [8, 4, 8]],
    "blocks": [{"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]}],
    "static_blocks": ["stone"],
    "containers": [{"block": "chest", "at": [4, 1, 4], "items": {"diamond": 3}}],
    "agents": {"ann": {"position": [1.5, 1, 1.5]}, "bob": {"position": [6.5, 1, 6.5]}},
}
DEADLY = "bot.chat('this kills Node')"
PROGRAMS = (
    "await goToPosition(bot, new Vec3(6, 1, 1), 0); bot.chat('here ' + Math.random())",
    "bot.chat('hm'); await getItemFromChest(bot, new Vec3(4, 1, 4), {emerald: 1})",
    "await goToPosition(bot, new Vec3(1, 1, 6), 0); for (;;) await bot.waitForTicks(1)",
    DEADLY,
    "await getItemFromChest(bot, new Vec3(4, 1, 4), {diamond: 2})",
    "const oops = ",
    # Leaves much under way, in the bot and in the world.
    "setInterval(() => bot.chat('still here'), 50); bot.setControlState('jump', true); "
    "globalThis.left = bot.left = 1; await bot.waitForTicks(3)",
    "bot.chat(`${globalThis.left} ${bot.left} ${bot.entity.position} ${bot.entity.onGround}`)",
)


@pytest.fixture(scope="module")
def worlds():
    """Lends one world to all nests here."""
    with Worlds(7) as there:
        yield there


@pytest.fixture(autouse=True)
def deadly(monkeypatch):
    """Let Node die of one of the programs, in whichever process."""
    request = Channel.request

    def asking(self, op, *handlers, **arguments):
        if DEADLY in arguments.get("programs", {}).values():
            self.kill()
        return request(self, op, *handlers, **arguments)

    monkeypatch.setattr(Channel, "request", asking)


def explored(worlds, store, path, score, processes, programs=PROGRAMS):
    """All that comes of it, and of going on afterwards."""
    scenario = bn.Scenario.from_mapping(ROOM)
    with bn.Nest.open(scenario, store=store, seed=7, worlds=worlds) as nest:
        assert nest["/"].run("bob", "await goToPosition(bot, new Vec3(3, 1, 6), 0)").ok
        attempts = nest.explore(path, "ann", programs, score, 80, processes=processes)
        branch = nest[path].branch
        nest[path].switch("plan 5")
        results = nest[path].run_all({"ann": PROGRAMS[0], "bob": PROGRAMS[4]})
        told = [(a.program, a.branch, a.result, a.score, everything(a.state)) for a in attempts]
        held = everything(nest[path].state)
        used = len(nest._engine.bodies.others)
    with closing(sqlite3.connect(store)) as file:
        dump = list(file.iterdump())
    return (told, branch, results, held, dump), used


def seen(simulator, result):
    return simulator.tick + len(result.events)


def acting(simulator, result):
    """Return a score, and let the simulator go on."""
    simulator.run("ann", "bot.chat('and now?')")
    return simulator.tick


@pytest.mark.parametrize(
    ("path", "score"), few_by_day([("/bob", seen), ("/", seen), ("/", acting)])
)
def test_at_the_same_time_or_in_turn(worlds, tmp_path, path, score):
    in_turn, none = explored(worlds, tmp_path / "a.bn", path, score, 1)
    at_once, one = explored(worlds, tmp_path / "b.bn", path, score, 2)
    assert at_once == in_turn
    assert (none, one) == (0, 1)
    kinds = {result.error.kind for _, _, result, _, _ in in_turn[0] if not result.ok}
    assert kinds >= {"skill", "timeout", "killed", "syntax"}


def test_a_score_that_lets_the_world_go_on(worlds, tmp_path):
    def score(simulator, result):
        nest_of[simulator.path].step(2)
        return simulator.tick

    told = []
    for processes in (1, 3):
        scenario = bn.Scenario.from_mapping(ROOM)
        with bn.Nest.open(scenario, seed=7, worlds=worlds) as nest:
            nest_of = {"/bob": nest["/"]}
            attempts = nest.explore("/bob", "ann", PROGRAMS[:2] * 2, score, 80, processes=processes)
            told.append([(a.result, a.score, everything(a.state)) for a in attempts])
            starts = [info.start for info in nest["/bob"].branches()]
            assert starts == sorted(set(starts))
    assert told[0] == told[1]


def test_other_processes_are_used_if_it_is_worth_it(worlds, tmp_path, monkeypatch):
    programs = PROGRAMS[:1] * 5
    # More than the busiest machine takes for four of them.
    monkeypatch.setattr(exploring, "_WORTH_SECONDS", 300.0)
    quick, none = explored(worlds, tmp_path / "a.bn", "/", seen, None, programs)
    monkeypatch.setattr(exploring, "_WORTH_SECONDS", 0.0)
    monkeypatch.setattr(exploring, "_processors", lambda: 2)
    long, one = explored(worlds, tmp_path / "b.bn", "/", seen, None, programs)
    assert (none, one) == (0, 1)
    assert quick == long


def test_an_agent_who_is_not_there(worlds):
    room = {**ROOM, "perception": {"max_visible_distance": 2}}
    for processes in (1, 2):
        scenario = bn.Scenario.from_mapping(room)
        with bn.Nest.open(scenario, seed=7, worlds=worlds) as nest:
            with pytest.raises(bn.WorldError, match="ann has no bot"):
                nest.explore("/bob", "ann", PROGRAMS[:2], seen, processes=processes)
            assert nest["/bob"].branch == "follow"
            assert nest["/bob"].branches() == ()


def test_an_interrupted_exploration_has_not_happened(worlds, monkeypatch):
    request, interrupted = Channel.request, []

    def asking(self, op, *handlers, **arguments):
        if op == "run" and not interrupted:
            interrupted.append(self.pid)
            os.kill(os.getpid(), signal.SIGINT)
        return request(self, op, *handlers, **arguments)

    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), seed=7, worlds=worlds) as nest:
        with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
            patched.setattr(Channel, "request", asking)
            nest.explore("/", "ann", [PROGRAMS[2]] * 3, seen, 1_000_000, processes=2)
        assert [info.key.branch for info in nest["/"].branches()] == ["main"]
        assert nest["/"].run("ann", PROGRAMS[0]).ok


def test_no_process_at_all_is_refused(worlds):
    with (
        bn.Nest.open(bn.Scenario.from_mapping(ROOM), worlds=worlds) as nest,
        pytest.raises(bn.InputError, match="processes is 0"),
    ):
        nest.explore("/", "ann", PROGRAMS, seen, processes=0)


def alone():
    return bn.ScriptedWorld(box=((0, 0, 0), (8, 4, 8)), agents={"ann": (1.5, 1, 1.5)})


def test_programs_and_scores_can_have_names():
    plans = {"hello": "bot.chat('a')", "twice": "bot.chat('a'); bot.chat('b')"}

    def score(simulator, result):
        return {"said": len(result.said), "ticks": result.ticks}

    with bn.Nest(alone()) as nest:
        attempts = nest.explore("/ann", "ann", plans, score, name="try")
        assert [(each.name, each.program) for each in attempts] == list(plans.items())
        assert [each.branch for each in attempts] == ["try hello", "try twice"]
        assert [each.score["said"] for each in attempts] == [1, 2]
        assert "said 2, ticks" in repr(attempts[1])


@pytest.mark.parametrize("score", [None, "good", {"good": None}, [1]])
def test_a_score_that_is_no_number_is_refused_and_blocks_nothing(score):
    with bn.Nest(alone()) as nest:
        with pytest.raises(bn.InputError, match=r"for the program '1'; return a number, or a map"):
            nest.explore("/ann", "ann", ["1", "2"], lambda *_: score)
        assert nest["/ann"].branch == "follow"
        assert nest["/ann"].branches() == ()
        (attempt,) = nest.explore("/ann", "ann", ["1"], lambda *_: True)
        assert attempt.score == 1.0


@pytest.mark.parametrize("programs", ["bot.chat('a')", 7, [1], {1: "bot.chat('a')"}])
def test_what_is_no_list_of_programs_is_refused(programs):
    with bn.Nest(alone()) as nest, pytest.raises(bn.InputError, match="program"):
        nest.explore("/ann", "ann", programs, lambda *_: 0)


def test_one_prompt_shows_several_simulators_and_branches():
    template = (
        "{{ branch.tick }} {% for name in tried %}{{ name }}: {{ tried[name] | chat_log }}; "
        "{% endfor %}{{ others[0] | chat_log }}"
    )
    with bn.Nest(alone()) as nest:
        plans = {"a": "bot.chat('left')", "b": "bot.chat('right')"}
        attempts = nest.explore("/ann", "ann", plans, lambda *_: 0)
        ann = nest["/ann"]
        tried = {each.name: ann.on(each.branch) for each in attempts}
        text = ann.render(template, tried=tried, others=[nest["/"]])
        assert "a: " in text
        assert text.index("left") < text.index("b: ") < text.index("right")
        assert text.endswith("No chats")
        assert ann.branch == "follow"
        assert ann.on("follow").state == ann.state
        with pytest.raises(bn.BranchError, match="/ann has no branch 'plan c'"):
            ann.on("plan c")
