"""Intervals and paired differences, by hand and by another way."""

import itertools
import math

import pytest

from beliefnest.errors import InputError
from beliefnest.scenarios.scoring import wilson_interval
from beliefnest.studies.clusters import exchange_p
from beliefnest.studies.counting import count_rows, paired_rows
from beliefnest.studies.guessing import chance_of


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
    lost = {**row("a", 3, None, "error"), "tokens": None, "cost": None}
    rows = [row("a", 1, True), row("a", 2, False), lost]
    (found,) = count_rows(rows, ["model"])
    assert (found["rows"], found["judged"], found["right"], found["error"]) == (3, 2, 1, 1)
    assert found["accuracy"] == 0.5
    # Wilson, of one in two.
    assert (found["low"], found["high"]) == pytest.approx((0.0945, 0.9055), abs=1e-4)
    assert (found["tokens"], found["cost"]) == (4, 1.0)
    # A row without an answer is not right.
    rows.append(row("a", 4, False, "cut"))
    (found,) = count_rows(rows, ["model"])
    assert (found["judged"], found["right"], found["cut"]) == (3, 1, 1)


def test_pairs_are_rows_that_differ_in_one_column():
    rows = [row(model, spot, (model == "a") or spot > 2) for model in "ab" for spot in range(5)]
    (pairs,) = paired_rows(rows, "model", ["model", "spot"])
    assert (pairs.one, pairs.other, pairs.pairs, pairs.variations) == ("a", "b", 5, 5)
    assert (pairs.both, pairs.only_one, pairs.only_other) == (2, 3, 0)
    assert pairs.difference == pytest.approx(0.6)
    # Bonett and Price: 4/7 and 1/7 in place of 3/5 and 0.
    half = 1.959964 * math.sqrt((4 / 7 + 1 / 7 - (3 / 7) ** 2) / 7)
    assert pairs.interval == pytest.approx((3 / 7 - half, min(1, 3 / 7 + half)))
    # Three heads in three throws, either side.
    assert pairs.p == pytest.approx(0.25)


def test_nothing_is_compared_by_what_came_of_it():
    with pytest.raises(InputError, match="by 'outcome'; columns are model, spot"):
        paired_rows([row("a", 1, True)], "outcome", ["model", "spot"])


def clustered(variation, model, oks):
    """Rows of one variation, one for each repeat."""
    return [
        {**row(model, variation, ok), "variation": variation, "repeat": n}
        for n, ok in enumerate(oks)
    ]


def test_rows_of_one_variation_are_no_independent_evidence():
    rows = [each for n in range(60) for each in clustered(f"v{n}", "a", [n % 6 > 0] * 3)]
    (found,) = count_rows(rows, ["model"])
    assert (found["judged"], found["right"], found["variations"]) == (180, 150, 60)
    assert found["interval"] == "bootstrap"
    # As of 50 of 60, not as of 150 of 180.
    half = 1.96 * math.sqrt(5 / 6 / 6 / 60)
    assert (found["low"], found["high"]) == pytest.approx((5 / 6 - half, 5 / 6 + half), abs=0.02)
    assert count_rows(rows, ["model"]) == [found]
    (one,) = count_rows(rows[:180:3], ["model"])
    assert (one["interval"], one["variations"]) == ("wilson", 60)
    assert (one["low"], one["high"]) == pytest.approx((0.7196, 0.9069), abs=1e-4)


def test_where_all_variations_agree_their_number_makes_the_interval():
    rows = [each for n in range(10) for each in clustered(f"v{n}", "a", [True] * 6)]
    (found,) = count_rows(rows, ["model"])
    assert (found["right"], found["variations"]) == (60, 10)
    # Wilson, of 10 in 10.
    assert (found["low"], found["high"]) == pytest.approx((0.7225, 1.0), abs=1e-4)


def test_means_are_clustered_too():
    rows = [each for n in range(4) for each in clustered(f"v{n}", "a", [True] * 3)]
    for each in rows:
        each["ticks"] = 10 * int(each["variation"][1:])
    (found,) = count_rows(rows, ["model"], {"ticks": True})
    assert (found["ticks"], found["ticks_low"], found["ticks_high"]) == pytest.approx(
        (15, 5, 25), 1
    )
    (one,) = count_rows(rows[:3], ["model"], {"ticks": True})
    assert (one["ticks"], one["ticks_low"]) == (0, None)


def test_pairs_of_one_variation_are_exchanged_together():
    rows = [
        each
        for model in "ab"
        for n in range(4)
        for each in clustered(f"v{n}", model, [model == "a"] * 5)
    ]
    (pairs,) = paired_rows(rows, "model", ["model", "spot", "repeat"])
    assert (pairs.pairs, pairs.variations, pairs.only_one) == (20, 4, 20)
    # Four heads in four throws, either side, and not twenty.
    assert pairs.p == pytest.approx(2 / 2**4)
    # Bonett and Price of four pairs: 5/6 and 1/6.
    assert pairs.interval == pytest.approx(
        (4 / 6 - 1.959964 * math.sqrt((1 - (4 / 6) ** 2) / 6), 1.0)
    )


def every_exchange(differences):
    totals = [
        sum(sign * each for sign, each in zip(signs, differences, strict=True))
        for signs in itertools.product((1, -1), repeat=len(differences))
    ]
    return sum(abs(total) >= abs(sum(differences)) for total in totals) / len(totals)


@pytest.mark.parametrize(
    "differences", [[3, -1, 2, 0, 2], [1, 1, 1, -1], [0, 0], [], [5, -5], [2, 2, -1, -1, 3, 1]]
)
def test_p_is_the_share_of_all_exchanges(differences):
    assert exchange_p(differences) == pytest.approx(every_exchange(differences))


