"""Every figure of a report, held against a second implementation on generated tables.

Tolerances: exact methods agree to rounding; fits to 1e-3 of a standard error (logistic mixed models
to 0.03); a limit of a bootstrap, whose draws differ, lies between the second's limits at 0.5 % and
4.5 %. `FIGURES` lists all figures. Reports hold
no agreement of raters (Krippendorff's alpha): answers of people are judged, not rated. Newcombe's
interval is no figure either, and is held against the one that reports give.
"""

import math
import warnings

import numpy as np
import pytest
from tests.profiles import at_night, few_by_day

from beliefnest.scenarios.judging import OUTCOMES
from beliefnest.studies.counting import count_rows, paired_rows
from beliefnest.studies.positions import count_positions
from beliefnest.studies.power import AssumedRates, power_rows
from beliefnest.studies.regression import fit_rows
from beliefnest.studies.study_record import COMPARED
from beliefnest.suites.films.agreement import JudgesAgreement, interval

pytest.importorskip("scipy", reason="comes with the extra `stats`")
from scipy import stats
from tests.studies import second_statistics as second

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


def agrees(found, draws):
    """Return True if limits of a bootstrap are those of other draws, up to chance.

    With 2,000 draws here and twice as many there, 5 standard errors of the share beyond a limit are
    2 %. In small tables a limit is one of few values, so that limits can only be compared by these
    shares.

    Args:
        found: Lower and upper limit; each may have several values.
        draws: Draws of the second implementation, along the first axis.
    """
    least, low, high, most = np.percentile(draws, [0.5, 4.5, 95.5, 99.5], axis=0)
    pairs = ((least, found[0]), (found[0], low), (high, found[1]), (found[1], most))
    return all(np.all(np.asarray(one) <= np.asarray(other) + 1e-9) for one, other in pairs)


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
            assert agrees((group["low"], group["high"]), second.bootstrap_means(clusters, number))
        else:
            count = len(clusters)
            by_hand = proportion_confint(group["accuracy"] * count, count, method="wilson")
            assert (group["low"], group["high"]) == pytest.approx(by_hand, abs=1e-9)
        means = second.bootstrap_means(clusters_of(own, lambda row: row["ticks"]), number)
        assert agrees((group["ticks_low"], group["ticks_high"]), means)


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
    neither = single.pairs - single.both - single.only_one - single.only_other
    score = second.newcombe(single.both, single.only_one, single.only_other, neither)
    # Two methods for one interval; in few pairs they differ.
    assert np.allclose(single.interval, score, atol=1.2 / single.pairs)
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
        assert agrees(pairs.interval, second.bootstrap_means(clusters, number))


@TABLES
def test_intervals_over_variations_and_people(kind, number):
    rows = [{**row, "participant": f"p{row['repeat']}{row['a']}"} for row in table(kind, number)]
    (found,) = count_rows(rows, [])
    if found["interval"] == "two-way bootstrap":
        columns = ([row[name] for row in rows] for name in ("ok", "variation", "participant"))
        means = second.crossed_bootstrap_means(*columns, number)
        assert agrees((found["low"], found["high"]), means)
    people = [{**row, "participant": f"p{row['repeat']}"} for row in rows]
    (pairs,) = paired_rows(people, "a", ["a", "b", "variation", "repeat"])
    differences = {}
    for row in people:
        sign = 1 if row["a"] == pairs.one else -1
        place = row["variation"], row["participant"]
        differences.setdefault(place, []).append(sign * int(row["ok"]))
    complete = {place: sum(each) for place, each in differences.items() if len(each) == 2}
    assert len(complete) == pairs.pairs
    variations, own = zip(*complete, strict=True)
    if len(set(own)) > 1:
        means = second.crossed_bootstrap_means(list(complete.values()), variations, own, number)
        low, high = np.percentile(means, [2.5, 97.5])
        if low < high:
            assert agrees(pairs.interval, means)
        else:
            # A bootstrap says nothing; the interval of Bonett and Price has a width.
            assert pairs.interval[0] < pairs.difference < pairs.interval[1]


