"""Every kind of line is understood; what is not is reported with its number."""

import pytest
from tests.suites.stories.texts import COMING_BACK, SHARED_SECRET

import beliefnest as bn
from beliefnest.suites.stories import parse_question, read_story
from beliefnest.suites.stories.grammar import (
    Entered,
    Exited,
    Located,
    Moved,
    Placed,
    Present,
    Returned,
    Stayed,
    Taken,
    Told,
    Wait,
    parse_lines,
)
from beliefnest.suites.stories.story import Come, Go, HandOver, Move, Place, Put, Take


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("1 Ann entered the den.", Entered(("Ann",), "den")),
        ("12 Ann and Bob entered the den.", Entered(("Ann", "Bob"), "den")),
        ("Ann, Bob and Cid entered the front_yard.", Entered(("Ann", "Bob", "Cid"), "front_yard")),
        ("Ann, Bob, and Cid entered the den.", Entered(("Ann", "Bob", "Cid"), "den")),
        ("Ann exited the den.", Exited(("Ann",), "den")),
        ("3 Ann and Bob left the den", Exited(("Ann", "Bob"), "den")),
        ("Ann moved the pear to the red_box.", Moved("Ann", "pear", "red_box")),
        ("Ann moved the pear to the oak chest.", Moved("Ann", "pear", "oak chest")),
        ("The pear is in the box.", Located("pear", "box")),
        ("7 The pear2 is in the box1.", Located("pear2", "box1")),
        ("9 Ann made no movements and stayed in the den for 1 minute.", Stayed(("Ann",), "den")),
        ("Ann went back into the den.", Entered(("Ann",), "den")),
        ("Ann returned to the den.", Entered(("Ann",), "den")),
        ("Ann returned.", Returned(("Ann",))),
        ("Ann and Bob came back.", Returned(("Ann", "Bob"))),
        ("Ann left.", Exited(("Ann",))),
        ("Ann went out of the den.", Exited(("Ann",), "den")),
        ("Ann left the room.", Exited(("Ann",))),
        ("Ann carried the pear from the box to the jar.", Moved("Ann", "pear", "jar", "box")),
        ("Ann took the pear to the jar.", Moved("Ann", "pear", "jar")),
        ("Ann took it from the box and put it in the jar.", Moved("Ann", "it", "jar", "box")),
        ("Ann put her pear back into the jar.", Placed("Ann", "pear", "jar")),
        ("Ann dropped the pear in the jar.", Placed("Ann", "pear", "jar")),
        ("Ann left the pear in the jar.", Placed("Ann", "pear", "jar")),
        ("Ann took the pear out of the box.", Taken("Ann", "pear", "box")),
        ("Ann picked up the pear.", Taken("Ann", "pear")),
        ("Ann picked it up.", Taken("Ann", "it")),
        ("There is a pear in the box.", Located("pear", "box")),
        ("Ann and Bob are in the den.", Present(("Ann", "Bob"), "den")),
        ("Ann told Bob that the pear is in the jar.", Told("Ann", "pear", "jar", True, "Bob")),
        ("Ann likes the blue_jar.", Wait("blue_jar")),
        ("Ann dislikes the pear.", Wait("pear")),
        ("Ann hates the pear.", Wait("pear")),
        ("Ann saw a cat.", Wait("cat")),
        ("Ann lost his watch.", Wait("watch")),
        ("Phone rang.", Wait()),
    ],
)
def test_a_line_is_understood(line, sentence):
    (found,) = parse_lines(line)
    assert found.sentence == sentence
    assert found.number == 1


@pytest.mark.parametrize(
    "line",
    [
        "5 Ann juggled the pear.",
        "5 The pear is under the box.",
        "5 A_name_that_is_too_long entered the den.",
        "5",
        "5 Ann entered.",
        "5 She entered the den.",
        "5 Ann moved them to the box.",
        "5 Ann moved the pear to it.",
        "5 Ann quietly moved the pear to the box.",
        "5 Ann moved the pear from the box.",
        "5 Ann dropped the pear.",
        "5 Ann gave the pear to Bob.",
        "5 Ann left the den and the hall.",
    ],
)
def test_a_line_that_is_not_understood_is_reported_with_its_number(line):
    with pytest.raises(bn.InputError, match=r"^line 3: "):
        parse_lines(f"1 Ann entered the den.\n\n{line}\n")


def test_blank_lines_count_and_are_left_out():
    lines = parse_lines("\n1 Ann entered the den.\n\n2 Ann exited the den.\n\n")
    assert [line.number for line in lines] == [2, 4]


@pytest.mark.parametrize(
    ("text", "believers", "thing", "at_beginning"),
    [
        ("Where is the pear really?", (), "pear", False),
        ("Where was the pear at the beginning?", (), "pear", True),
        ("Where will Ann look for the pear?", ("Ann",), "pear", False),
        ("Where would Ann search for the pear?", ("Ann",), "pear", False),
        ("Where does Ann expect to find the pear?", ("Ann",), "pear", False),
        ("Where does Ann really think the pear is?", ("Ann",), "pear", False),
        ("Where does Ann think that Bob searches for the pear?", ("Ann", "Bob"), "pear", False),
        ("Where does Ann think Bob thinks the red pear is?", ("Ann", "Bob"), "red pear", False),
        (
            "Where does A think B thinks C thinks D thinks the pear is?",
            ("A", "B", "C", "D"),
            "pear",
            False,
        ),
    ],
)
def test_a_question_is_understood(text, believers, thing, at_beginning):
    question = parse_question(text)
    assert (question.believers, question.thing) == (believers, thing)
    assert question.at_beginning is at_beginning
    assert question.order == len(believers)


