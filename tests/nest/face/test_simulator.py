"""Programs run in a simulator: what their results tell, and what is refused beforehand."""

from collections.abc import Iterator
from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.world.values import Event, EventKind
from beliefnest.worlds.protocol import Unfinished


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("programs") / "run.bn"


@pytest.fixture(scope="module")
def nest(store: Path) -> Iterator[bn.Nest]:
    """Three agents in the hall of Sally and Anne, before anything is played."""
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), store=store, seed=0) as opened:
        yield opened


def test_a_result_tells_what_its_own_agent_did_and_said(nest: bn.Nest) -> None:
    start = nest["/"].tick
    results = nest["/"].run_all(
        {
            "sally": "bot.chat('one')\nawait emote('sally', 'nod')\nawait waitTicks(bot, 2)\n"
            "await say(bot, 'two')",
            "anne": "await think(bot, 'hm')\nif (false) {\n  bot.chat('no')\n}\nconsole.log('a')",
        }
    )
    sally, anne = results["sally"], results["anne"]
    assert sally.events == anne.events
    assert sally.actions == (Event(EventKind.EMOTE, "sally", {"name": "nod"}),)
    assert sally.said == ((start + 1, "one"), (start + 2, "two"))
    assert (anne.actions, anne.said) == ((), ())
    assert (sally.lines, anne.lines) == ((1, 2, 3, 4), (1, 2, 5))
    assert (sally.log, anne.log) == ((), ("a",))
    assert [event.kind.value for event in anne.events] == ["emote", "think", "chat", "chat"]


@pytest.mark.parametrize(
    ("code", "kind", "lines", "log"),
    [
        ("console.log(1)\nlet a = ;", "syntax", (), ()),
        pytest.param("console.log(1)\nfor (;;) {}", "fuel", (1, 2), ("1",), marks=pytest.mark.long),
        ("console.log(1)\nthrow new Error('x')\nconsole.log(2)", "error", (1, 2), ("1",)),
        ("console.log(1)\nawait waitTicks(bot, 100)\nconsole.log(2)", "timeout", (1, 2), ("1",)),
    ],
)
def test_a_program_that_fails_tells_how_far_it_came(
    nest: bn.Nest, code: str, kind: str, lines: tuple[int, ...], log: tuple[str, ...]
) -> None:
    result = nest["/"].run("sally", code, timeout_ticks=5)
    assert not result.ok
    assert result.error is not None
    assert (result.error.kind, result.error.line) == (kind, 2)
    assert (result.lines, result.log) == (lines, log)


def test_what_was_still_going_on_is_told_and_recorded(nest: bn.Nest, store: Path) -> None:
    result = nest["/"].run("anne", "console.log('go')\nwaitTicks(bot, 50)")
    assert (result.ok, result.unfinished) == (True, (Unfinished("waitTicks", 2),))
    with RecordedNest.read(store) as read:
        noted = read.programs("/")[-1]
    assert (noted.agent, noted.lines, noted.log) == ("anne", (1, 2), ("go",))
    assert noted.unfinished == ("waitTicks of line 2",)


def test_an_empty_program_ends_well_after_a_tick(nest: bn.Nest) -> None:
    result = nest["/"].run("sally", "")
    assert (result.ok, result.ticks, result.lines) == (True, 1, ())


@pytest.mark.parametrize(
    ("agent", "code", "ticks", "error", "hint"),
    [
        ("bob", "", 10, bn.PathError, "'bob'"),
        ("", "", 10, bn.PathError, "''"),
        (None, "", 10, bn.PathError, "None"),
        ("sally", 7, 10, bn.InputError, "program of sally is of type int"),
        ("sally", None, 10, bn.InputError, "program of sally is of type NoneType"),
        ("sally", b"", 10, bn.InputError, "program of sally is of type bytes"),
        ("sally", "", 0, bn.InputError, "timeout_ticks is 0"),
        ("sally", "", -1, bn.InputError, "timeout_ticks is -1"),
        ("sally", "", 1.5, bn.InputError, r"timeout_ticks is 1\.5"),
        ("sally", "", True, bn.InputError, "timeout_ticks is True"),
        ("sally", "", 10**30, bn.InputError, "at most 1728000"),
    ],
)
def test_wrong_input_is_named_and_nothing_happens(
    nest: bn.Nest, agent: str, code: str, ticks: int, error: type[Exception], hint: str
) -> None:
    before = nest["/"].tick
    with pytest.raises(error, match=hint):
        nest["/"].run(agent, code, timeout_ticks=ticks)
    assert nest["/"].tick == before


def test_run_all_takes_one_program_for_each_of_some_agents(nest: bn.Nest) -> None:
    with pytest.raises(bn.InputError, match="no program is in"):
        nest["/"].run_all({})
    with pytest.raises(bn.InputError, match="from agent to code"):
        nest["/"].run_all([("sally", ""), ("sally", "")])  # type: ignore[arg-type]
    with pytest.raises(bn.PathError, match="'bob'"):
        nest["/"].run_all({"sally": "bot.chat('never said')", "bob": ""})


def test_in_follow_mode_there_is_nobody_to_run_a_program(nest: bn.Nest) -> None:
    with pytest.raises(bn.BranchError, match="follow mode"):
        nest["/sally"].run("sally", "")