@TABLES
def test_counts_and_sums(kind, number):
    chance = np.random.default_rng(number)
    rows = [
        {
            **row,
            "chance": 1 / int(chance.integers(2, 5)),
            "outcome": "ok" if row["ok"] else str(chance.choice(OUTCOMES[1:])),
            "tokens": int(chance.integers(0, 90)),
            "cost": float(chance.random()),
        }
        for row in table(kind, number)
    ]
    for group in count_rows(rows, ["a"]):
        own = [row for row in rows if row["a"] == group["a"]]
        assert group["chance"] == pytest.approx(np.mean([row["chance"] for row in own]))
        told = [row["outcome"] for row in own]
        assert {name: group[name] for name in OUTCOMES} == {n: told.count(n) for n in OUTCOMES}
        assert group["tokens"] == sum(row["tokens"] for row in own)
        assert group["cost"] == pytest.approx(math.fsum(row["cost"] for row in own))
        assert (group["rows"], group["copies"], group["judged"]) == (len(own), 0, len(own))
        assert group["variations"] == len({row["variation"] for row in own})
        assert group["right"] == told.count("ok")


@TABLES
def test_correlations_with_people(kind, number):
    chance = np.random.default_rng([number, len(kind)])
    films = np.repeat(np.arange(20), 3)
    model = chance.normal(size=60)
    people = 0.6 * model + chance.normal(size=60) + chance.normal(size=20)[films]
    pairs = JudgesAgreement("desires", (), model, people, np.full(60, np.nan), films)
    assert pairs.r == pytest.approx(stats.pearsonr(model, people).statistic, abs=1e-12)
    drawn = []
    for _ in range(3_000):
        chosen = np.concatenate([np.flatnonzero(films == n) for n in chance.integers(0, 20, 20)])
        drawn.append(np.corrcoef(model[chosen], people[chosen])[0, 1])
    assert agrees(interval(pairs), drawn)


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
            are_wald(fit.terms)
            for term, plain in zip(fit.terms, fit.plain()["terms"], strict=True):
                if family == "binomial":
                    assert plain["odds_ratio"] == pytest.approx(math.e**term.estimate)


def are_wald(terms):
    """Check p and intervals of z tests."""
    for term in terms:
        normal = stats.norm(term.estimate, term.se)
        assert term.interval == pytest.approx(normal.interval(0.95), abs=1e-9)
        two_sided = 2 * stats.norm.sf(abs(term.estimate / term.se))
        assert term.p == pytest.approx(two_sided, abs=1e-12)


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
    estimates, bounds, tests = second.firth(y, x, firth_weights(y, x, groups, second.firth))
    assert np.allclose(found.estimates, estimates, atol=2e-3)
    assert np.allclose(found.tests, tests, atol=2e-3)
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
        are_wald(linear.terms)
    logistic = fit_rows(rows, ["a", "b"], "mixed", "binomial")
    if logistic.sound and logistic.correlation > 0.3 and number % 8 == 0 and kind != "balanced":
        estimates, spread = second.logistic_mixed(y, x, groups)
        assert logistic.correlation == pytest.approx(spread, abs=0.02)
        se = np.array([term.se for term in logistic.terms])
        assert np.allclose([t.estimate for t in logistic.terms], estimates, atol=0.03 * se.min())
        are_wald(logistic.terms)


@TABLES
def test_bootstrap_of_least_squares(kind, number):
    from beliefnest.studies.fits import bootstrap

    y, x, groups = arrays(table(kind, number))
    found = bootstrap(y, x, groups)
    drawn = second.least_squares_bootstrap(y, x, groups, number)
    assert np.allclose(found.errors, drawn.std(axis=0), rtol=0.15)
    assert agrees((found.low, found.high), drawn)
    drawn = np.round(drawn, 10)
    beyond = np.minimum((drawn <= 0).mean(axis=0), (drawn >= 0).mean(axis=0))
    assert np.allclose(found.tests, np.minimum(1, 2 * beyond), atol=0.12)
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
        clusters = clusters_of(own, lambda each: each["chosen_at"] == each["right_at"])
        if max(map(len, clusters)) == 1 or len({np.mean(each) for each in clusters}) == 1:
            count = len(clusters)
            by_hand = stats.binomtest(round(group["accuracy"] * count), count)
            wilson = by_hand.proportion_ci(method="wilson")
            if math.isclose(by_hand.statistic, group["accuracy"]):
                assert (group["low"], group["high"]) == pytest.approx(wilson)
        elif len(clusters) > 9:
            assert agrees((group["low"], group["high"]), second.bootstrap_means(clusters, number))


