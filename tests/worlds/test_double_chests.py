"""Two halves of a chest are one chest of 54 slots, in both worlds and in every belief."""

from collections.abc import Sequence
from typing import Any

import pytest
from tests.pictures.measuring import texts
from tests.shared_worlds import WORLDS

import beliefnest as bn
from beliefnest.errors import ScenarioError
from beliefnest.llm.messages import Answer, Message, Sampling
from beliefnest.prompts.templates import built_in_template
from beliefnest.scenarios.running import run_scenario
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.double_chests import ByEitherHalf


class _Same:
    """Answers everything with one program."""

    name = "same"

    def __init__(self, program: str) -> None:
        self.text = f"```javascript\n{program}\n```"

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        return Answer(self.text)


pytestmark = pytest.mark.usefixtures("kept_worlds")

RIGHT, LEFT = (4, 1, 2), (5, 1, 2)
HALVES = (RIGHT, LEFT)
PATHS = ("/", "/ann", "/bob", "/bob/ann")


def chests(right: str = "chest[facing=south,type=right]", left: str = "") -> list[dict[str, Any]]:
    other = left or right.replace("type=right", "type=left")
    return [
        {"at": RIGHT, "block": right, "items": {"diamond": 1}, "label": "the long chest"},
        {"at": LEFT, "block": other, "items": {"bone": 2}},
    ]


def scenario(containers: list[dict[str, Any]], **more: Any) -> Scenario:
    floor = {"block": "stone", "fill": [[0, 0, 0], [12, 0, 8]]}
    agents = {
        "ann": {"position": [3.5, 1, 4.5], "inventory": {"apple": 65}},
        "bob": {"position": [6.5, 1, 5.5]},
    }
    written = {
        "name": "double",
        "description": "A chest of two halves.",
        "box": [[0, 0, 0], [12, 4, 8]],
        "blocks": [floor],
        "agents": agents,
        "containers": containers,
        **more,
    }
    return Scenario.from_mapping(written)


def filled(right: int, left: int) -> list[dict[str, Any]]:
    return [
        {**each, "items": {"stone": count} if count else {}}
        for each, count in zip(chests(), (right, left), strict=True)
    ]


def run(nest: bn.Nest, program: str) -> None:
    result = nest["/"].run("ann", program)
    assert result.ok, result.error


def held(nest: bn.Nest) -> dict[str, dict[tuple[int, int, int], tuple[dict[str, int], bool]]]:
    return {
        path: {
            at: (dict(each.items), each.complete)
            for at, each in nest[path].state.containers.items()
        }
        for path in PATHS
    }


@pytest.mark.parametrize("name", ["chest", "trapped_chest"])
@pytest.mark.parametrize("world", WORLDS)
def test_either_half_is_the_whole_chest(world: str, name: str) -> None:
    found = scenario(chests(f"{name}[facing=south,type=right]"))
    with bn.Nest.open(found, world=world) as nest:
        run(nest, "await getItemFromChest(bot, new Vec3(4,1,2), {diamond: 1, bone: 1});")
        run(nest, "await depositItemIntoChest(bot, new Vec3(5,1,2), {apple: 2});")
        assert held(nest) == {
            "/": {RIGHT: ({"apple": 2, "bone": 1}, True)},
            "/ann": {RIGHT: ({"apple": 2, "bone": 1}, True)},
            "/bob": {RIGHT: ({"apple": 2}, False)},
            "/bob/ann": {RIGHT: ({"apple": 2}, False)},
        }
        acts = [e for e in nest["/"].state.events if "position" in e.detail]
        assert {tuple(e.detail["position"]) for e in acts} == {RIGHT}
        for path in PATHS:
            contents = nest[path].state.containers
            assert LEFT in contents
            assert contents[LEFT] == contents[RIGHT]
            assert list(contents) == [RIGHT]
            told = [str(nest[path].explain(container=half)) for half in HALVES]
            assert told[0] == told[1]


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize(
    ("right", "left"),
    [
        ("chest[facing=south]", "chest[facing=south]"),
        ("chest[facing=south,type=left]", "chest[facing=south,type=right]"),
        ("chest[facing=south,type=right]", "chest[facing=north,type=left]"),
        ("chest[facing=south,type=right]", "trapped_chest[facing=south,type=left]"),
    ],
    ids=["singles", "swapped", "facing apart", "two kinds"],
)
def test_what_does_not_belong_together_stays_two_chests(world: str, right: str, left: str) -> None:
    with bn.Nest.open(scenario(chests(right, left)), world=world) as nest:
        run(nest, "await getItemFromChest(bot, new Vec3(5,1,2), {bone: 1});")
        real = {RIGHT: ({"diamond": 1}, True), LEFT: ({"bone": 1}, True)}
        assert held(nest)["/"] == real
        assert list(held(nest)["/bob"]) == [RIGHT, LEFT]
        assert "type=single" in nest["/"].state.blocks[RIGHT]
        failed = nest["/"].run("ann", "await getItemFromChest(bot, new Vec3(4,1,2), {bone: 1});")
        assert "bone" in str(failed.error)


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("half", HALVES)
def test_it_has_54_slots(world: str, half: tuple[int, int, int]) -> None:
    found = scenario(filled(0, 53 * 64) if half == LEFT else filled(53 * 64, 0))
    at = ",".join(map(str, half))
    with bn.Nest.open(found, world=world) as nest:
        run(nest, f"await depositItemIntoChest(bot, new Vec3({at}), {{apple: 64}});")
        assert held(nest)["/"] == {RIGHT: ({"apple": 64, "stone": 3392}, True)}
        result = nest["/"].run(
            "ann", f"await depositItemIntoChest(bot, new Vec3({at}), {{apple: 1}});"
        )
        assert not result.ok


