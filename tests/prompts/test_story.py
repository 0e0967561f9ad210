"""Stories: prompts as prose, and tables of observations."""

from collections.abc import Iterator
from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.llm.messages import Message, Sampling
from beliefnest.llm.offline.offline_model import OfflineModel
from beliefnest.prompts import built_in_template
from beliefnest.prompts.story_filters import captions
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES

SCENE = """
name: lie
box: [[0, 0, 0], [16, 3, 10]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [16, 0, 10]]}
  - {block: bricks, fill: [[9, 1, 0], [9, 3, 7]]}
containers:
  - {at: [2, 1, 2], block: chest}
  - {at: [6, 1, 2], block: chest}
  - {at: [4, 1, 1], block: barrel, label: A, items: {apple: 1}}
signs:
  - {at: [4, 1, 7], text: no toys}
places: {garden: [13, 1, 2]}
agents:
  lia: {position: [3.5, 1, 4.5], inventory: {diamond: 1}}
  wim: {position: [5.5, 1, 5.5]}
  tom: {position: [7.5, 1, 5.5]}
static_blocks: [stone, bricks]
initial_beliefs:
  - {path: /tom, containers: [{at: [4, 1, 1], items: {cookie: 2}}]}
script:
  - {agent: lia, program: "await depositItemIntoChest(bot, new Vec3(2, 1, 2), {diamond: 1});"}
  - {agent: wim, program: "await goToPosition(bot, new Vec3(13, 1, 2), 0);"}
  - agent: tom
    program: |
      await getItemFromChest(bot, new Vec3(2, 1, 2), {diamond: 1});
      await depositItemIntoChest(bot, new Vec3(6, 1, 2), {diamond: 1});
  - {agent: lia, program: "await say(bot, 'The diamond is in A.');"}
"""


@pytest.fixture(scope="module")
def nest(tmp_path_factory: pytest.TempPathFactory) -> Iterator[bn.Nest]:
    file: Path = tmp_path_factory.mktemp("story") / "lie.yaml"
    file.write_text(SCENE)
    with bn.Nest.open(bn.Scenario.load(str(file)), "scripted") as opened:
        opened.play()
        yield opened


def story(nest: bn.Nest, path: str, **variables: object) -> str:
    return nest[path].render(built_in_template("story"), **variables)


@pytest.mark.parametrize(
    ("belief", "containers", "told"),
    [
        ("{path: /tom, containers: [{at: [4, 1, 1], items: {cookie: 2}}]}", "opaque", "Nobody"),
        ("{path: /tom, containers: [{at: [4, 1, 1], items: {apple: 1}}]}", "opaque", "Only Tom"),
        ("{path: /**, containers: [{at: [4, 1, 1], items: {apple: 1}}]}", "opaque", "Everybody"),
        ("{path: /tom, containers: [{at: [4, 1, 1], items: {apple: 1}}]}", "transparent", ""),
    ],
)
def test_a_narrator_says_who_knows_of_contents_that_nobody_sees(belief, containers, told, tmp_path):
    file = tmp_path / "known.yaml"
    before, _, after = SCENE.partition("initial_beliefs:\n")
    script = after[after.index("script:") :]
    file.write_text(
        f"{before}perception: {{containers: {containers}}}\ninitial_beliefs: [{belief}]\n{script}"
    )
    with bn.Nest.open(bn.Scenario.load(str(file)), "scripted") as opened:
        beginning = opened["/"].render("{{ branch | beginning }}")
        alone = opened["/tom"].render("{{ branch | beginning }}")
    known = f" {told} knew that." if told else ""
    assert f"In A was an apple.{known} The western chest" in beginning
    assert "knew that" not in alone


def test_contents_taken_for_granted_are_in_the_thing_with_its_label(tmp_path):
    file = tmp_path / "hidden.yaml"
    hidden = "signs:\n".join(["  - {at: [14, 1, 2], block: barrel, label: B}\n", ""])
    belief = "  - {path: /lia, containers: [{at: [14, 1, 2], items: {cookie: 1}}]}\nscript:"
    file.write_text(SCENE.replace("signs:\n", hidden).replace("script:", belief))
    with bn.Nest.open(bn.Scenario.load(str(file)), "scripted") as opened:
        beginning = opened["/lia"].render("{{ branch | beginning }}")
        others = opened["/wim"].render("{{ branch | beginning }}")
    assert "You took it for granted that a cookie was in B." in beginning
    assert " B" not in others


