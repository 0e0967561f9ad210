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
    Stayed,
    Wait,
    parse_lines,
)
from beliefnest.suites.stories.story import Come, Go, Move, Place


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
        ("Ann likes the blue_jar.", Wait()),
        ("Ann dislikes the pear.", Wait()),
        ("Ann hates the pear.", Wait()),
        ("Ann saw a cat.", Wait()),
        ("Ann lost his watch.", Wait()),
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
        ("Ann exited the den.", 1, "in no room"),
        ("Ann entered the den.\nAnn exited the hall.", 2, "in the den"),
        ("Ann entered the den.\nBob made no movements and stayed in the den.", 2, "in no room"),
        ("Ann entered the den.\nAnn moved the pear to the box.", 2, "nothing says where"),
        ("The pear is in the box.", 1, "no room that is entered"),
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
        ("", None, "empty"),
    ],
)
def test_a_line_that_contradicts_is_reported_with_its_number(text, number, what):
    start = "" if number is None else f"^line {number}: "
    with pytest.raises(bn.InputError, match=f"{start}.*{what}"):
        read_story(text)