@pytest.mark.parametrize(("difference", "pairs"), [(0.0, 20), (0.25, 30)])
def test_power_of_independent_pairs(difference, pairs):
    source = AssumedRates(accuracy=0.7, difference=difference, correlation=0.0, rows=1, pairs=1)
    simulations = 800
    (found,) = power_rows([("x", source)], [pairs], simulations, 1)
    exact = second.mcnemar_power(0.7, 0.7 - difference, pairs)
    # Four standard errors of a share in so many simulations.
    assert abs(found["power"] - exact) < 4 * math.sqrt(exact * (1 - exact) / simulations)
    width, widest, coverage = second.rate_widths(0.7, pairs)
    assert found["width"] == pytest.approx(width, rel=0.02)
    assert found["width_90"] == pytest.approx(widest, rel=0.02)
    assert abs(found["coverage"] - coverage) < 4 * math.sqrt(
        coverage * (1 - coverage) / simulations
    )
    wanted = second.difference_width(0.7, 0.7 - difference, pairs)
    assert found["difference_width"] == pytest.approx(wanted, rel=0.03)


FIGURES = {
    test_accuracies_and_means: {"accuracy", "low", "high", "ticks", "ticks_low", "ticks_high"},
    test_counts_and_sums: {
        *("rows", "copies", "judged", "variations", "right", "chance", "tokens", "cost"),
        *OUTCOMES,
    },
    test_paired_differences: {
        *("pairs", "both", "only_one", "only_other", "difference", "low", "high", "p"),
        "variations",
    },
    test_estimating_equations: {
        *("estimate", "se", "low", "high", "p", "odds_ratio", "correlation", "intercept_sd"),
        *("rows", "variations"),
    },
    test_counts_of_positions: {
        *("options", "right_at", "asked", "variations", "right", "accuracy", "low", "high"),
        *("chosen_1", "chosen_2", "none"),
    },
    test_power_of_independent_pairs: {
        *("variations", "simulations", "width", "width_90", "coverage"),
        *("difference_width", "power"),
    },
}
"""Figures of each kind of report, with the test that holds them against a second implementation."""


def numbers_in(*found):
    return {
        name
        for each in found
        for name, value in each.items()
        if isinstance(value, int | float) and not isinstance(value, bool)
    }


def test_no_figure_of_a_report_is_left_out():
    rows = [{**row, "chance": 0.5, "tokens": 1, "cost": 0.1} for row in table("balanced", 0)]
    counted = count_rows(rows, ["a"], {"ticks": False})
    assert numbers_in(*counted) == {
        *FIGURES[test_accuracies_and_means],
        *FIGURES[test_counts_and_sums],
    }
    (pairs,) = paired_rows(rows, "a", ["a", "b", "variation", "repeat"])
    shown = {name: getattr(pairs, name) for name in COMPARED}
    low, high = pairs.interval
    compared = numbers_in({**shown, "low": low, "high": high, "p": pairs.p})
    assert compared == FIGURES[test_paired_differences]
    fits = [fit_rows(rows, ["a"], kind, "binomial").plain() for kind in ("gee", "mixed")]
    terms = [term for fit in fits for term in fit["terms"]]
    assert numbers_in(*fits, *terms) == FIGURES[test_estimating_equations]
    choices = [{**row, "options": 2, "right_at": 1, "chosen_at": 1} for row in rows]
    assert numbers_in(*count_positions(choices, [])) == FIGURES[test_counts_of_positions]
    source = AssumedRates(accuracy=0.7, difference=0.1, correlation=0.0, rows=1, pairs=1)
    (power,) = power_rows([("x", source)], [10], 20, 1)
    assert numbers_in(power) == FIGURES[test_power_of_independent_pairs]
