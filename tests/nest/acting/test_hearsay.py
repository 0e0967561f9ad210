"""Claims that a function reads out of text: recorded, believed, and asked for only once."""

import sqlite3
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from tests.nest.comparing import values

import beliefnest as bn
from beliefnest.belief.view import State
from beliefnest.cli.app import run_command_line
from beliefnest.nest.past.setting import Setting
from beliefnest.timeline import codec
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.nameable import Nameable
from beliefnest.world.values import Position

pytestmark = pytest.mark.usefixtures("kept_worlds")

LEFT, RIGHT, DOOR = (3, 0, 3), (17, 0, 3), (10, 0, 18)
INFORMED = bn.Perception(max_visible_distance=6, testimony="informed", grace=100)


class Listener:
    """Finds the diamond wherever somebody says left or right; remembers what it was asked."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, str, Nameable]] = []

    def __call__(self, text: str, speaker: str, nameable: Nameable) -> list[bn.Claim]:
        self.asked.append((text, speaker, nameable))
        places = {"left": LEFT, "right": RIGHT}
        return [bn.Claim.located("diamond", places[w]) for w in text.split() if w in places]


def world() -> bn.ScriptedWorld:
    return bn.ScriptedWorld(
        box=((0, 0, 0), (20, 3, 20)),
        blocks={DOOR: "lever"},
        agents={"max": (3.5, 0, 5.5), "nora": (5.5, 0, 5.5)},
        inventories={"max": {"diamond": 1}},
        containers={LEFT: {}, RIGHT: {"apple": 1}},
    )


def hide(there: bn.ScriptedWorld) -> None:
    """Nora sees where max puts the diamond; max goes away for long."""
    there.deposit("max", LEFT, {"diamond": 1})
    there.place_agent("max", (9.5, 0, 14.5))
    there.step(200)


def frames(store: Path) -> list[bytes]:
    with Journal.read(store) as journal:
        key = TimelineKey((), "main")
        entries = journal.entries(key, 0, journal.info(key).entries)
        return [codec.encode_entry(entry) for entry in entries]


def believed(nest: bn.Nest, path: str) -> dict[str, int]:
    content = nest[path].state.containers.get(RIGHT)
    return {} if content is None else dict(content.items)


def test_what_is_found_in_words_is_claimed() -> None:
    listener, there = Listener(), world()
    nest = bn.Nest(there, INFORMED, claims_from=listener)
    hide(there)
    there.say("nora", "It is right there")
    assert believed(nest, "/max") == {"diamond": 1}
    assert believed(nest, "/nora") == {}
    (told,) = nest.claims()
    assert (told.claim, told.lie, told.claims_from) == (
        bn.Claim.located("diamond", RIGHT),
        True,
        "Listener",
    )
    ((text, speaker, nameable),) = listener.asked
    assert (text, speaker) == ("It is right there", "nora")
    assert nameable.agents == ("max", "nora")
    assert nameable.items == ("diamond",)
    assert nameable.containers == {LEFT: "chest"}
    assert nameable.doors == {}
    assert nameable.box == there.box


@pytest.mark.parametrize("known", [(), [LEFT, RIGHT, DOOR]])
def test_a_speaker_can_name_what_it_knows(known: list[Position]) -> None:
    listener, there = Listener(), world()
    setting = Setting(
        "halls",
        there.snapshot(),
        INFORMED,
        static_blocks=frozenset(known),
        initial_beliefs=(bn.InitialBelief(("nora",), containers={RIGHT: ({"emerald": 1}, False)}),),
        labels={LEFT: "left box", RIGHT: "right box"},
        places={"here": (5, 0, 5), "there": (18, 0, 18)},
        unique=frozenset({"nether_star"}),
    )
    with bn.Nest.open(setting, "scripted", claims_from=listener) as nest:
        hide(nest.scripted_world)
        nest.scripted_world.say("max", "x", claims=[bn.Claim.absent("bread", LEFT)])
        nest.scripted_world.say("nora", "Well.")
    ((_, _, nameable),) = listener.asked
    assert nameable.items == ("bread", "diamond", "emerald", "nether_star")
    assert list(nameable.containers.values()) == ["left box", "right box"][: 1 + bool(known)]
    assert list(nameable.doors) == [DOOR][: len(known)]
    assert nameable.places == {"here": (5, 0, 5)}


def test_only_utterances_without_claims_of_their_own_are_read() -> None:
    listener, there = Listener(), world()
    nest = bn.Nest(there, INFORMED, claims_from=listener)
    hide(there)
    there.think("nora", "right")
    there.say("nora", "right", claims=[bn.Claim.absent("diamond", LEFT)])
    there.whisper("nora", "max", "nothing of the kind")
    assert [text for text, _, _ in listener.asked] == ["nothing of the kind"]
    assert [told.claims_from for told in nest.claims()] == [None]
    assert nest["/max"].state.chat[-1][1:] == ("nora", "nothing of the kind")


def test_the_one_who_is_asked_last_knows_what_has_happened_before() -> None:
    listener, there = Listener(), world()
    nest = bn.Nest(there, INFORMED, claims_from=listener)
    there.set_block((8, 0, 8), "barrel")
    nest["/"].run("nora", "await say(bot, 'one'); await say(bot, 'two')")
    assert [(8, 0, 8) in nameable.containers for _, _, nameable in listener.asked] == [True, True]


@pytest.mark.parametrize(
    ("found", "message"),
    [
        ([bn.Claim.located("diamond", (99, 0, 0))], "outside the box"),
        ([bn.Claim.position("otto", (1, 0, 1))], "names an unknown agent"),
        (["the diamond is right"], "is no claim"),
        (None, "claims_from .*returned None for 'right'; it must return a list of claims"),
        ("left", "claims_from .*returned 'left'"),
    ],
)
def test_what_does_not_fit_the_world_is_not_said(found: Iterable[bn.Claim], message: str) -> None:
    there = world()
    nest = bn.Nest(there, INFORMED, claims_from=lambda *_: found)
    there.step(3)
    with pytest.raises(bn.InputError, match=message):
        there.say("nora", "right")
    assert (there.now, nest.tick) == (3, 3)
    with pytest.raises(bn.InputError, match=message):
        nest["/"].run("nora", "await say(bot, 'right')")
    assert not nest["/"].state.chat
    there.step(1)
    assert nest.tick == there.now


@pytest.mark.parametrize("hook", ["x", lambda text: []])
def test_a_hook_that_cannot_be_asked_is_refused_at_once(hook: Any) -> None:
    with pytest.raises(bn.InputError, match=r"claims_from is .*; give a function of three"):
        bn.Nest(world(), INFORMED, claims_from=hook)


def test_a_run_with_claims_read_is_that_with_claims_made(tmp_path: Path) -> None:
    for name, claims_from in (("read", Listener()), ("made", None)):
        there = world()
        with bn.Nest(there, INFORMED, store=tmp_path / name, claims_from=claims_from) as nest:
            hide(there)
            made = [] if claims_from else [bn.Claim.located("diamond", RIGHT)]
            there.say("nora", "right", claims=made)
            there.step(10)
            assert nest["/max/nora"].state.containers[RIGHT].items == {"diamond": 1}
    pairs = zip(frames(tmp_path / "read"), frames(tmp_path / "made"), strict=True)
    assert sum(one != other for one, other in pairs) == 1


def shown(state: State) -> dict[str, object]:
    return {**values(state), "memories": (dict(state.containers), dict(state.agents))}


def goes_on(there: bn.ScriptedWorld) -> None:
    there.say("nora", "right")
    there.step(150)
    there.say("max", "left")


@pytest.mark.parametrize("without_checkpoints", [False, True])
def test_going_on_after_closing_is_the_same(tmp_path: Path, without_checkpoints: bool) -> None:
    paths = ["/max", "/nora", "/max/nora", "/nora/max", "/nora/max/nora"]

    def told(nest: bn.Nest) -> list[object]:
        claims = [(c.tick, c.claim, c.lie, [c.why(p) for p in paths]) for c in nest.claims()]
        return [*claims, *(shown(nest[p].state) for p in paths)]

    with bn.Nest(world(), INFORMED, store=tmp_path / "a", claims_from=Listener()) as nest:
        hide(nest.scripted_world)
        goes_on(nest.scripted_world)
        whole = told(nest)
    with bn.Nest(world(), INFORMED, store=tmp_path / "b", claims_from=Listener()) as nest:
        hide(nest.scripted_world)
        assert [nest[path].state.tick for path in paths] == [202] * 5
    if without_checkpoints:
        with closing(sqlite3.connect(tmp_path / "b")) as connection, connection:
            connection.execute("DELETE FROM keyframe")
    with bn.Nest.resume(tmp_path / "b", claims_from=Listener()) as nest:
        goes_on(nest.scripted_world)
        assert told(nest) == whole
    with bn.Nest.resume(tmp_path / "b") as nest:
        assert told(nest) == whole
    assert frames(tmp_path / "a") == frames(tmp_path / "b")


def test_programs_run_again_say_what_was_recorded(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    store = tmp_path / "run.bn"

    def hook(text: str, speaker: str, nameable: Nameable) -> list[bn.Claim]:
        named = (place for place, label in nameable.containers.items() if text in label)
        return [bn.Claim.located("diamond", place) for place in named]

    scenario = bn.Scenario.load("sally-anne", 3)
    with bn.Nest.open(scenario, store=store, seed=0, claims_from=hook) as nest:
        result = nest["/"].run(
            "sally",
            "await say(bot, 'left'); await say(bot, 'left'); await say(bot, 'nothing');"
            "await whisper(bot, 'anne', 'left')",
        )
        assert result.ok, result.error
        assert [told.text for told in nest.claims()] == ["left"] * 3
        nest["/observer"].switch("ahead")
        nest["/observer"].run("sally", "await say(bot, 'left')")
        assert len(nest.claims("/observer")) == 1
    assert run_command_line(["replay", str(store)]) == 0
    assert capsys.readouterr().out.count("no difference") == 2
