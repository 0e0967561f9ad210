"""Regressions that rows do not determine: each says so, and gives what the rows do say."""

import json
import math

import numpy as np
import pytest
from tests.studies.small import study_in

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.studies.regression import FAMILIES, KINDS, fit_rows

pytestmark = pytest.mark.extra("statsmodels")

EVERY = [(kind, family) for kind in KINDS for family in FAMILIES]


def table(chance_of, variations=24, repeats=4, spread=0.8, seed=0):
    """Rows with factors `a` (within variations), `b` and `c` (between them)."""
    chance = np.random.default_rng(seed)
    for number in range(variations):
        own = spread * chance.normal()
        for repeat in range(repeats):
            for a in "12":
                row = {"a": a, "b": "xyz"[number % 3], "c": "pq"[number % 2]}
                p = 1 / (1 + math.exp(-(chance_of(row) + own)))
                yield {
                    **row,
                    "ok": bool(chance.random() < p),
                    "variation": f"v{number}",
                    "cell": f"{number}-{repeat}-{a}",
                    "outcome": "",
                }


def even(row):
    return 0.3 if row["a"] == "1" else -0.2


PLAIN = list(table(even))


def cell_of(**levels):
    return lambda row: all(row[name] == level for name, level in levels.items())


def made(rows, chosen, ok):
    """Return rows of which the chosen ones have another verdict."""
    return [{**row, "ok": ok if chosen(row) else row["ok"]} for row in rows]


