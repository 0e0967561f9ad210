"""Numbers that an answer gives to names."""

import pytest

from beliefnest.llm.reading_numbers import read_numbers

NAMES = ["desire red", "belief none"]
BOTH = {"desire red": 3, "belief none": 4}


@pytest.mark.parametrize(
    "text",
    [
        "desire red: 3\nbelief none: 4",
        "**Desire red**: 3/7\n- **belief none:** 4",
        "1. _desire red_ = 3 out of 7\n2. belief none \u2014 4 (rather likely)",
        "| desire red | 3 |\n|---|---|\n| belief none | 4 |",
        '```json\n{"desire red": 3, "belief none": 4}\n```',
        '{\n  "desire_red": "3",\n  "belief_none": 4\n}',
        "<think>desire red: 7\nbelief none: 7</think>desire red: 3\nbelief none: 4",
        "desire red: 6\nbelief none: 4\nOn reflection:\ndesire red: 3",
    ],
)
def test_each_name_has_the_number_of_its_last_line(text):
    reading = read_numbers(text, NAMES, 1, 7)
    assert (reading.numbers, reading.row_outcome, reading.missing) == (BOTH, "read", ())


@pytest.mark.parametrize(
    ("text", "finish", "outcome"),
    [
        ("desire red: 3 to 4\nbelief none: 4", "stop", "ambiguous"),
        ("desire red: 3 or 5\nbelief none: 4", "stop", "ambiguous"),
        ("desire red: 3", "stop", "unread"),
        ("desire red: 9\nbelief none: 4", "stop", "unread"),
        ("desire red: -3\nbelief none: 4", "stop", "unread"),
        ("", "stop", "unread"),
        ("<think>desire red: 3\nbelief none: 4", "stop", "unread"),
        ("I'm sorry, but I cannot help with that.", "stop", "refused"),
        ("desire red: 3\nbelief none: 4", "length", "cut"),
        ("", "content_filter", "refused"),
    ],
)
def test_what_is_missing_is_told_and_not_guessed(text, finish, outcome):
    reading = read_numbers(text, NAMES, 1, 7, finish)
    assert reading.row_outcome == outcome
    assert reading.missing
    assert reading.reason
