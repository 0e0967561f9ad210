"""Scenarios that somebody else has written, by hand or by a program: bounded, and refused whole."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

import beliefnest as bn
from beliefnest.errors import BeliefNestError, InputError, PathError, ScenarioError, WorldError
from beliefnest.nest.past.setting import Setting
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.yaml_reading import LONGEST
from beliefnest.world.frames import Snapshot
from beliefnest.worlds.scripted.world import ScriptedWorld

BASE = """\
name: small
box: [[0, 0, 0], [9, 3, 9]]
blocks: [{block: stone, fill: [[0, 0, 0], [9, 0, 9]]}]
agents: {ann: {position: [2.5, 1, 2.5]}}
containers: [{at: [5, 1, 5]}]
"""
TOO_MUCH = "items: {dirt: 1729}"
PRIOR = "initial_beliefs: [{path: /ann"
PROBE = "probes: [{path: /ann, acts_in: /, agent: ann, task: x, "
BOX = ((0, 0, 0), (9, 3, 9))


def load(folder, text):
    path = folder / "small.yaml"
    path.write_text(text, encoding="utf-8")
    return Scenario.load(str(path))


def bomb(first, each):
    """Nine aliases in each of eight lines to the line before."""
    lines = "".join(f"{b}: &{b} {each(a, b)}\n" for a, b in zip("abcdefg", "bcdefgh", strict=True))
    return f"a: &a {first}\n{lines}"


WRONG = {
    "nested in lists": (BASE + "description: " + "[" * 3000 + "]" * 3000, 6, "deep"),
    "nested in mappings": (BASE + "description: " + "{a: " * 3000 + "}" * 3000, 6, "deep"),
    "never closed": ("[" * 100_000, 1, "deep"),
    "nested by dashes": (BASE + "description:\n  " + "- " * 500 + "x", 7, "deep"),
    "a long integer": (BASE.replace("9, 3", "1" * 5001 + ", 3"), 2, "5001 digits"),
    "a long hexadecimal": (BASE.replace("9, 3", "0x" + "1" * 5001 + ", 3"), 2, "box[1][0]"),
    "aliases": (bomb("[x]", lambda a, _: f"[{', '.join([f'*{a}'] * 9)}]"), 1, "aliases"),
    "an alias of itself": ("a: &a [*a]", 1, "unknown key"),
    "a date that is none": (BASE + "description: 2020-13-45", 6, "month"),
    "a tag that is none": (BASE + "description: !!int foo", 6, "foo"),
    "a box far away": (BASE.replace("[[0,", f"[[-{2**53},"), 2, "box[0][0]"),
    "a large box": (BASE.replace("9, 3, 9", "4000, 99, 4000"), 2, "box: the box holds"),
    "a long box": (
        BASE.replace("9, 3, 9", "1999999, 0, 3"),
        2,
        "box: the box is 2,000,000 blocks long",
    ),
    "many items": (BASE.replace("2.5]}", "2.5], inventory: {dirt: 1000000000}}"), 4, "slots"),
    "items for 37 slots": (BASE.replace("2.5]}", "2.5], inventory: {bucket: 593}}"), 4, "38 slots"),
    "an item too many": (
        BASE + f"expectations: [{{path: /, container: [5, 1, 5], {TOO_MUCH}}}]",
        6,
        "28 slots",
    ),
    "a believed item too many": (
        BASE + f"{PRIOR}, containers: [{{at: [5, 1, 5], {TOO_MUCH}}}]}}]",
        6,
        "28 slots",
    ),
    "a believed place": (BASE + PRIOR + ", agents: {ann: [100, 1, 1]}}]", 6, "outside the box"),
    "an infinite place": (
        BASE + "expectations: [{path: /, agent: ann, at: [.inf, 1, 1]}]",
        6,
        "at[0]",
    ),
    "a gaze at nothing": (BASE.replace("2.5]}", "2.5], facing: [.nan, 0, 0]}"), 4, "facing"),
    "a dizzy gaze": (BASE.replace("2.5]}", "2.5], yaw: 1e300}"), 4, "yaw"),
    "an endless hearing": (BASE + "perception: {hearing: {radius: .inf}}", 6, "radius"),
    "an endless step": (
        BASE + "script: [{agent: ann, program: x, timeout_ticks: 1000000000}]",
        6,
        "timeout",
    ),
    "half an emoji": (BASE + 'script: [{agent: ann, program: "\\ud83d"}]', 6, "half a character"),
    "half an emoji in a key": (
        BASE + 'script: [{programs: {"\\ud83d": x}}]',
        6,
        "half a character",
    ),
    "an agent of JavaScript": (
        BASE.replace("ann", "__proto__"),
        4,
        "'__proto__' cannot be the name",
    ),
    "a mapping as a key": (BASE + "? {a: 1}\n: x", 6, "a key is no text"),
    "nested lists as a key": (BASE + "places:\n  [1, [2]]: x", 7, "a key is no text"),
    "a date as a key": (BASE + "places:\n  2020-01-01: x", 7, "a key is no text"),
    "a template with a zero": (BASE + PROBE + 'template: "a\\0"}]', 6, "cannot be read"),
}


@pytest.mark.parametrize(("text", "line", "told"), WRONG.values(), ids=WRONG)
def test_what_cannot_be_is_refused_with_file_and_line(tmp_path, text, line, told):
    with pytest.raises(ScenarioError) as fault:
        load(tmp_path, text)
    message = str(fault.value)
    assert message.startswith(f"{tmp_path}/small.yaml:{line}: ")
    assert told in message
    assert len(message) < 1000


def test_a_file_can_be_too_long(tmp_path):
    with pytest.raises(ScenarioError, match="longer than"):
        load(tmp_path, BASE + "#" * LONGEST)


def test_as_much_as_fits_is_taken(tmp_path):
    worn = "equipment: {head: pumpkin, off_hand: bread}"
    held = f"inventory: {{bucket: 576, pumpkin: 1, bread: 64}}, {worn}"
    scenario = load(tmp_path, BASE.replace("2.5]}", f"2.5], {held}}}"))
    assert scenario.setting.snapshot.agents["ann"].inventory["bucket"] == 576


def test_a_scenario_in_code_that_holds_itself_is_refused():
    content = {"name": "x", "box": [[0, 0, 0], [1, 1, 1]]}
    content["agents"] = content
    with pytest.raises(ScenarioError, match="deep"):
        Scenario.from_mapping(content)


# --- worlds and settings made in code hold the same bounds

IMPOSSIBLE = {
    "box": {"box": ((0, 0, 0), (2**53, 3, 9))},
    "far box": {"box": ((2**53, 0, 0), (2**53 + 3, 3, 9))},
    "long box": {"box": ((0, 0, 0), (9000, 0, 0))},
    "name": {"agents": {"__proto__": (1, 1, 1)}},
    "inventory": {"inventories": {"ann": {"dirt": 10**9}}},
    "chest": {"containers": {(3, 1, 3): {"dirt": 27 * 64 + 1}}},
    "furnace": {
        "blocks": {(3, 1, 3): "furnace"},
        "containers": {(3, 1, 3): {"dirt": 3 * 64 + 1}},
    },
    "worn": {"equipment": {"ann": {"hat": "pumpkin"}}},
    "no item": {"equipment": {"ann": {"head": "pumpkinn"}}},
    "tick": {"tick": -1},
}


@pytest.mark.parametrize("told", IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_a_scripted_world_cannot_be_impossible(told):
    with pytest.raises(WorldError):
        ScriptedWorld(**{"box": BOX, "agents": {"ann": (1, 1, 1)}, **told})


def test_what_does_not_fit_is_not_moved():
    full = {"dirt": 27 * 64}
    world = ScriptedWorld(
        BOX,
        agents={"ann": (1, 1, 1), "bob": (2, 1, 2)},
        inventories={"ann": {"dirt": 64, "bread": 1}, "bob": {"dirt": 41 * 64}},
        containers={(3, 1, 3): full},
    )
    before = world.snapshot()
    with pytest.raises(WorldError, match="slots"):
        world.deposit("ann", (3, 1, 3), {"bread": 1})
    with pytest.raises(WorldError, match="slots"):
        world.give("ann", "bob", {"bread": 1})
    with pytest.raises(WorldError, match="slots"):
        world.withdraw("bob", (3, 1, 3), {"dirt": 1})
    assert world.snapshot().agents == before.agents
    assert world.snapshot().containers == before.containers


PARTS = {
    "tick": st.integers(-(2**70), 2**70),
    "x": st.one_of(st.floats(), st.integers(-(2**70), 2**70)),
    "count": st.one_of(st.integers(-1, 3000), st.integers(0, 2**80), st.booleans(), st.floats()),
    "name": st.one_of(
        st.text(max_size=20), st.sampled_from(["__proto__", "constructor", "toString", "ann"])
    ),
    "state": st.one_of(st.integers(-2, 2), st.integers(20_000, 2**31 - 1)),
}


@given(st.fixed_dictionaries({}, optional=PARTS))
def test_a_setting_is_possible_or_refused(parts):
    world = ScriptedWorld(BOX, agents={"ann": (1, 1, 1)}, containers={(3, 1, 3): {}})
    fine = world.snapshot()
    blocks = fine.blocks.draft()
    blocks[0, 0, 0] = parts.get("state", 0)
    ann = fine.agents["ann"]
    try:
        setting = Setting(
            "x",
            Snapshot(
                parts.get("tick", 0),
                fine.box,
                blocks.terrain(),
                {(3, 1, 3): {"dirt": parts["count"]} if "count" in parts else {}},
                {parts.get("name", "ann"): type(ann)((parts.get("x", 1), 1, 1))},
            ),
        )
    except InputError as fault:
        assert "\n" not in str(fault)
        return
    with bn.Nest.open(setting, world="scripted") as nest:
        (name,) = nest.agents
        nest.scripted_world.place_agent(name, (2, 1, 2))
        assert nest[f"/{name}"].state.tick == setting.snapshot.tick + 1


TEXTS = st.sampled_from(
    [
        *("9", ".nan", "-.inf", "1e400", "1" * 5000, "2020-99-01", "~", "!!set", "!!binary x"),
        *("[", "]", "{", "}", "&a", "*a", "<<:", "? ", "- ", ": ", "|", ">", "%", "@", "\\"),
        *('"', "'", "\n", "\t"),
    ]
)


@given(changes=st.lists(st.tuples(st.integers(0, len(BASE)), st.integers(0, 4), TEXTS), max_size=4))
def test_a_garbled_file_is_read_or_refused_in_one_line(tmp_path_factory, changes):
    text = BASE
    for place, dropped, put in changes:
        text = text[:place] + put + text[place + dropped :]
    try:
        load(tmp_path_factory.getbasetemp(), text)
    except BeliefNestError as fault:
        assert "\n" not in str(fault)
        assert "small.yaml" in str(fault)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({"blocks": {(99, 1, 1): 1}}, "(99, 1, 1), which lies outside the box"),
        ({"blocks": {(1, 1, 1): 10**9}}, "block state 1000000000"),
        ({"containers": {(1, 1, 99): ({}, True)}}, "(1, 1, 99), which lies outside the box"),
        ({"containers": {(1, 1, 1): ({"dirt": 10**9}, True)}}, "slots"),
        ({"agents": {"ann": (float("nan"), 1, 1)}}, "ann in the initial belief '/ann'"),
    ],
)
def test_priors_made_in_code_are_checked_as_those_of_files(said, told):
    world = ScriptedWorld(BOX, {}, {"ann": (2.5, 1, 2.5)})
    with pytest.raises(InputError) as fault:
        bn.Nest(world, initial_beliefs=[bn.InitialBelief(("ann",), **said)])
    assert told in str(fault.value)


def test_a_belief_path_has_an_end():
    world = ScriptedWorld(BOX, {}, {"ann": (2.5, 1, 2.5), "bob": (4.5, 1, 2.5)})
    with bn.Nest(world) as nest:
        assert nest["/ann/ann" * 5000].path == "/ann"
        with pytest.raises(PathError, match=r"100 beliefs deep; at most 50 are possible"):
            nest["/ann/bob" * 50]
        with pytest.raises(PathError, match=r"51 beliefs deep"):
            nest["/ann/bob" * 25].child("ann")