def test_more_than_54_slots_are_refused() -> None:
    with pytest.raises(ScenarioError, match=r"55 slots.*has 54"):
        scenario(filled(53 * 64, 65))


@pytest.mark.parametrize("world", WORLDS)
def test_scenarios_may_name_either_half(world: str) -> None:
    known = {"at": LEFT, "items": {"emerald": 1}, "complete": True}
    found = scenario(
        chests(),
        initial_beliefs=[{"path": "/bob", "containers": [known]}],
        expectations=[
            {"path": "/bob", "container": LEFT, "items": {"emerald": 1}},
            {"path": "/", "container": LEFT, "items": {"diamond": 1, "bone": 2}},
        ],
        probes=[
            {
                "path": "/ann",
                "acts_in": "/ann",
                "agent": "ann",
                "task": "Get a bone.",
                "expect": {"opens": LEFT, "intends": LEFT, "within": 2, "takes": {"bone": 1}},
            }
        ],
    )
    program = "await getItemFromChest(bot, new Vec3(4,1,2), {bone: 1});"
    with bn.Nest.open(found, world=world) as nest:
        nest["/ann"].edit(containers={RIGHT: {"bone": 1}})
        played = run_scenario(nest, found, _Same(program), 0, 0.0, lambda *_: None)
        assert [each.why_not for each in played.expectations] == [None, None]
        assert [each.ok for each in played.probes] == [True]


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("half", HALVES)
def test_claims_name_either_half(world: str, half: tuple[int, int, int]) -> None:
    found = scenario(chests(), perception={"testimony": "accept"})
    with bn.Nest.open(found, world=world) as nest:
        at = ",".join(map(str, half))
        run(nest, f'await say(bot, "It is there.", [located("emerald", new Vec3({at}))]);')
        nest["/"].step(2)
        assert held(nest)["/bob"] == {RIGHT: ({"emerald": 1}, False)}
        run(nest, f'await say(bot, "No.", [absent("emerald", new Vec3({at}))]);')
        nest["/"].step(2)
        assert held(nest)["/bob"] == {RIGHT: ({}, False)}


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("half", HALVES)
def test_edits_name_either_half(world: str, half: tuple[int, int, int]) -> None:
    with bn.Nest.open(scenario(chests()), world=world) as nest:
        nest["/bob"].edit(containers={half: {"emerald": 40}})
        assert held(nest)["/bob"] == {RIGHT: ({"emerald": 40}, True)}
        nest["/"].edit(blocks={half: "air"})
        (rest,) = [each for each in HALVES if each != half]
        assert "type=single" in nest["/"].state.blocks[rest]
        assert list(nest["/"].state.containers) == [rest]


@pytest.mark.parametrize("world", WORLDS)
def test_prompts_list_one_chest(world: str) -> None:
    found = scenario([{**each, "label": ""} for each in chests()])
    with bn.Nest.open(found, world=world) as nest:
        run(nest, "await getItemFromChest(bot, new Vec3(5,1,2), {bone: 1});")
        for name in ("default", "paper", "story"):
            for path in ("/ann", "/bob"):
                text = nest[path].render(built_in_template(name), task="Get a bone.")
                assert "(4, 1, 2)" in text
                assert "(5, 1, 2)" not in text
                assert "western" not in text


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("hidden", HALVES)
@pytest.mark.parametrize("contents", ["opaque", "transparent"])
def test_the_sight_of_either_half_is_that_of_the_chest(
    world: str, hidden: tuple[int, int, int], contents: str
) -> None:
    # Both look along the chest, below a beam.
    spots = (9.5, 8.5) if hidden == RIGHT else (1.5, 0.5)
    agents = {
        name: {"position": [x, 1, 2.5]} for name, x in zip(("ann", "bob"), spots, strict=True)
    }
    found = scenario(
        chests(),
        perception={"containers": contents},
        agents=agents,
        blocks=[
            {"block": "stone", "fill": [[0, 0, 0], [12, 0, 8]]},
            {"block": "bricks", "fill": [[4, 2, 2], [5, 2, 2]]},
        ],
    )
    knows = {"diamond": 1, "bone": 2} if contents == "transparent" else {}
    with bn.Nest.open(found, world=world) as nest:
        for path in PATHS[1:]:
            state = nest[path].state
            assert state.blocks[hidden] is None
            assert list(state.containers) == [RIGHT]
            assert dict(state.containers[hidden].items) == knows
            text = nest[path].render(built_in_template("default"), task="Get a bone.")
            assert "(4, 1, 2)" in text
        nest["/"].edit(blocks={LEFT: "air", RIGHT: "air"})
        assert [list(nest[path].state.containers) for path in PATHS] == [[]] * 4


