"""Allocation of conditions, regressions, positions of options, and power by simulation."""

from collections import Counter
from math import exp

import numpy as np
import pytest
from tests.studies.small import small_in, study_in

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.studies.allocation import balanced, latin_lists
from beliefnest.studies.positions import choices_of, count_positions
from beliefnest.studies.power import AssumedRates, Resampled, power_rows
from beliefnest.studies.regression import fit_rows

SQUARE = [{"a": str(one), "b": str(other)} for one in range(3) for other in range(3)]


def test_a_balanced_design_gives_each_value_each_condition_equally_often():
    chosen = balanced(SQUARE, [range(3)] * 9, 3, "seed")
    for name in ("a", "b"):
        had = Counter(
            (values[name], condition) for values, condition in zip(SQUARE, chosen, strict=True)
        )
        assert set(had.values()) == {1}
        assert len(had) == 9


def test_an_enlarged_balanced_design_keeps_its_conditions_and_invalid_ones_are_avoided():
    less = balanced(SQUARE[:6], [range(3)] * 6, 3, "seed")
    assert balanced(SQUARE, [range(3)] * 9, 3, "seed")[:6] == less
    allowed = [{0}, {0}, {0, 1}, set(), {2}]
    chosen = balanced(SQUARE[:5], allowed, 3, "seed")
    assert chosen[3] is None
    assert all(chosen[number] in allowed[number] for number in (0, 1, 2, 4))


def test_lists_of_a_latin_square_have_each_variation_once_and_each_pair_once_in_all():
    lists = {
        (one, other, condition): number
        for one in range(3)
        for other in range(3)
        for condition, number in enumerate(latin_lists(one + other, 3))
    }
    first = [cell for cell, number in lists.items() if number == 1]
    for parts in ((0, 1), (0, 2), (1, 2)):
        assert len({tuple(cell[part] for part in parts) for cell in first}) == len(first) == 9


def test_designs_change_which_cells_are_played_and_no_result():
    crossed = {cell.key.name for cell in bn.Study("sally-anne", variations=6).plan().cells}
    study = bn.Study("sally-anne", variations=6, design="balanced")
    names = {cell.key.name for cell in study.plan().cells}
    assert names < crossed
    assert len(names) == 6
    assert Counter(cell.key.condition for cell in study.plan().cells) == {1: 2, 2: 2, 3: 2}
    square = bn.Study("sally-anne", variations=6, design="latin-square")
    assert {cell.key.name for cell in square.plan().cells} == crossed
    assert "list" in square.columns
    assert "list" not in study.columns
    assert [cell.list_number for cell in square.plan().cells] == [1] * 6 + [2] * 6 + [3] * 6


def test_wrong_designs_are_refused(tmp_path):
    with pytest.raises(bn.InputError, match="give one of crossed, balanced, latin-square"):
        bn.Study("sally-anne", design="random")
    with pytest.raises(bn.InputError, match="has one condition"):
        bn.Study(small_in(tmp_path), design="balanced").plan()
    file = study_in(tmp_path, "scenarios: [small.yaml]\ndesign: latin\n")
    with pytest.raises(bn.ScenarioError, match=r"study\.yaml:2: .*latin-square"):
        bn.Study.load(file)


def simulated(seed, groups=80, size=6, effect=0.8):
    """Rows of a logistic model with a random intercept of standard deviation 1."""
    chance = np.random.default_rng(seed)
    for group in range(groups):
        own = chance.normal()
        for number in range(size):
            level = number % 2
            p = 1 / (1 + exp(-(0.5 + effect * level + own)))
            row = {"level": "b" if level else "a", "variation": f"v{group}"}
            yield {**row, "ok": bool(chance.random() < p), "cell": f"{group}-{number}"}


@pytest.mark.extra("statsmodels")
def test_a_mixed_model_finds_the_parameters_of_simulated_rows():
    fits = [fit_rows(list(simulated(seed)), ["level"], "mixed", "binomial") for seed in range(8)]
    estimates = [fit.terms[1].estimate for fit in fits]
    assert [fits[0].terms[1].name, fits[0].references] == ["level[b]", {"level": "a"}]
    assert abs(np.mean(estimates) - 0.8) < 0.25
    assert abs(np.mean([fit.correlation for fit in fits]) - 1) < 0.25
    assert all(0.15 < fit.terms[1].se < 0.35 for fit in fits)