UNSOUND = {
    "all right": (made(PLAIN, lambda row: True, True), ["a"], EVERY, "all 192 judged rows are"),
    "all wrong": (made(PLAIN, lambda row: True, False), ["a"], EVERY, "rows are wrong"),
    "nothing judged": ([{**row, "ok": None} for row in PLAIN], ["a"], EVERY, "no row is judged"),
    "one level": ([r for r in PLAIN if r["a"] == "1"], ["a"], EVERY, "a is 1 in all judged rows"),
    "twins": ([{**r, "d": r["a"]} for r in PLAIN], ["a", "d"], EVERY, "cannot be told apart"),
    "a combination without rows": (
        [r for r in PLAIN if not cell_of(a="2", b="y")(r)],
        ["a", "b", ("a", "b")],
        EVERY,
        "cannot be told apart",
    ),
    "two variations": ([r for r in PLAIN if r["variation"] in ("v0", "v1")], ["a"], EVERY, "least"),
    "a level in one cell": (
        [r for r in PLAIN if r["b"] != "y" or r["cell"] == "1-0-1"],
        ["b"],
        EVERY,
        "b y has judged rows of 1 variation",
    ),
    "an interaction in one variation": (
        [r for r in PLAIN if not cell_of(a="2", b="y")(r) or r["variation"] == "v1"],
        ["a", "b", ("a", "b")],
        EVERY,
        "a 2 and b y has judged rows of 1 variation",
    ),
    "columns told apart by one variation": (
        [{**r, "d": r["c"] if r["variation"] != "v0" else "q"} for r in PLAIN],
        ["c", "d"],
        EVERY,
        "without the rows of a single variation",
    ),
    "separation": (made(PLAIN, cell_of(a="2"), True), ["a"], EVERY[::2], "a 2 are right"),
    "separation between": (made(PLAIN, cell_of(b="y"), False), ["a", "b"], EVERY[::2], "b y are"),
    "separation within an interaction": (
        made(PLAIN, cell_of(a="2", b="y"), True),
        ["a", "b", ("a", "b")],
        EVERY[::2],
        "a 2 and b y are right",
    ),
    "no errors": (made(PLAIN, cell_of(b="y"), True), ["a", "b"], EVERY[1:2], "b y are"),
    "no errors, one row each": (
        [r for n, r in enumerate(made(PLAIN, cell_of(b="y"), True)) if n % 8 == 0],
        ["b"],
        EVERY[1::2],
        "",
    ),
    "groups of one": (
        [r for n, r in enumerate(PLAIN) if n % 8 == n // 8 % 2],
        ["a"],
        EVERY[2:],
        "each variation has one judged row",
    ),
    "no variance between variations": (
        [{**r, "ok": n // 2 % 4 < 2} for n, r in enumerate(PLAIN)],
        ["b"],
        EVERY[2:],
        "estimated as 0",
    ),
    "whole variations are right": (
        [{**r, "ok": int(r["variation"][1:]) % 5 < 2} for r in PLAIN],
        ["b"],
        EVERY[2:],
        "",
    ),
    "an answer explained": (
        [{**r, "ok": r["a"] == "1"} for r in PLAIN],
        ["a"],
        EVERY,
        "",
    ),
}


def meaningful(low, estimate, high, family):
    """Return True if an interval is finite, has a width, and says something on its scale."""
    widest = 60 if family == "binomial" else 2
    return low < high and low - 1e-9 <= estimate <= high + 1e-9 and 1e-6 < high - low < widest


@pytest.mark.parametrize("name", UNSOUND)
def test_a_fit_that_rows_do_not_determine_says_so_and_gives_no_coefficient(name):
    rows, effects, forms, told = UNSOUND[name]
    for kind, family in forms:
        fit = fit_rows(rows, effects, kind, family)
        assert not fit.sound
        assert told in fit.note
        assert fit.terms == ()
        assert (fit.correlation, fit.raw) == (None, None)
        assert list(fit.table().columns)[:2] == ["term", "estimate"]
        assert sum(each["judged"] for each in fit.counts) == fit.rows
        assert all(each["low"] < each["high"] for each in fit.counts if each["judged"])
        for term in fit.substitute.terms if fit.substitute else ():
            assert meaningful(term.low, term.estimate, term.high, family), term
        # Advice never names what was just used.
        assert family not in fit.note
        assert json.loads(json.dumps(fit.plain(), allow_nan=False))["sound"] is False


def test_a_level_without_errors_has_no_linear_estimate_without_a_variance_of_all_rows():
    rows = made(PLAIN, cell_of(b="y"), True)
    assert fit_rows(rows, ["b"], "gee", "gaussian").substitute is None
    errors = [each.se for each in fit_rows(rows, ["b"], "mixed", "gaussian").terms]
    assert errors[1] == pytest.approx(errors[2], rel=1e-6)
    once = [row for number, row in enumerate(rows) if number % 8 == 0]
    assert fit_rows(once, ["b"], "mixed", "gaussian").substitute is None


@pytest.mark.parametrize(("kind", "family"), EVERY)
def test_a_fit_that_rows_determine_is_sound(kind, family):
    fit = fit_rows(PLAIN, ["a", "b", ("a", "b")], kind, family)
    assert (fit.sound, fit.note, fit.substitute, fit.counts) == (True, "", None, ())
    assert len(fit.terms) == 6
    assert all(meaningful(each.low, each.estimate, each.high, family) for each in fit.terms)


def test_a_regression_with_people_says_that_it_does_not_group_them():
    people = [{**row, "participant": f"p{n % 3}"} for n, row in enumerate(PLAIN)]
    assert "not of other people" in fit_rows(people, ["a"], "gee", "binomial").method
    assert "people" not in fit_rows(PLAIN, ["a"], "gee", "binomial").method


def test_quasi_separation_that_no_single_level_shows_is_found():
    # Of nine combinations of two columns, three have both verdicts: those of one diagonal.
    rows = [
        {
            "d": str(d),
            "e": str(e),
            "ok": d > e or (d == e and number % 2 == 0),
            "variation": f"v{number}",
            "cell": f"{d}-{e}-{number}",
            "outcome": "",
        }
        for d in range(3)
        for e in range(3)
        for number in range(6)
    ]
    fit = fit_rows(rows, ["d", "e"], "gee", "binomial")
    assert not fit.sound
    assert "quasi-separation" in fit.note
    assert "d[1], d[2], e[1], e[2]" in fit.note
    assert [each.name for each in fit.substitute.terms] == [
        "intercept", "d[1]", "d[2]", "e[1]", "e[2]",
    ]  # fmt: skip


def test_separated_repeats_of_a_variation_are_no_independent_evidence():
    rows = made(PLAIN, cell_of(a="2"), True)
    once = [row for row in rows if row["cell"].split("-")[1] == "0"]
    # Each row is repeated exactly: nothing is learnt from the copies.
    many = [{**row, "cell": f"{row['cell']}-{n}"} for row in once for n in range(10)]
    few, more = (
        fit_rows(each, ["a"], "gee", "binomial").substitute.terms[1] for each in (once, many)
    )
    assert more.high - more.low > 0.7 * (few.high - few.low)


STUDY = """\
scenarios: [small.yaml]
models: [chance]
world: scripted
repeats: 4
seed: 4
variations: {count: [1, 2, 3, 4]}
"""


def test_hundreds_of_levels_are_refused_and_many_have_no_estimates_in_place():
    rows = [{**row, "d": number, "e": number % 96} for number, row in enumerate(table(even, 60))]
    for kind, family in EVERY:
        fit = fit_rows(rows, ["d"], kind, family)
        assert (fit.sound, fit.substitute, len(fit.counts)) == (False, None, len(rows))
        assert "480 coefficients, more than 200" in fit.note
    assert fit_rows(rows, ["e"], "mixed", "binomial").substitute is None


def test_a_column_that_interacts_with_itself_counts_once():
    assert fit_rows(PLAIN, [("a", "a")], "gee", "binomial").terms == (
        fit_rows(PLAIN, ["a"], "gee", "binomial").terms
    )


@pytest.mark.usefixtures("kept_worlds")
def test_stats_tell_of_each_fit_if_it_is_sound(tmp_path, capsys):
    file = study_in(tmp_path, STUDY)
    bn.Study.load(file).run(tmp_path / "out", jobs=1)
    folder = str(tmp_path / "out")
    capsys.readouterr()
    for kind, family in EVERY:
        status = run_command_line(
            ["stats", folder, "--effect", "count", "--kind", kind, "--family", family, "--json"]
        )
        assert status == 0
        fit = json.loads(capsys.readouterr().out)["regression"]
        assert fit["sound"] is False
        assert fit["note"]
        assert fit["terms"] == []
    grouped = ["stats", folder, "--effect", "count", "--by", "repeat", "--json"]
    assert run_command_line(grouped) == 0
    fits = json.loads(capsys.readouterr().out)["regressions"]
    assert [fit["repeat"] for fit in fits] == [1, 2, 3, 4]
    kept = [
        "stats",
        folder,
        "--where",
        "repeat < 3 and count != '4'",
        "--effect",
        "count",
        "--json",
    ]
    assert run_command_line(kept) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["regression"]["rows"], found["summary"][0]["judged"]) == (3, 3)
    assert run_command_line(["stats", folder, "--effect", "count"]) == 0
    assert "not sound" in capsys.readouterr().out
    assert run_command_line(["stats", folder, "--by", "count", "--effect", "count"]) == 2
    assert "count cannot be compared, or be an effect, within groups" in capsys.readouterr().err
    assert run_command_line(["stats", folder, "--by", "count", "--between", "count"]) == 2
    assert "count cannot be compared, or be an effect, within groups" in capsys.readouterr().err