def test_agents_taken_for_granted_are_told_of_with_their_place_and_things(tmp_path):
    file = tmp_path / "absent.yaml"
    agent = "  max: {position: [13.5, 1, 2.5], inventory: {egg: 1}}\nstatic_blocks:"
    belief = "{path: /lia, agents: {max: [13.5, 1, 2.5]}, inventories: {max: {bread: 2}}}"
    scene = SCENE.replace("static_blocks:", agent).replace("script:", f"  - {belief}\nscript:")
    file.write_text(scene)
    with bn.Nest.open(bn.Scenario.load(str(file)), "scripted") as opened:
        beginning = opened["/lia"].render("{{ branch | beginning }}")
        rows = opened["/lia"].render("{{ branch | observations }}")
        others = opened["/wim"].render("{{ branch | beginning }}")
    said = "You took it for granted that Max stood at the garden and had 2 breads."
    assert said in beginning
    assert ";assumed;max;position:[13.5, 1, 2.5] & items:{'bread': 2}" in rows
    assert "Max" not in others


def test_a_story_is_told_from_the_view_of_the_mind(nest):
    assert story(nest, "/lia", question="Where?", options=("here", "there")) == (
        "You are Lia.\n\n"
        "At first you could see Tom, Wim, the western chest, A, the sign and the eastern chest. "
        "You stood near the western chest. Wim stood near the sign. You had a diamond. "
        "On the sign was written: “no toys”.\n\n"
        "You opened the western chest. It was empty. You put a diamond into it. "
        "You could no longer see Wim. "
        "Tom opened the western chest and took a diamond out of it. "
        "Tom opened the eastern chest and put a diamond into it. "
        "You said: “The diamond is in A.”\n\n"
        "Question: Where?\n\nOptions:\nA) here\nB) there\n"
    )


@pytest.mark.usefixtures("kept_worlds")
def test_bots_in_minecraft_make_the_same_story(nest, tmp_path):
    # There the opening of a chest and its first use fall into one tick.
    (tmp_path / "lie.yaml").write_text(SCENE)
    with bn.Nest.open(bn.Scenario.load(str(tmp_path / "lie.yaml")), "embedded") as opened:
        opened.play()
        for path in ("/", "/lia", "/tom", "/lia/wim"):
            assert story(opened, path) == story(nest, path)


def test_a_mind_is_told_only_what_it_observed(nest):
    wim = story(nest, "/wim", question="Where?")
    assert "Tom opened" not in wim
    assert "You walked to the garden. You could no longer see Lia, Tom or any of the things" in wim
    # Observations, not beliefs: nobody has looked into A.
    assert "apple" not in wim
    assert "empty" not in wim


@pytest.mark.parametrize(
    ("end", "words"),
    [
        ("4, 1, 1", "to A"),  # it ends beside the barrel, which is the destination itself
        ("5, 1, 2", "to the eastern chest"),
        ("6, 1, 4", "to another place"),
        ("15, 1, 2", "to the garden"),
    ],
)
def test_a_walk_leads_to_a_thing_only_if_it_ends_next_to_it(tmp_path, end, words):
    scene, _, _ = SCENE.partition("script:")
    walk = f"await goToPosition(bot, new Vec3({end}), 1);"
    file = tmp_path / "walk.yaml"
    file.write_text(f"{scene}script:\n  - {{agent: lia, program: '{walk}'}}\n")
    with bn.Nest.open(bn.Scenario.load(str(file)), "scripted") as opened:
        opened.play()
        assert f"Lia walked {words}." in story(opened, "/", question="?")


def test_what_is_assumed_differs_from_what_was_seen(nest):
    assert "granted" not in story(nest, "/lia")
    assert "took it for granted that 2 cookies were in A" in story(nest, "/tom", question="?")


def test_a_narrator_tells_everything_and_who_could_see_what(nest):
    told = story(nest, "/", question="Where does Wim think the diamond is?")
    assert told.startswith("This is a story about Lia, Tom and Wim. There were ")
    assert "In A was an apple." in told
    assert "nor could Lia or Tom see Wim. Tom opened the western chest" in told
    assert "believe" not in told
    assert "(" not in told


def test_a_story_has_coordinates_if_they_are_wanted(nest):
    told = story(nest, "/wim", task="Get a diamond.", instructed=True)
    assert "Lia opened the western chest at (2, 1, 2) and put a diamond into it." in told
    assert told.endswith("Task: Get a diamond.\n")
    named = nest["/wim"].render("{{ branch | story(narrated=true) }}")
    assert "Wim walked to the garden." in named
    assert "You" not in named


def test_observations_tell_unknown_from_empty_and_hand_out_no_belief(nest):
    prompt = nest["/tom"].render(built_in_template("question"), question="Where?")
    assert "inside;-;chest:(6, 1, 2) & items:{}" in prompt
    assert "assumed;-;chest:(4, 1, 1) & items:{'cookie': 2}" in prompt
    assert "perceived_by" not in prompt
    assert "Chest:" not in prompt
    seen = nest["/wim"].render(built_in_template("question"), question="Where?")
    assert "inside" not in seen


