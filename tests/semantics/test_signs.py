"""Texts of signs are believed as their blocks are."""

import json

import pytest

import beliefnest as bn
from beliefnest.belief.columns import cell_of
from beliefnest.belief.grounds import Source
from beliefnest.nest.past.checkpoints import restored, saved
from beliefnest.nest.past.history import context_of
from beliefnest.nest.past.setting import Setting
from beliefnest.nest.past.trace_import import import_trace
from beliefnest.prompts.templates import built_in_template
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.trace import load_trace
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.values import EventKind, Sign

SIGN = (5, 1, 5)
DEFAULT = built_in_template("default").text
WALL = {(7, y, z): "stone" for y in (1, 2, 3) for z in range(11)}


@pytest.fixture
def world():
    return bn.ScriptedWorld(
        ((0, 0, 0), (10, 4, 10)),
        {SIGN: "oak_sign", **WALL},
        {"sally": (1.5, 1, 5.5), "anne": (2.5, 1, 7.5)},
        signs={SIGN: "food"},
    )


@pytest.fixture
def nest(world):
    with bn.Nest(world) as opened:
        yield opened


def test_whoever_sees_a_sign_believes_its_text_and_who_does_not_remembers(world, nest):
    assert nest["/sally/anne"].state.signs == {SIGN: "food"}
    world.place_agent("sally", (9.5, 1, 5.5))
    world.write_sign("anne", SIGN, "tools\nno food\n")
    assert nest["/anne"].state.signs == {SIGN: "tools\nno food"}
    assert nest["/sally"].state.signs == {SIGN: "food"}
    assert nest["/anne/sally"].state.signs == {SIGN: "food"}
    assert nest["/sally/anne"].state.signs == {SIGN: "food"}
    assert not nest["/sally"].state.blocks.current(SIGN)
    assert nest.at(1)["/anne"].state.signs == {SIGN: "food"}
    (update,) = nest["/anne"].state.events
    assert (update.kind, update.actor, update.detail["text"]) == (
        EventKind.BLOCK_UPDATE,
        "anne",
        "tools\nno food",
    )
    assert nest["/sally"].state.events == ()
    (false,) = nest.false_beliefs("/sally")[:1]
    assert (false.where, false.b) == (
        SIGN,
        'oak_sign[rotation=0,waterlogged=false] that says "food"',
    )
    assert "tools / no food" in str(false.a)
    said = str(nest["/sally"].explain(block=SIGN))
    assert 'says "food"' in said
    assert "tick 1" in said or "tick 0" in said


def test_a_sign_never_seen_is_unknown_and_a_blank_one_is_blank(world):
    world.place_agent("sally", (9.5, 1, 5.5))
    with bn.Nest(world) as nest:
        assert nest["/sally"].state.signs == {}
        world.write_sign("anne", SIGN, "")
        assert nest["/anne"].state.signs == {SIGN: ""}
        world.set_block(SIGN, "stone")
        assert nest["/anne"].state.signs == {}
        world.set_block(SIGN, "oak_sign")
        assert nest["/anne"].state.signs == {SIGN: ""}


def test_a_fork_stands_with_the_text_that_is_believed(world, nest):
    world.place_agent("sally", (9.5, 1, 5.5))
    world.write_sign("anne", SIGN, "tools")
    belief = nest["/sally"]
    belief.switch("try")
    assert belief.scripted.snapshot().signs == {SIGN: "food"}
    belief.scripted.write_sign("sally", SIGN, "mine")
    assert belief.state.signs == {SIGN: "mine"}
    assert nest["/"].state.signs == {SIGN: "tools"}


def test_a_text_is_edited_by_hand_and_everything_is_kept(world, tmp_path):
    with bn.Nest(world, store=tmp_path / "run.bn") as nest:
        world.write_sign("anne", SIGN, "one")
        nest["/sally"].edit(signs={SIGN: "two"})
        nest["/anne"].edit(blocks={SIGN: None, (5, 1, 6): "oak_wall_sign"}, signs={(5, 1, 6): "x"})
        for wrong, fault in (
            ({(0, 1, 0): "x"}, "air, which is no sign"),
            ({SIGN: "x" * 46}, "a line of 46 characters"),
            ({SIGN: "1\n2\n3\n4\n5"}, "a text of 5 lines"),
            ({SIGN: "\x1b"}, "control characters"),
        ):
            with pytest.raises(bn.InputError, match=fault):
                nest["/"].edit(signs=wrong)
        check_edited(nest)
    with bn.Nest.resume(tmp_path / "run.bn") as again:
        check_edited(again)
        assert again.at(0)["/sally"].state.signs == {SIGN: "food"}