def answered(people, variations, right):
    """Rows of people who all answered all variations."""
    return [
        {**row("people", v, right(p, v)), "variation": f"v{v}", "participant": f"p{p}"}
        for p in range(people)
        for v in range(variations)
    ]


def test_people_are_a_second_cluster_of_intervals():
    by_person = answered(10, 40, lambda p, v: p < 5)
    (found,) = count_rows(by_person, ["model"])
    # All variations have the same share; five of ten people are always right.
    assert found["interval"] == "two-way bootstrap"
    assert (found["low"], found["high"]) == pytest.approx((0.2, 0.8), abs=0.01)
    by_scene = answered(40, 10, lambda p, v: v < 5)
    (turned,) = count_rows(by_scene, ["model"])
    assert (turned["low"], turned["high"]) == pytest.approx((0.2, 0.8), abs=0.01)
    models = [{**each, "participant": None} for each in by_person]
    (alone,) = count_rows(models, ["model"])
    assert alone["interval"] == "wilson"


def test_intervals_of_few_or_unanimous_people_are_those_of_wilson():
    # One row of each person in each variation: all rows are independent.
    apart = [each for each in answered(8, 8, lambda p, v: v < 6) if each["spot"] == _number(each)]
    (found,) = count_rows(apart, ["model"])
    (same,) = count_rows([row("a", n, n < 6) for n in range(8)], ["model"])
    assert (found["low"], found["high"], found["interval"]) == (same["low"], same["high"], "wilson")
    (unanimous,) = count_rows(answered(4, 9, lambda p, v: True), ["model"])
    (four,) = count_rows([row("a", n, True) for n in range(4)], ["model"])
    assert (unanimous["low"], unanimous["interval"]) == (four["low"], "wilson")


def _number(each):
    return int(each["participant"].removeprefix("p"))


def test_each_person_is_paired_with_the_model_and_with_other_people():
    people = answered(3, 2, lambda p, v: p > 0)
    models = [{**row("a", v, True), "variation": f"v{v}", "participant": None} for v in range(2)]
    identity = ["model", "spot", "participant"]
    (pairs,) = paired_rows([*models, *people], "model", identity)
    assert (pairs.one, pairs.other, pairs.pairs, pairs.variations) == ("a", "people", 6, 2)
    assert (pairs.both, pairs.only_one, pairs.difference) == (4, 2, pytest.approx(1 / 3))
    (spots,) = paired_rows(people, "spot", identity)
    assert (spots.pairs, spots.both, spots.only_one, spots.only_other) == (9, 4, 2, 2)


def test_people_are_a_second_cluster_of_differences():
    people = answered(10, 40, lambda p, v: p < 5)
    models = [{**row("a", v, True), "variation": f"v{v}", "participant": None} for v in range(40)]
    (pairs,) = paired_rows([*models, *people], "model", ["model", "spot", "participant"])
    assert pairs.difference == 0.5
    # All variations have the same difference; five of ten people are as right as the model.
    assert pairs.interval == pytest.approx((0.2, 0.8), abs=0.01)
    unanimous = answered(4, 9, lambda p, v: False)
    models = [{**row("a", v, True), "variation": f"v{v}", "participant": None} for v in range(9)]
    (pairs,) = paired_rows([*models, *unanimous], "model", ["model", "spot", "participant"])
    (four,) = paired_rows(
        [row(model, v, model == "a") for model in "ab" for v in range(4)],
        "model",
        ["model", "spot"],
    )
    assert pairs.interval == four.interval


def test_the_chance_level_is_that_of_options():
    asked = {"question": "q", "right": ["a"], "options": ["a", "b"]}
    assert chance_of({"answers": [asked]}) == 0.5
    assert chance_of({"answers": [asked, {**asked, "options": ["a", "b", "c", "d"]}]}) == 0.125
    assert chance_of({"answers": [{**asked, "options": ["a", "b", "c"], "right": ["a", "b"]}]}) == (
        pytest.approx(2 / 3)
    )
    # In words; together with a deed; not computed yet; nothing expected.
    assert chance_of({"answers": [{**asked, "options": []}]}) is None
    assert chance_of({"answers": [asked], "opens": [1, 2, 3]}) is None
    assert chance_of({"answers": [{**asked, "right": {"path": "/a"}}]}) is None
    assert chance_of(None) is None
    rows = [{**row("a", n, True), "chance": level} for n, level in enumerate((0.5, 0.25))]
    (found,) = count_rows(rows, ["model"])
    assert found["chance"] == 0.375
    (found,) = count_rows([*rows, row("a", 3, True)], ["model"])
    assert found["chance"] is None


def test_intervals_of_few_variations_are_never_those_of_a_bootstrap():
    rows = [each for n in range(4) for each in clustered(f"v{n}", "a", [n % 2 == 0, True, True])]
    (found,) = count_rows(rows, ["model"])
    assert found["interval"] == "wilson"
    assert (found["low"], found["high"]) == pytest.approx(wilson_interval(4 * 10 / 12, 4))
    both = [*rows, *[{**each, "model": "b", "ok": True} for each in rows]]
    (pairs,) = paired_rows(both, "model", ["model", "spot", "repeat"])
    low, high = pairs.interval
    assert low < -0.4 and high > 0.1


def test_a_mean_that_does_not_vary_has_no_interval():
    rows = [{**each, "ticks": 7} for n in range(9) for each in clustered(f"v{n}", "a", [True])]
    (found,) = count_rows(rows, ["model"], {"ticks": True})
    assert (found["ticks"], found["ticks_low"], found["ticks_high"]) == (7, None, None)
