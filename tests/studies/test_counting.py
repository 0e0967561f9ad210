"""Intervals and paired differences, by hand and by another way."""

import math

import pytest

from beliefnest.errors import InputError
from beliefnest.studies.counting import Pairs, count_rows, paired_rows


def row(model, spot, ok, outcome=None):
    return {
        "model": model,
        "spot": spot,
        "ok": ok,
        "outcome": outcome or ("ok" if ok else "wrong"),
        "tokens": 2,
        "cost": 0.5,
    }


def test_what_has_no_result_is_counted_and_not_judged():
    rows = [row("a", 1, True), row("a", 2, False), row("a", 3, None, "error")]
    (found,) = count_rows(rows, ["model"])
    assert (found["rows"], found["judged"], found["right"], found["error"]) == (3, 2, 1, 1)
    assert found["accuracy"] == 0.5
    # Wilson, of one in two.
    assert (found["low"], found["high"]) == pytest.approx((0.0945, 0.9055), abs=1e-4)
    assert (found["tokens"], found["cost"]) == (6, 1.0)


def test_pairs_are_rows_that_differ_in_one_column():
    rows = [row(model, spot, (model == "a") or spot > 2) for model in "ab" for spot in range(5)]
    (pairs,) = paired_rows(rows, "model", ["model", "spot"])
    assert pairs == Pairs("a", "b", 5, 2, 3, 0)
    assert pairs.difference == pytest.approx(0.6)
    # Bonett and Price: 4/7 and 1/7 in place of 3/5 and 0.
    half = 1.959964 * math.sqrt((4 / 7 + 1 / 7 - (3 / 7) ** 2) / 7)
    assert pairs.interval == pytest.approx((3 / 7 - half, min(1, 3 / 7 + half)))
    # Three heads in three throws, either side.
    assert pairs.p == pytest.approx(0.25)


def test_nothing_is_compared_by_what_came_of_it():
    with pytest.raises(InputError, match="by 'outcome'; columns are model, spot"):
        paired_rows([row("a", 1, True)], "outcome", ["model", "spot"])