@pytest.mark.extra("statsmodels")
def test_gee_of_a_linear_model_agrees_with_the_difference_of_accuracies():
    rows = list(simulated(1))
    copies = [{**row, "cell": f"again {row['cell']}", "copy_of": row["cell"]} for row in rows[:50]]
    fit = fit_rows([*rows, *copies], ["level"], "gee", "gaussian")
    share = [np.mean([row["ok"] for row in rows if row["level"] == each]) for each in "ab"]
    assert fit.terms[1].estimate == pytest.approx(share[1] - share[0])
    assert (fit.rows, fit.groups) == (480, 80)
    # Rows of a variation are correlated, so that its mean is less certain than 480 rows say.
    assert fit.terms[0].se > np.sqrt(share[0] * (1 - share[0]) / 240)
    odds = fit_rows(rows, ["level"], "gee", "binomial").table()
    assert list(odds["odds_ratio"]) == pytest.approx(list(np.exp(odds["estimate"])))


def test_positions_show_a_model_that_prefers_the_first_option():
    orders = [["x", "y"], ["y", "x"], ["x", "y"], ["y", "x"]]
    check = {"expected": {"answers": [{"question": "q", "right": ["x"]}]}}
    choices = [
        choice
        for number, options in enumerate(orders)
        for choice in choices_of(
            [{"variation": f"v{number}", "model": "m"}],
            {
                "probes": [
                    {
                        "checks": [check],
                        "replies": [
                            {"question": "q", "options": options, "answer": options[0]},
                            {"question": "in words", "options": [], "answer": "x"},
                        ],
                    }
                ]
            },
        )
    ]
    counted = count_positions(choices, ["model"])
    assert [(row["right_at"], row["accuracy"]) for row in counted] == [(1, 1.0), (2, 0.0)]
    assert [(row["chosen_1"], row["chosen_2"], row["none"]) for row in counted] == [(2, 0, 0)] * 2


def test_power_grows_with_variations_and_intervals_cover_the_assumed_accuracy():
    source = AssumedRates(accuracy=0.7, difference=0.2, correlation=0.3, rows=3, pairs=3)
    rows = power_rows([("x", source)], [20, 80], 60, 1)
    assert rows == power_rows([("x", source)], [20, 80], 60, 1)
    assert rows[0]["width"] > 1.6 * rows[1]["width"]
    assert rows[1]["power"] > rows[0]["power"]
    assert all(row["coverage"] > 0.85 for row in rows)
    nothing = AssumedRates(accuracy=0.7, difference=0.0, correlation=0.3, rows=1, pairs=3)
    assert power_rows([("x", nothing)], [40], 100, 1)[0]["power"] < 0.12


def test_power_of_a_planned_study_is_printed_and_wrong_numbers_are_refused(tmp_path, capsys):
    study = "scenarios: [small.yaml]\nmodels: [offline, 'replay:x']\nvariations: {count: [1, 2]}\n"
    file = str(study_in(tmp_path, study))
    assert run_command_line(["power", file, "--size", "10", "--simulations", "20"]) == 0
    told = capsys.readouterr().out
    assert "difference width" in told
    assert "1 row in each variation" in told
    assert run_command_line(["power", file, "--difference", "0.9"]) == 2
    assert "between 0 and 1" in capsys.readouterr().err


def test_power_says_if_there_is_too_little_to_draw_from():
    few = Resampled((((True, False), ()),) * 3)
    same = Resampled((((True, True), ((True, True),)),) * 9)
    fine = Resampled(tuple(((n % 3 > 0, True), ()) for n in range(9)))
    rows = power_rows([("few", few), ("same", same), ("fine", fine)], [10], 5, 1)
    notes = [row["note"] for row in rows]
    assert "3 variations recorded" in notes[0]
    assert "the same result" in notes[1]
    assert notes[2] == ""