@pytest.mark.parametrize(
    "text", ["", "Where is Ann?x", "Who has the pear?", "Where does Ann think the pear"]
)
def test_another_question_is_refused(text):
    with pytest.raises(bn.InputError, match="no question about a story"):
        parse_question(text)


def test_containers_of_one_name_in_two_rooms_are_two():
    story = read_story(SHARED_SECRET)
    assert story.rooms == ("attic", "cellar")
    assert {Place("attic", "tin_box"), Place("cellar", "tin_box")} <= set(story.places)
    assert story.agents == ("Nora", "Tom", "Ida")
    assert story.things == {
        "lantern": Place("attic", "grey_trunk"),
        "compass": Place("cellar", "tin_box"),
    }


def test_acts_follow_the_lines():
    story = read_story(COMING_BACK)
    basket, drawer = Place("study", "basket"), Place("study", "drawer")
    assert story.acts == (
        Come(("Bo",), "study"),
        Come(("Cy",), "study"),
        Wait(),
        Wait(),
        Go(("Cy",)),
        Move("Bo", "apple", basket, drawer),
        Wait(),
        Come(("Cy",), "study"),
        Go(("Bo",)),
        Move("Cy", "apple", drawer, basket),
        Wait(),
    )


@pytest.mark.parametrize(
    ("text", "number", "what"),
    [
        ("Ann entered the den.\nAnn exited the hall.", 2, "in the den"),
        ("Ann entered the den.\nAnn left.\nAnn stayed in the den.", 3, "no sentence"),
        ("Ann exited the den.\nAnn made no movements and stayed in the den.", 2, "in no room"),
        ("Ann entered the den.\nAnn moved the pear to the box.", 2, "nothing says where"),
        (
            "The pear is in the box.\nAnn entered the waiting_room.\nThe jar is in the den.\n"
            "The tin is in the hall.\nThe fig is in the jar.\nThe nut is in the tin.",
            1,
            "no room that is entered",
        ),
        (
            "Ann entered the den.\nThe pear is in the box.\nThe pear is in the jar.",
            3,
            "in the box of the den",
        ),
        (
            "Ann entered the den.\nThe pear is in the box.\nAnn exited the den.\n"
            "Ann moved the pear to the jar.",
            4,
            "in no room with containers",
        ),
        (
            "Ann entered the den.\nThe pear is in the box.\nAnn entered the hall.\n"
            "Ann moved the pear to the jar.",
            4,
            "the pear is in the den and Ann in the hall",
        ),
        (
            "Ann entered the den.\nThe pear is in the box.\nThe jar is in the hall.\n"
            "Bob entered the hall.\nAnn moved the pear to the jar.",
            5,
            "the jar is in the hall",
        ),
        ("It is in the box.", 1, "no earlier line"),
        (
            "Ann is in the den.\nThe fig is in the box.\nAnn likes the nut.\n"
            "Ann put it in the jar.",
            4,
            "'it' may be the fig or the nut",
        ),
        (
            "Ann is in the den.\nThe fig is in the box.\nAnn went to the box.\n"
            "Ann took the fig from the box.",
            3,
            "cannot be a room and a container",
        ),
        ("The box is in the den.\nAnn is in the hall.\nAnn entered the room.", 3, "the room"),
        ("Ann entered the den.\nAnn returned.", 2, "left no room"),
        (
            "The fig is in the box.\nAnn took the fig.\nBob moved the fig to the jar.",
            3,
            "Ann has the fig in the hands",
        ),
        (
            "The fig is in the box.\nAnn moved the fig from the tin to the jar.",
            2,
            "in the box, not in the tin",
        ),
        ("", None, "empty"),
    ],
)
def test_a_line_that_contradicts_is_reported_with_its_number(text, number, what):
    start = "" if number is None else f"^line {number}: "
    with pytest.raises(bn.InputError, match=f"{start}.*{what}"):
        read_story(text)


def test_a_mover_is_in_the_room_of_the_thing_from_the_beginning():
    story = read_story(
        "Bo entered the attic.\nThe fig is in the box.\nThe box is in the den.\n"
        "Ann moved the fig to the jar.\nCy exited the den.\nAnn left.\nAnn came back."
    )
    assert story.present == {"Ann": "den", "Cy": "den"}
    assert story.acts[3:] == (
        Move("Ann", "fig", Place("den", "box"), Place("den", "jar")),
        Go(("Cy",)),
        Go(("Ann",)),
        Come(("Ann",), "den"),
    )


def test_a_thing_may_pass_through_hands():
    story = read_story(
        "Ann and Bob are in the den.\nAnn put the fig into the box.\nBob took it from the box.\n"
        "Bob put it in the jar."
    )
    assert story.things == {"fig": HandOver("Ann")}
    assert story.acts == (
        Wait(),
        Put("Ann", "fig", Place("den", "box")),
        Take("Bob", "fig", Place("den", "box")),
        Put("Bob", "fig", Place("den", "jar")),
    )


def test_a_story_without_rooms_has_one():
    story = read_story("Sal put the ball in the basket.\nSal left.\nAnn moved it to the box.")
    assert story.rooms == ("room",)
    assert story.present == {"Sal": "room", "Ann": "room"}


def test_it_is_the_thing_that_was_named_last():
    start = "Ann is in the den.\nThe fig is in the box.\nThe nut is in the jar.\n"
    assert read_story(f"{start}Ann put it in the tin.").acts[-1].thing == "nut"
    remark = f"{start}Ann likes the fig.\nAnn likes the tin.\nThe tin is in the den.\n"
    assert read_story(f"{remark}Ann put it in the tin.").acts[-1].thing == "fig"