@pytest.mark.parametrize("world", WORLDS)
def test_a_half_whose_other_half_was_not_seen_has_one_in_bodies(world: str) -> None:
    with bn.Nest.open(scenario(chests()), world=world) as nest:
        nest["/bob"].switch("alone")
        nest["/bob"].edit(blocks={RIGHT: None})
        assert RIGHT in nest["/bob"].placed
        result = nest["/bob"].run("bob", "await bot.openContainer(bot.blockAt(new Vec3(5,1,2)));")
        assert result.ok, result.error


def test_lookups_by_half_count_each_container_once() -> None:
    both = ByEitherHalf({RIGHT: "held"}, lambda at: RIGHT if at == LEFT else at)
    assert (both[LEFT], both.get(LEFT), LEFT in both) == ("held", "held", True)
    assert (both.get((0, 0, 0)), (0, 0, 0) in both) == (None, False)
    assert (len(both), list(both), both) == (1, [RIGHT], {RIGHT: "held"})


def heard_of(blocks: dict[tuple[int, int, int], str], place: tuple[int, int, int]) -> bn.Nest:
    """Return a nest in which Ann claims to Bob what a block holds behind a full wall."""
    wall = {(6, y, z): "bricks" for y in range(4) for z in range(5)}
    floor = {(x, 0, z): "stone" for x in range(12) for z in range(5)}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (11, 3, 4)),
        {**floor, **wall, **blocks},
        {"ann": (2.5, 1, 1.5), "bob": (4.5, 1, 2.5)},
        containers={at: {} for at in blocks if "left" not in blocks[at]},
    )
    nest = bn.Nest(world, bn.Perception(testimony="accept"))
    world.say("ann", "It is there.", claims=[bn.Claim.located("emerald", place)])
    return nest


def test_claims_about_halves_that_nobody_knows_mean_what_was_said() -> None:
    left, right = (9, 1, 2), (8, 1, 2)
    double = {left: "chest[facing=south,type=left]", right: "chest[facing=south,type=right]"}
    nests = [heard_of(blocks, left) for blocks in ({left: "chest"}, double, {})]
    for path in ("/bob", "/bob/ann"):
        told = {repr(nest[path].state) for nest in nests}
        assert len(told) == 1
    assert [dict(nest["/bob"].state.containers[left].items) for nest in nests] == [
        {"emerald": 1}
    ] * 3
    world = nests[1].scripted_world
    # Bob comes to see the chest: what he heard is about its left half, and he learns of the whole.
    world.place_agent("bob", (8.5, 1, 3.5))
    assert str(nests[1]["/bob"].state.blocks[left]).startswith("chest")
    world.say("ann", "It is there.", claims=[bn.Claim.located("emerald", left)])
    assert dict(nests[1]["/bob"].state.containers[right].items) == {"emerald": 1}
    assert "emerald is in (8, 1, 2)" in str(nests[1]["/bob"].explain(container=right))


@pytest.mark.parametrize("half", HALVES)
def test_either_half_names_the_chest_in_claims_doubts_and_plots(half: tuple[int, int, int]) -> None:
    other = (9, 1, 2)
    floor = {(x, 0, z): "stone" for x in range(12) for z in range(6)}
    double = {
        place: f"chest[facing=south,type={n}]" for place, n in ((LEFT, "left"), (RIGHT, "right"))
    }
    agents = {"ann": (3.5, 1, 4.5), "bob": (6.5, 1, 4.5)}
    contents = {RIGHT: {"emerald": 1}, other: {}}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (11, 3, 5)), {**floor, **double}, agents, containers=contents
    )
    nest = bn.Nest(world, bn.Perception(testimony="accept"))
    doubt = {
        name: [
            {"container": half, "items": {"emerald": 1} if name == "long" else {}},
            {"container": other, "items": {} if name == "long" else {"emerald": 1}},
        ]
        for name in ("long", "single")
    }
    world.say("ann", "It is there.", claims=[bn.Claim.located("emerald", half)])
    assert nest["/"].credence("bob", doubt) == {"long": 1.0, "single": 0.0}
    ((_, _, claim),) = nest["/bob"].heard_claims
    assert claim.cell == RIGHT
    for asked in HALVES:
        drawing = nest.plot_beliefs(asked, paths=["/bob"]).drawing()
        assert any("emerald is in" in text for text in texts(drawing))
