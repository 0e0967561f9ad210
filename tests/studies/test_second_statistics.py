"""Every figure of a report, held against a second implementation on generated tables.

Tolerances: exact methods agree to rounding; fits to 1e-4 of a standard error or better; bootstraps,
whose draws differ, to a share of the interval's width.
"""

import math
import warnings

import numpy as np
import pytest
from tests.profiles import at_night, few_by_day
from tests.studies import second_statistics as second

from beliefnest.studies.counting import count_rows, paired_rows
from beliefnest.studies.positions import count_positions
from beliefnest.studies.power import AssumedRates, power_rows
from beliefnest.studies.regression import fit_rows

pytestmark = pytest.mark.extra("statsmodels")

KINDS = {
    # Variations, repeats, spread of the variations' log odds, intercept, share of kept rows.
    "balanced": (18, 3, 0.6, 0.2, 1.0),
    "skewed": (24, 3, 0.5, 2.6, 1.0),
    "sparse": (15, 2, 0.7, 0.0, 0.55),
    "separated": (15, 2, 0.3, 0.3, 1.0),
    "clustered": (16, 5, 2.2, 0.0, 1.0),
}
EACH = [(kind, number) for number in range(at_night(40, 2)) for kind in KINDS]
TABLES = pytest.mark.parametrize(("kind", "number"), few_by_day(EACH, len(KINDS)))


def table(kind, number):
    """Return the rows of a table: `a` varies within variations, `b` between them."""
    variations, repeats, spread, intercept, kept = KINDS[kind]
    chance = np.random.default_rng([list(KINDS).index(kind), number])
    rows = []
    for variation in range(variations):
        own = spread * chance.normal()
        b = "xyz"[variation % 3]
        for repeat in range(repeats):
            for a in "12":
                odds = intercept + own + 0.7 * (a == "2") - 0.4 * (b == "y")
                row = {"a": a, "b": b, "ok": bool(chance.random() < 1 / (1 + math.exp(-odds)))}
                if kind == "separated" and a == "2" and b == "y":
                    row["ok"] = True
                if chance.random() < kept:
                    rows.append(
                        {
                            **row,
                            "variation": f"v{variation}",
                            "repeat": repeat,
                            "cell": f"{variation}-{repeat}-{a}",
                            "outcome": "ok" if row["ok"] else "wrong",
                            "ticks": float(chance.integers(5, 60)),
                        }
                    )
    return rows


def clusters_of(rows, value):
    found = {}
    for row in rows:
        found.setdefault(row["variation"], []).append(value(row))
    return list(found.values())


def close(found, expected, width):
    """Return True if two bootstrap intervals agree, as a share of their width."""
    return np.allclose(found, expected, atol=width * (expected[1] - expected[0]))


@TABLES
def test_accuracies_and_means(kind, number):
    from statsmodels.stats.proportion import proportion_confint

    rows = table(kind, number)
    first = [next(r for r in rows if r["variation"] == v) for v in {r["variation"] for r in rows}]
    (single,) = count_rows(first, [])
    right = sum(row["ok"] for row in first)
    assert single["interval"] == "wilson"
    assert (single["low"], single["high"]) == pytest.approx(
        proportion_confint(right, len(first), method="wilson"), abs=1e-12
    )
    for group in count_rows(rows, ["a"], {"ticks": False}):
        own = [row for row in rows if row["a"] == group["a"]]
        clusters = clusters_of(own, lambda row: row["ok"])
        assert group["accuracy"] == pytest.approx(np.mean([row["ok"] for row in own]))
        if group["interval"] == "bootstrap":
            expected = second.bootstrap_interval(clusters, number, 6_000)
            # Where nearly all is right, a limit is one of few values.
            assert close((group["low"], group["high"]), expected, 0.2)
        else:
            count = len(clusters)
            by_hand = proportion_confint(group["accuracy"] * count, count, method="wilson")
            assert (group["low"], group["high"]) == pytest.approx(by_hand, abs=1e-9)
        expected = second.bootstrap_interval(clusters_of(own, lambda r: r["ticks"]), number, 6_000)
        assert close((group["ticks_low"], group["ticks_high"]), expected, 0.12)


