"""Reading of stories: the text alone must say what the nest computes."""

import itertools
import random
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.profiles import at_night

import beliefnest as bn
from beliefnest.llm.offline.offline_model import OfflineModel
from beliefnest.scenarios.prose_check import ProseWarning
from beliefnest.scenarios.prose_reading import (
    UnreadError,
    read_contents,
    read_last_seen,
    read_places,
)
from beliefnest.scenarios.running import run_scenario

NAMES = ("ann", "bob", "cat")
BOX = ((0, 0, 0), (10, 3, 6))
WALL = {(5, y, z): "bricks" for y in range(4) for z in range(7) if z != 3 or y not in (1, 2)}
FLOOR = {(x, 0, z): "stone" for x in range(11) for z in range(7)}
SPOTS = [(1.5, 1, 1.5), (2.5, 1, 5.5), (3.5, 1, 3.5), (7.5, 1, 1.5), (8.5, 1, 5.5), (7.5, 1, 3.5)]
CHESTS = [(2, 1, 0), (4, 1, 6), (9, 1, 0)]
PATHS = [
    path
    for depth in range(4)
    for path in itertools.product(NAMES, repeat=depth)
    if all(one != other for one, other in itertools.pairwise(path))
]


def act(world: bn.ScriptedWorld, chance: random.Random, names: dict) -> None:
    """Do one random act; it may be impossible."""
    who, at, one = chance.choice(NAMES), chance.choice(CHESTS), {"diamond": 1}
    match chance.choice(["walk", "walk", "put", "put", "take", "take", "look", "say"]):
        case "walk":
            spot = chance.choice(SPOTS)
            world.place_agent(who, spot)
            world.arrive(who, spot)
        case "put":
            world.deposit(who, at, one)
        case "take":
            world.withdraw(who, at, one)
        case "look":
            world.open(who, at)
        case "say":
            claim = bn.Claim.located("diamond", at)
            world.say(who, f"The diamond is in the {names[at]}.", [claim])


def stories(seed: int) -> Iterator[tuple[str, bn.Nest, str]]:
    """Yield the story of a random course of events, its nest, and how hearers take claims."""
    chance = random.Random(f"prose {seed}")
    testimony = chance.choice(["none", "accept"])
    world = bn.ScriptedWorld(
        BOX,
        FLOOR | WALL,
        {name: chance.choice(SPOTS) for name in NAMES},
        inventories={"ann": {"diamond": 1}},
        containers={at: {} for at in CHESTS},
    )
    hearing = chance.choice(["global", "sight", {"radius": 5}])
    perception = bn.Perception(hearing=hearing, testimony=testimony)
    unique = ["diamond"] if chance.random() < 0.5 else []
    with bn.Nest(
        world, perception, static_blocks=["stone", "bricks", "air"], unique=unique
    ) as nest:
        for _ in range(chance.randint(3, 9)):
            try:
                act(world, chance, dict(nest["/"].names))
            except bn.WorldError:
                continue
        told = nest["/"].render("{{ branch | beginning }} {{ branch | story }}")
        yield told, nest, testimony


def places(nest: bn.Nest, path: tuple[str, ...]) -> set[str]:
    """Return where a belief has the diamond, in the narrator's words."""
    state, names = nest["/" + "/".join(path)].state, nest["/"].names
    found = {f"the {names[at]}" for at, c in state.containers.items() if c.items.get("diamond")}
    return found | {n.title() for n, agent in state.agents.items() if "diamond" in agent.inventory}


def test_stories_say_what_the_nest_computes() -> None:
    right = wrong = 0
    for seed in range(at_night(500, 25)):
        for told, nest, testimony in stories(seed):
            for path in PATHS:
                same = set(read_places(told, path, "diamond", testimony)) == places(nest, path)
                right, wrong = right + same, wrong + (not same)
                assert same or len(path) > 1, f"{seed} {path} {told}"
    # Deep beliefs can rest on more than is told.
    assert wrong <= 0.02 * right


@pytest.mark.parametrize(
    ("told", "path", "found"),
    [
        ("Ann had an apple. Nobody else knew that.", ("bob",), set()),
        ("Ann had an apple. Only Bob knew that.", ("bob",), {"Ann"}),
        ("Ann had an apple. Everybody else knew that.", ("bob", "cat"), {"Ann"}),
        ("Ann put an apple into the box.", ("bob",), set()),
        ("At first Bob could see Ann. Ann put an apple into the box.", ("bob",), {"the box"}),
        ("At first Bob could see Ann. Ann put an apple into the box.", ("bob", "cat"), set()),
        ("Ann said: “The apple is in the box.” Only Bob heard it.", ("bob",), {"the box"}),
        ("Ann said: “The apple is in the box.” Only Bob heard it.", ("cat",), set()),
        ("Ann said: “The apple isn't in the box.”", ("cat",), set()),
        ("In the box was an apple. Ann opened the box.", ("ann",), {"the box"}),
    ],
)
def test_sentences(told: str, path: tuple[str, ...], found: set[str]) -> None:
    story = f"This is a story about Ann, Bob and Cat. There were the box and the bag. {told}"
    assert read_places(story, path, "apple", "accept") == found


