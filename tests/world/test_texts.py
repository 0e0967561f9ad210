"""Texts of others: hidden characters show, and spreadsheets compute nothing."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beliefnest.world.texts import escaped, formula_free, on_one_line, visible, visible_json
from beliefnest.world.words import counted

HIDDEN = (
    "\u061c\u200b\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2060\u2066\u2067\u2068\u2069\ufeff"
)
HIDDEN += "\U000e0041\x1b\x07\x9b\u2028\u2029\xad"


@pytest.mark.parametrize("character", HIDDEN)
def test_hidden_characters_are_written_out(character: str) -> None:
    for shown in (visible, escaped, on_one_line):
        if character.isspace() and shown is on_one_line:
            continue
        told = shown(f"a{character}b")
        assert character not in told
        assert f"{ord(character):x}" in told
    assert json.loads(visible_json(json.dumps([f"a{character}b"], ensure_ascii=False))) in (
        [visible(f"a{character}b")],
        [f"a{character}b"] if ord(character) < 32 else None,
    )


@pytest.mark.parametrize(
    "text",
    ["", "a b", "one\ntwo\tthree", "Grüße, 你好, שלום", "👩\u200d🚀", "\u0645\u06cc\u200c\u062e"],
)
def test_other_texts_stay(text: str) -> None:
    assert visible(text) == text
    assert json.loads(visible_json(json.dumps(text, ensure_ascii=False))) == text


@given(st.text())
def test_what_is_visible_stays_as_it_is(text: str) -> None:
    assert visible(visible(text)) == visible(text)
    assert json.loads(visible_json(json.dumps(text, ensure_ascii=False))) is not None


@pytest.mark.parametrize(
    "text",
    [
        '=HYPERLINK("http://x")',
        "+1+cmd|' /C calc'!A0",
        "-2+cmd|x",
        "@SUM(A1)",
        "\t=1",
        "\r=1",
        "\uff1d1+1",
        "-A1",
    ],
)
def test_formulas_are_texts(text: str) -> None:
    assert formula_free(text) == f"'{text}"


@pytest.mark.parametrize(
    "text", ["", "-2,-51,-4", "-1.5", "+3", "a=b", "await x()", "-2,-51,-4 1,2,3"]
)
def test_numbers_and_words_stay(text: str) -> None:
    assert formula_free(text) == text


def test_numbers_stand_with_their_nouns() -> None:
    assert [counted(n, noun) for noun in ("cell", "history") for n in (1, 2)] == [
        "1 cell",
        "2 cells",
        "1 history",
        "2 histories",
    ]