@TABLES
def test_paired_differences(kind, number):
    from statsmodels.stats.contingency_tables import mcnemar

    rows = table(kind, number)
    identity = ["a", "b", "variation", "repeat"]
    (single,) = paired_rows([row for row in rows if row["repeat"] == 0], "a", identity)
    counts = np.array([[single.both, single.only_one], [single.only_other, 0]])
    assert single.p == pytest.approx(min(1.0, mcnemar(counts, exact=True).pvalue), abs=1e-12)
    by_hand = second.bonett_price(single.only_one, single.only_other, single.pairs)
    assert single.interval == pytest.approx(by_hand, abs=1e-12)
    (pairs,) = paired_rows(rows, "a", identity)
    values = {(row["variation"], row["repeat"], row["a"]): row["ok"] for row in rows}
    differences = {}
    for (variation, repeat, a), ok in values.items():
        if a == pairs.one and (variation, repeat, pairs.other) in values:
            other = values[variation, repeat, pairs.other]
            differences.setdefault(variation, []).append(int(ok) - int(other))
    clusters = list(differences.values())
    everything = [each for cluster in clusters for each in cluster]
    assert pairs.difference == pytest.approx(np.mean(everything))
    assert pairs.p == pytest.approx(second.sign_exchange_p([sum(each) for each in clusters]))
    if len({np.mean(each) for each in clusters}) > 1 and max(map(len, clusters)) > 1:
        expected = second.bootstrap_interval(clusters, number, 6_000)
        assert close(pairs.interval, expected, 0.12)


@TABLES
def test_intervals_over_variations_and_people(kind, number):
    rows = [{**row, "participant": f"p{row['repeat']}{row['a']}"} for row in table(kind, number)]
    (found,) = count_rows(rows, [])
    if found["interval"] == "two-way bootstrap":
        columns = ([row[name] for row in rows] for name in ("ok", "variation", "participant"))
        expected = second.crossed_bootstrap(*columns, number, 2_000)
        assert close((found["low"], found["high"]), expected, 0.15)


def arrays(rows, *, interaction=False):
    """Return answers, design matrix in treatment coding, and numbers of variations."""
    first = {name: rows[0][name] for name in "ab"}
    levels = {name: list(dict.fromkeys(r[name] for r in rows))[1:] for name in "ab"}
    columns = [np.ones(len(rows))]
    dummies = {(n, v): np.array([r[n] == v for r in rows], float) for n in "ab" for v in levels[n]}
    columns += dummies.values()
    if interaction:
        columns += [dummies["a", v] * dummies["b", w] for v in levels["a"] for w in levels["b"]]
    names = list(dict.fromkeys(row["variation"] for row in rows))
    groups = np.array([names.index(row["variation"]) for row in rows])
    assert len(levels["a"]) == 1 and first["b"] not in levels["b"]
    return np.array([row["ok"] for row in rows], float), np.column_stack(columns), groups


@TABLES
def test_estimating_equations(kind, number):
    rows = table(kind, number)
    y, x, groups = arrays(rows)
    for family in ("binomial", "gaussian"):
        fit = fit_rows(rows, ["a", "b"], "gee", family)
        assert fit.sound is not (family == "binomial" and second.is_separated(y, x))
        if fit.sound and "exchangeable" in fit.method:
            estimates, errors, shared = second.gee(y, x, groups, family)
            se = np.array([term.se for term in fit.terms])
            assert np.allclose(
                [term.estimate for term in fit.terms], estimates, atol=1e-3 * se.min()
            )
            assert np.allclose(se, errors, rtol=2e-3)
            assert fit.correlation == pytest.approx(shared, abs=2e-3)


@TABLES
def test_separation_and_penalised_estimates(kind, number):
    rows = table(kind, number)
    y, x, groups = arrays(rows, interaction=True)
    fit = fit_rows(rows, ["a", "b", ("a", "b")], "gee", "binomial")
    assert fit.sound is not second.is_separated(y, x)
    if kind == "separated":
        assert not fit.sound
    if fit.sound or number % 8 or (number == 0 and kind != "separated"):
        return
    # One row of each variation and combination of levels: all rows weigh alike.
    seen = set()
    rows = [r for r in rows if (k := (r["variation"], r["a"])) not in seen and not seen.add(k)]
    y, x, groups = arrays(rows)
    from beliefnest.studies.fits import firth

    found = firth(y, x, groups)
    estimates, bounds = second.firth(y, x, firth_weights(y, x, groups, second.firth))
    assert np.allclose(found.estimates, estimates, atol=2e-3)
    assert np.allclose(np.column_stack([found.low, found.high]), bounds, atol=5e-3)