@pytest.mark.parametrize(
    "told",
    ["Ann put 2 apples into the box.", "Ann threw an apple away.", "On the floor lay an apple."],
)
def test_what_the_reader_does_not_know_it_does_not_judge(told: str) -> None:
    story = f"This is a story about Ann and Bob. There was the box. {told}"
    with pytest.raises(UnreadError):
        read_places(story, ("ann",), "apple", "accept")


ROOM = """
name: room
box: [[0, 0, 0], [8, 3, 6]]
blocks: [{block: stone, fill: [[0, 0, 0], [8, 0, 6]]}]
containers: [{at: [2, 1, 2], label: red box}, {at: [5, 1, 2], label: blue box}]
agents:
  ann: {position: [3.5, 1, 4.5], inventory: {apple: 1}}
  bob: {position: [5.5, 1, 4.5]}
static_blocks: [stone, air]
initial_beliefs: PRIOR
script:
  - {agent: ann, program: "await waitTicks(bot, 2);"}
probes:
  - label: what Bob thinks
    path: /
    template: story
    expect:
      answers:
        question: Where does Bob think the apple is?
        options: [red box, Ann, nobody can know]
        right: {path: /bob, item: apple, unknown: nobody can know}
"""


def warned(folder: Path, text: str) -> list[str]:
    """Return the warnings of a scenario."""
    file = folder / "scenario.yaml"
    file.write_text(text)
    scenario = bn.Scenario.load(str(file))
    with bn.Nest.open(scenario, "scripted") as nest, warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", ProseWarning)
        run_scenario(nest, scenario, OfflineModel(), 0, 0.0, lambda *_: None)
    return [str(each.message) for each in found if each.category is ProseWarning]


def test_answers_that_do_not_follow_are_named_with_probe_and_line(tmp_path: Path) -> None:
    assert warned(tmp_path, ROOM.replace("PRIOR", "[]")) == []
    assert (
        warned(tmp_path, ROOM.replace("PRIOR", "[{path: /bob, inventories: {ann: {apple: 1}}}]"))
        == []
    )
    # A narrator does not tell what others take for granted.
    prior = "[{path: /bob, containers: [{at: [2, 1, 2], items: {apple: 1}}]}]"
    (told,) = warned(tmp_path, ROOM.replace("PRIOR", prior))
    assert "scenario.yaml:" in told
    assert "probe 'what Bob thinks': the right answer 'red box' does not follow" in told


@pytest.mark.parametrize(
    ("told", "path", "thing", "found"),
    [
        ("Ann stood at the sofa.", ("bob",), "Ann", ""),
        ("Ann stood at the sofa. At first Bob could see Ann.", ("bob",), "Ann", "the sofa"),
        (
            "Ann stood at the sofa. All of them could see one another. Bob could no longer see "
            "Ann, nor could Ann see Bob. Ann walked to the garden.",
            ("ann", "bob"),
            "Ann",
            "the sofa",
        ),
        (
            "Ann stood at the sofa. At first Bob could see Ann. Ann walked to the garden.",
            ("bob",),
            "Ann",
            "the garden",
        ),
        ("On the sign was written: “Go. Now”.", ("bob",), "the sign", ""),
        (
            "On the sign was written: “north”. At first Bob could see the sign. Bob could no "
            "longer see the sign. Ann wrote on the sign: “south”.",
            ("bob",),
            "the sign",
            "north",
        ),
        (
            "Nothing was written on the sign. At first Bob could see the sign.",
            ("bob",),
            "the sign",
            "nothing",
        ),
    ],
)
def test_what_was_last_seen(told: str, path: tuple[str, ...], thing: str, found: str) -> None:
    story = f"This is a story about Ann, Bob and Cat. There were the box and the sign. {told}"
    assert read_last_seen(story, path, thing, "none") == found