@pytest.mark.parametrize(
    ("path", "question", "answer"),
    [
        ("/tom", "Where is the diamond?", "A"),
        ("/lia", "Where is the diamond?", "eastern chest"),
        ("/", "Where is the apple?", "A"),
        ("/lia", "Where is the apple?", "I do not know"),
        ("/wim", "What does the sign say?", "no toys"),
        ("/", "Where is Wim?", "garden"),
    ],
)
def test_the_offline_model_answers_from_observations(nest, path, question, answer):
    places = {"western chest": (2, 1, 2), "eastern chest": (6, 1, 2), "A": (4, 1, 1)}
    places["garden"] = (13, 1, 2)
    prompt = nest[path].render(built_in_template("question"), question=question, places=places)
    said = OfflineModel().answer((Message("user", prompt),), Sampling()).text
    assert said.startswith(f"Answer: {answer}\n")


@pytest.mark.parametrize("name", BUILT_IN_TEMPLATES)
def test_every_built_in_template_renders_for_a_question(nest, name):
    for path in ("/wim", "/lia/wim"):
        assert nest[path].render(
            built_in_template(name), question="?", task="?", options=(), reason=False, places={}
        )


def test_captions_are_the_sentences_of_the_story_with_their_ticks(nest: bn.Nest) -> None:
    for path in ("/", "/lia", "/wim"):
        told = captions(nest[path].view)
        text = nest[path].render("{{ branch | beginning }} {{ branch | story }}")
        assert " ".join(sentence for _, sentence in told) == text
        ticks = [tick for tick, _ in told]
        assert ticks == sorted(ticks)
        events = {event.tick for event in nest[path].state.events}
        assert {tick for tick, sentence in told if " put " in sentence} <= events


TURNS = """
name: turns
map:
  legend:
    "#": bricks
    r: {container: barrel, label: red box}
    b: {container: barrel, label: blue box}
    e: {agent: eva, facing: north, inventory: {diamond: 1}}
    l: {agent: lia, facing: east}
    w: {agent: wim, facing: north}
  floors: |
    #########
    #r.....b#
    #...e...#
    #l......#
    #...w...#
    #########
static_blocks: [stone, bricks]
perception: {field_of_view: 170}
script:
  - {agent: eva, program: "await depositItemIntoChest(bot, new Vec3(1, 1, 1), {diamond: 1});"}
"""
SOUTH, NORTH = (4, 2, 20), (1, 2, -20)
WIM_IS_AWAY = "Wim could no longer see Eva, Lia or any of the things there. "
WIM_IS_BACK = "Wim could now see Eva, Lia, the red box and the blue box. "
LIA_IS_AWAY = "Lia could no longer see Wim. "


@pytest.mark.parametrize(
    ("turns", "told"),
    [
        # Lia sees Wim turn away, and not that he turns back.
        (
            [("wim", SOUTH), ("lia", NORTH), ("wim", NORTH)],
            WIM_IS_AWAY + LIA_IS_AWAY + WIM_IS_BACK,
        ),
        # Lia sees neither; Wim has missed nothing.
        ([("lia", NORTH), ("wim", SOUTH), ("wim", NORTH)], LIA_IS_AWAY),
        # Lia sees both.
        ([("wim", SOUTH), ("wim", NORTH), ("lia", NORTH)], LIA_IS_AWAY),
        # The order shows what Lia saw.
        ([("wim", SOUTH), ("lia", NORTH)], WIM_IS_AWAY + LIA_IS_AWAY),
        ([("lia", NORTH), ("wim", SOUTH)], LIA_IS_AWAY + WIM_IS_AWAY),
    ],
)
def test_a_narrator_tells_turns_before_others_cease_to_see_them(tmp_path, turns, told):
    looks = [
        f"  - {{agent: {who}, program: 'await lookAt(bot, new Vec3{where});'}}\n"
        for who, where in turns
    ]
    take = "'await getItemFromChest(bot, new Vec3(1, 1, 1), {diamond: 1});'"
    file = tmp_path / "turns.yaml"
    file.write_text(TURNS + "".join(looks) + f"  - {{agent: eva, program: {take}}}\n")
    with bn.Nest.open(bn.Scenario.load(str(file)), "scripted") as nest:
        nest.play()
        course = nest["/"].render("{{ branch | story }}")
    first, last = "put a diamond into it. ", "Eva opened the red box and took"
    assert course.partition(first)[2].partition(last)[0] == told


def test_changes_of_sight_before_the_first_event_belong_to_the_course(tmp_path):
    turn = "  - {agent: wim, program: 'await lookAt(bot, new Vec3(4, 2, 20));'}\n"
    first, mark, script = TURNS.partition("script:\n")
    file = tmp_path / "turns.yaml"
    file.write_text(first + mark + turn + script)
    with bn.Nest.open(bn.Scenario.load(str(file)), "scripted") as nest:
        nest.play()
        beginning = nest["/"].render("{{ branch | beginning }}")
        course = nest["/"].render("{{ branch | story }}")
    assert "At first Wim could see Eva, Lia, the red box and the blue box." in beginning
    assert course.startswith(WIM_IS_AWAY + "Eva opened the red box")