def firth_weights(y, x, groups, fitted):
    """Return weights of rows, from the correlation of Pearson's residuals of a variation."""
    p = 1 / (1 + np.exp(-x @ fitted(y, x, np.ones(len(y)))[0]))
    residuals = (y - p) / np.sqrt(p * (1 - p))
    products = [
        residuals[i] * residuals[j]
        for i in range(len(y))
        for j in range(len(y))
        if i != j and groups[i] == groups[j]
    ]
    shared = min(1, max(0, np.mean(products) / np.mean(residuals**2)))
    return np.array([1 / (1 + (np.sum(groups == group) - 1) * shared) for group in groups])


@TABLES
def test_mixed_models(kind, number):
    import statsmodels.api as sm

    rows = table(kind, number)
    y, x, groups = arrays(rows)
    linear = fit_rows(rows, ["a", "b"], "mixed", "gaussian")
    if linear.sound and linear.correlation > 0.08:
        with warnings.catch_warnings():
            # statsmodels warns of boundaries that its search only visits.
            warnings.simplefilter("ignore")
            raw = sm.MixedLM(y, x, groups=groups).fit(reml=True, method="powell")
        se = np.array([term.se for term in linear.terms])
        found = np.array([term.estimate for term in linear.terms])
        assert np.allclose(found, raw.fe_params, atol=2e-3 * se.min())
        expected = second.linear_mixed_errors(x, groups, raw.scale, raw.cov_re.item())
        assert np.allclose(se, expected, rtol=5e-3)
        assert linear.correlation == pytest.approx(math.sqrt(raw.cov_re.item()), rel=1e-2)
    logistic = fit_rows(rows, ["a", "b"], "mixed", "binomial")
    if logistic.sound and logistic.correlation > 0.3 and number % 8 == 0 and kind != "balanced":
        estimates, spread = second.logistic_mixed(y, x, groups)
        assert logistic.correlation == pytest.approx(spread, abs=0.02)
        se = np.array([term.se for term in logistic.terms])
        assert np.allclose([t.estimate for t in logistic.terms], estimates, atol=0.03 * se.min())


@TABLES
def test_bootstrap_of_least_squares(kind, number):
    from beliefnest.studies.fits import bootstrap

    y, x, groups = arrays(table(kind, number))
    found = bootstrap(y, x, groups)
    low, high = second.least_squares_bootstrap(y, x, groups, number, 2_000)
    assert np.allclose(found.low, low, atol=0.15 * (high - low).max())
    assert np.allclose(found.high, high, atol=0.15 * (high - low).max())
    assert np.allclose(found.estimates, np.linalg.lstsq(x, y, rcond=None)[0], atol=1e-9)


@TABLES
def test_counts_of_positions(kind, number):
    rows = table(kind, number)
    chance = np.random.default_rng(number)
    choices = [
        {
            **row,
            "options": 3,
            "right_at": int(chance.integers(1, 4)),
            "chosen_at": [None, 1, 2, 3][chance.integers(0, 4)],
        }
        for row in rows
    ]
    for group in count_positions(choices, ["a"]):
        own = [
            each
            for each in choices
            if each["a"] == group["a"] and each["right_at"] == group["right_at"]
        ]
        chosen = [each["chosen_at"] for each in own]
        assert [group[f"chosen_{n}"] for n in (1, 2, 3)] == [chosen.count(n) for n in (1, 2, 3)]
        assert (group["asked"], group["none"]) == (len(own), chosen.count(None))
        assert group["accuracy"] == pytest.approx(chosen.count(group["right_at"]) / len(own))
        assert group["low"] <= group["accuracy"] <= group["high"]


@pytest.mark.parametrize(("difference", "pairs"), [(0.0, 20), (0.25, 30)])
def test_power_of_independent_pairs(difference, pairs):
    source = AssumedRates(accuracy=0.7, difference=difference, correlation=0.0, rows=1, pairs=1)
    simulations = 800
    (found,) = power_rows([("x", source)], [pairs], simulations, 1)
    exact = second.mcnemar_power(0.7, 0.7 - difference, pairs)
    # Four standard errors of a share in so many simulations.
    assert abs(found["power"] - exact) < 4 * math.sqrt(exact * (1 - exact) / simulations)