@pytest.mark.parametrize(
    "told",
    [
        # Walks to containers are not told.
        "Ann stood at the sofa. At first Bob could see Ann. Ann opened the box.",
        # Bob may have seen no more than the beginning of the walk, or its end.
        "Ann stood at the sofa. At first Bob could see Ann. Ann walked to the garden. Bob could no "
        "longer see Ann.",
        "Ann stood at the sofa. Bob could now see Ann. Bob could no longer see Ann. Ann walked to "
        "the garden.",
        "Ann stood at the sofa. At first Bob could see Ann. Cat said: “Ann is elsewhere.”",
        "At first Bob could see Ann.",
    ],
)
def test_what_is_not_clear_of_an_agent_is_not_judged(told: str) -> None:
    story = f"This is a story about Ann, Bob and Cat. There was the box. {told}"
    with pytest.raises(UnreadError):
        read_last_seen(story, ("bob",), "Ann", "accept")


def test_contents() -> None:
    story = (
        "This is a story about Ann and Bob. There were the box and the bag. In the box were an "
        "apple and a book. At first Bob could see Ann. Bob opened the box. Ann took an apple out "
        "of the box."
    )
    items = ("apple", "book", "bread")
    assert read_contents(story, ("bob",), "the box", items, "none") == {"book"}
    assert read_contents(story, ("bob", "ann"), "the bag", items, "none") == set()


HALL = """
name: hall
box: [[0, 0, 0], [12, 3, 6]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [12, 0, 6]]}
  - {block: bricks, fill: [[8, 1, 0], [8, 3, 6]]}
containers: [{at: [5, 1, 5], label: red box, items: {apple: 1, book: 1}}]
signs: [{at: [5, 1, 1], text: north}]
places: {sofa: [1, 1, 1], window: [1, 1, 5]}
agents:
  ann: {position: [1.5, 1, 1.5]}
  bob: {position: [5.5, 1, 3.5]}
  cat: {position: [10.5, 1, 3.5]}
static_blocks: [stone, bricks, air]
initial_beliefs:
  - path: /cat
    agents: {ann: [1.5, 1, 5.5]}
    containers: [{at: [5, 1, 5], items: {apple: 1}}]
    signs: [{at: [5, 1, 1], text: north, block: oak_sign}]
script:
  - {agent: ann, program: "await goToPosition(bot, new Vec3(1, 1, 5), 0);"}
  - {agent: bob, program: "await getItemFromChest(bot, new Vec3(5, 1, 5), {book: 1});"}
probes:
  - label: what somebody thinks
    path: /
    template: story
    expect:
      answers:
        question: What is it?
        options: [sofa, window, apple, book, north, south, unknown]
        right: RIGHT
"""


@pytest.mark.parametrize("kind", ["agent: ann", "container: [5, 1, 5]", "sign: [5, 1, 1]"])
def test_each_kind_of_question_is_read_back(tmp_path: Path, kind: str) -> None:
    assert warned(tmp_path, HALL.replace("RIGHT", f"{{path: /bob, {kind}}}")) == []
    assert warned(tmp_path, HALL.replace("RIGHT", f"{{path: /, {kind}}}")) == []
    # Cat sees nothing of it: it takes for granted what the narrator does not tell.
    (told,) = warned(tmp_path, HALL.replace("RIGHT", f"{{path: /cat, {kind}}}"))
    assert "scenario.yaml:31: " in told
    assert "does not follow from the story, which says 'unknown'" in told


def test_a_question_about_a_block_is_named_as_not_checked(tmp_path: Path) -> None:
    text = HALL.replace("unknown]", "unknown, chest]").replace(
        "RIGHT", "{path: /bob, block: [5, 1, 5]}"
    )
    (told,) = warned(tmp_path, text)
    assert "scenario.yaml:31: " in told
    assert "not checked that the right answer 'chest' follows from the story" in told


def test_a_name_of_a_place_that_is_no_option_is_not_judged(tmp_path: Path) -> None:
    near = HALL.replace("window: [1, 1, 5]", "window: [1, 1, 5], curtain: [2, 1, 5]")
    text = near.replace("[sofa, window,", "[sofa, curtain,")
    assert warned(tmp_path, text.replace("RIGHT", "{path: /bob, agent: ann}")) == []
    # An answer "nobody was seen" is judged with any options.
    assert len(warned(tmp_path, text.replace("RIGHT", "{path: /cat, agent: ann}"))) == 1


def test_nobody_who_sees_nothing_counts_as_one_of_all(tmp_path: Path) -> None:
    file = tmp_path / "scenario.yaml"
    file.write_text(HALL.replace("RIGHT", "{path: /, agent: ann}"))
    with bn.Nest.open(bn.Scenario.load(str(file)), "scripted") as nest:
        told = nest["/"].render("{{ branch | beginning }}")
    assert "All of them" not in told
    assert "At first Ann could see Bob, the sign and the red box." in told