def check_edited(nest):
    assert nest["/"].state.signs == {SIGN: "one"}
    assert nest["/sally"].state.signs == {SIGN: "two"}
    assert nest["/anne"].state.signs == {(5, 1, 6): "x"}
    assert nest["/sally"].state.blocks.basis(SIGN).source is Source.EDITED


def test_what_cannot_be_written_changes_nothing(world, nest):
    for place, text, fault in (
        ((0, 1, 0), "x", "air, which is no sign"),
        ((99, 1, 0), "x", "outside the box"),
        (SIGN, "a\u2028b", "u2028"),
    ):
        with pytest.raises(bn.WorldError, match=fault):
            world.write_sign("sally", place, text)
    assert (world.now, nest["/"].state.signs) == (0, {SIGN: "food"})
    with pytest.raises(bn.WorldError, match="which is no sign"):
        bn.ScriptedWorld(((0, 0, 0), (1, 1, 1)), signs={(0, 0, 0): "x"})


def test_a_told_block_keeps_what_is_believed_to_be_written(world):
    with bn.Nest(world, bn.Perception(testimony="accept")) as nest:
        world.place_agent("sally", (9.5, 1, 5.5))
        world.say("anne", "It was turned.", claims=[bn.Claim.block(SIGN, "oak_sign[rotation=4]")])
        assert nest["/sally"].state.signs == {SIGN: "food"}
        assert nest["/sally"].state.blocks[SIGN] == "oak_sign[rotation=4,waterlogged=false]"


def test_snapshots_of_other_makers_are_checked(world):
    snapshot = world.snapshot()
    good = {
        "tick": 0,
        "box": snapshot.box,
        "blocks": snapshot.blocks,
        "containers": {},
        "agents": {},
    }
    with pytest.raises(bn.InputError, match="the sign at"):
        Setting("x", Snapshot(**good, signs={(0, 0, 0): "x"}))


def test_prompts_say_what_signs_say_and_explanations_who_wrote_it(world, nest):
    template = "{{ branch | signs }}"
    world.write_sign("anne", SIGN, "tools\nno food")
    assert nest["/sally"].render(template) == (
        '(5, 1, 5) oak_sign: says "tools / no food"; seen now; last written on by anne 0 s ago'
    )
    assert "text:tools / no food" in nest["/sally"].render("{{ branch | events }}")
    world.place_agent("sally", (9.5, 1, 5.5))
    world.step(40)
    with world.tick():
        world.write_sign("anne", SIGN, "")
    assert "seen 2.1 s ago" in nest["/sally"].render(template)
    assert "says nothing; seen now" in nest["/anne"].render(template)
    told = str(nest["/sally"].explain(block=SIGN))
    assert "anne wiped what was written on it" in told
    assert "tick 1" in told
    prompt = nest["/sally"].render(DEFAULT, task="Find food.")
    assert "\nSigns:\n(5, 1, 5) oak_sign" in prompt
    assert "writeSign;anne" in prompt
    assert nest["/sally"].render("{{ branch | mechanisms }}") == "Not observed"


def test_a_saved_forest_is_read_where_other_texts_were_met_first(world):
    with bn.Nest(world) as nest:
        world.write_sign("anne", SIGN, "one")
        history = nest._recording.history
        forest = history.walk(TimelineKey((), "main"), [(), ("sally",)])
        history.advance(TimelineKey((), "main"), forest, 1)
        other = context_of(nest._recording.setting)
        other.number(Sign(history.context.registry.state_id("oak_wall_sign"), "else"))
        again = restored(other, forest._events, saved(forest))
        for node in (0, 1):
            assert set(other.texts(again.table.blocks(node)).values()) == {"one"}
        assert other.block_text(again.table.block(1, cell_of(other.box, SIGN))) == (
            'oak_sign[rotation=0,waterlogged=false] that says "one"'
        )


def test_signs_of_a_trace_of_another_program_are_believed(tmp_path):
    first = {
        "box": [[0, 0, 0], [8, 3, 8]],
        "blocks": [[4, 0, 4, "oak_sign"]],
        "signs": [[4, 0, 4, "food"]],
        "agents": {"sally": {"position": [2.5, 0, 2.5]}, "anne": {"position": [5.5, 0, 2.5]}},
    }
    lines = [
        first,
        {"tick": 3, "agents": {"sally": None}},
        {"tick": 5, "signs": [[4, 0, 4, "no food"]]},
    ]
    trace = tmp_path / "trace.jsonl"
    trace.write_text("\n".join(map(json.dumps, lines)))
    import_trace(load_trace(trace, Registry.load()), "trace", tmp_path / "run.bn")
    with bn.Nest.read(tmp_path / "run.bn") as nest:
        at = (4, 0, 4)
        assert nest["/anne"].state.signs == {at: "no food"}
        assert nest["/sally"].state.signs == nest["/anne/sally"].state.signs == {at: "food"}
