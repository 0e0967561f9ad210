"""Films of food trucks: the format, and the correlations with people's judgments."""

import json
import random
import re
from pathlib import Path

import numpy as np
import pandas
import pytest
from msgspec import convert
from msgspec.structs import replace
from tests.profiles import NIGHTLY, few_by_day

from beliefnest.cli.app import run_command_line
from beliefnest.errors import InputError
from beliefnest.suites.films.agreement import JudgesAgreement, agreement, interval
from beliefnest.suites.films.cells import film_cells
from beliefnest.suites.films.film import FilmParameters, FilmRow, grid_for
from beliefnest.suites.films.film_files import films_from, parameters_from, read_films
from beliefnest.suites.films.film_inference import LESIONS, judge

DATA = Path(__file__).parents[4] / "shared/samples/food-trucks/exp1.json"


def rows_of(films, parameters, lesion=None):
    """Return the rows of films in the table, as a plan plays them."""
    cells = [cell for cell in film_cells("films", films, parameters) if cell.lesion == lesion]
    return [row for cell in cells for row in convert(cell.play(None)["rows"], list[FilmRow])]


@pytest.fixture(scope="module")
def published():
    if not DATA.exists():
        pytest.skip(f"no food-truck data at {DATA}")
    films, parameters = read_films(DATA)
    return films, parameters, rows_of(films, parameters)


def test_correlates_with_people_as_published(published):
    films, _, rows = published
    assert len(films) == 78
    assert sum(film.scored for film in films) == 73
    assert agreement(rows, "desires").r >= 0.90
    assert agreement(rows, "beliefs").r >= 0.76


@pytest.mark.parametrize("lesion", few_by_day(LESIONS))
def test_lesions_are_worse(published, lesion):
    films, parameters, rows = published
    lesioned = rows_of(films, parameters, lesion)
    for what in ("desires", "beliefs"):
        assert agreement(lesioned, what).r < agreement(rows, what).r - 0.1


def small(true, **further):
    return {
        "worlds": [
            {
                "size": [6, 3],
                "wall": [[2, 2], [3, 2], [4, 2], [5, 2], [6, 2]],
                "spot1": [6, 1],
                "spot2": [6, 3],
                "spot3": [1, 3],
                "possible_spot2": ["B", "C", None],
                "possible_spot3": ["C", None],
            }
        ],
        "scenarios": [
            {
                "id": 1,
                "world_set": 1,
                **true,
                "path_xy": [[2, 1], [1, 1], [1, 2], [1, 3], [2, 3], [3, 3]],
                "ends_with_eat": False,
                "human": {"desire_ABC_mean_1to7": [2, 6, 3]},
                **further,
            }
        ],
    }


def test_reads_any_number_of_places_goals_and_alternatives():
    (film,) = films_from(small({"true_spot2": "B", "true_spot3": None}))
    assert film.goals == ("A", "B", "C")
    assert film.known == {"spot1": "A"}
    assert list(film.alternatives) == ["B+C", "B+none", "C+C", "C+none", "none+C", "none+none"]
    assert film.actual == ("B+none",)
    judgment = judge(film, FilmParameters(rewards=(0, 40), grid=1))
    assert judgment.model["desires"]["B"] > judgment.model["desires"]["A"]


def test_an_observer_may_not_know_where_things_are():
    (film,) = films_from(small({"true_spot2": "unknown", "true_spot3": "unknown"}))
    assert film.observer_doubts
    judgment = judge(film, FilmParameters(rewards=(0, 40), grid=1))
    # Whoever sees one end of the lane and walks on towards the other has seen something there.
    locations = judgment.model["locations"]
    assert sum(locations[name] for name in film.alternatives) == pytest.approx(1)
    assert locations["spot2=B"] == pytest.approx(locations["B+C"] + locations["B+none"])
    assert locations["B+none"] > locations["none+none"]


def test_another_form_is_refused(tmp_path):
    file = tmp_path / "films.json"
    file.write_text('{"worlds": []}')
    with pytest.raises(InputError, match="no list of worlds"):
        read_films(file)
    with pytest.raises(InputError, match="cannot be read"):
        read_films(tmp_path / "missing.json")


def two_places(**further):
    """Return a film whose observer does not know which of two goals stands where."""
    return {
        "worlds": [
            {
                "size": [5, 3],
                "wall": [[3, 2], [3, 3]],
                "spot1": [1, 3],
                "spot2": [5, 3],
                "alternatives": [{"spot1": "K", "spot2": "L"}, {"spot1": "L", "spot2": "K"}],
            }
        ],
        "parameters": {"reward_levels": {"K": 60, "L": [0, 20]}},
        "scenarios": [
            {
                "id": "a",
                "actual": "unknown",
                "path_xy": [[3, 1], [4, 1], [5, 1], [5, 2], [5, 3]],
                "ends_with_eat": True,
                **further,
            }
        ],
    }


def test_films_may_be_about_what_stands_where():
    human = {
        "location_KL_LK_mean_norm": [0.2, 0.8],
        "location_se": [0.1, 0.05],
        "belief_spot2_KL_mean_1to7": [4, 2],
        "note": "two people",
    }
    content = two_places(human=human)
    (film,) = films_from(content)
    assert film.people["locations"] == {"K+L": 0.2, "L+K": 0.8}
    assert film.errors["locations"] == {"K+L": 0.1, "L+K": 0.05}
    assert film.people["beliefs"] == {"spot2=K": 0.75, "spot2=L": 0.25}
    judgment = judge(film, parameters_from(content))
    assert judgment.model["desires"]["K"] == pytest.approx(60)
    # Whoever likes K best and goes to the right acts on K there.
    assert judgment.model["locations"]["L+K"] > 0.9
    told = judge(film, parameters_from(content), "true_belief").model
    assert told["locations"]["L+K"] > 0.9
    assert told["beliefs"]["L+K"] == pytest.approx(told["locations"]["L+K"], abs=0.05)


@pytest.mark.parametrize(
    ("entry", "world", "told"),
    [
        ({"human": {"belief_XY_mean": [1, 2]}}, {}, "human.belief_XY_mean is not understood"),
        ({"human": {"mood_KL_mean": [1, 2]}}, {}, "human.mood_KL_mean is not understood"),
        ({"human": {"desire_KL_mean": [1, 2, 3]}}, {}, "give 2 numbers"),
        ({"human": {"belief_KL_LK_mean_1to7": [1, 1]}}, {}, "no ratings from 1 to 7"),
        ({"actual": "K"}, {}, "give 'unknown' or one of K+L, L+K"),
        ({"actual": None}, {}, "true_spot1 is missing"),
        ({"actual": None, "true_spot1": "M", "true_spot2": "L"}, {}, "none of the possible: K, L"),
        ({"actual": None, "true_spot1": "L", "true_spot2": "L"}, {}, "no alternative has"),
        ({"path_xy": [[3, 2]]}, {}, "step 1 of path_xy, [3, 2], is off the floor or in a wall"),
        ({"path_xy": []}, {}, "path_xy is empty"),
        ({"ends_with_eat": 1}, {}, "ends_with_eat is 1"),
        ({"world_set": 2}, {}, "world_set is 2"),
        ({}, {"spot2": [6, 3]}, "spot2 at [6, 3] is off the floor"),
        ({}, {"spot2": [1, 3]}, "two places are in one cell"),
        ({}, {"size": [5, 0]}, "size is [5, 0]"),
        ({}, {"alternatives": [{"spot1": "K"}, {"spot2": "K"}]}, "do not all name goals"),
        ({}, {"alternatives": None}, "nothing is in doubt"),
        ({"human": {"desire_KLMN_mean": [1, 2, 3, 4]}}, {"spot3": [2, 3]}, "add true_spot3"),
    ],
)
def test_what_is_not_understood_is_refused_with_the_film(entry, world, told, tmp_path):
    content = two_places(**entry)
    content["worlds"][0].update(world)
    file = tmp_path / "films.json"
    file.write_text(json.dumps(content))
    with pytest.raises(InputError) as caught:
        read_films(file)
    assert str(caught.value).startswith(f"{file}: film a: ")
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "given",
    [
        {"reward_levels": []},
        {"reward_levels": {"K": "high"}},
        {"discount": "x"},
        {"agent_prior_grid": "fine"},
        {"reward_levels": list(range(200))},
        [],
    ],
)
def test_odd_parameters_are_refused(given, tmp_path):
    file = tmp_path / "films.json"
    file.write_text(
        json.dumps({**small({"true_spot2": "B", "true_spot3": None}), "parameters": given})
    )
    with pytest.raises(InputError, match=r"parameters|hypotheses"):
        read_films(file)


def test_a_file_names_the_grid_of_credences():
    told = parameters_from({"parameters": {"agent_prior_grid": "simplex of step 1/4"}})
    assert (told.grid, told.smoothing) == (4, 0)
    text = "simplex of step 1/6 (28 points), shrunk: b*(1-.075)+.075/3"
    told = parameters_from({"parameters": {"agent_prior_grid": text}})
    assert (told.grid, told.smoothing) == (6, 0.075)


def test_a_place_that_nobody_names_a_goal_for_has_one_of_its_own():
    content = small({"true_spot2": "B", "true_spot3": None})
    del content["scenarios"][0]["human"]
    (film,) = films_from(content)
    assert film.known == {"spot1": "spot1"}
    assert film.goals == ("spot1", "B", "C")


def test_a_step_that_no_hypothesis_explains_is_told_and_counts_for_nothing():
    human = {"desire_KL_mean_1to7": [3, 4]}
    content = two_places(human=human, actual="K+L", path_xy=[[2, 1], [1, 1]])
    (film,) = films_from(content)
    # The film ends with an act where no goal is.
    rows = rows_of([film], parameters_from(content))
    assert {row.impossible is None for row in rows} == {False}
    assert not len(agreement(rows, "desires").model)


def pairs_of(model, people, films):
    return JudgesAgreement(
        "desires",
        ("K",) * len(model),
        np.array(model, dtype=float),
        np.array(people, dtype=float),
        np.full(len(model), np.nan),
        np.array(films),
    )


def test_correlations_are_pearsons_and_intervals_are_seeded():
    rng = np.random.default_rng(5)
    model = rng.normal(1000, 1, 60)
    people = model + rng.normal(0, 0.5, 60)
    pairs = pairs_of(model, people, np.repeat(np.arange(20), 3))
    assert pairs.r == pytest.approx(np.corrcoef(model, people)[0, 1], abs=1e-12)
    low, high = interval(pairs, seed=1)
    assert interval(pairs, seed=1) == (low, high) != interval(pairs, seed=2)
    assert 0.75 < low < pairs.r < high < 0.97
    # The plain bootstrap over films, drawn one by one.
    drawn = []
    for _ in range(1000):
        rows = np.concatenate([np.arange(3) + 3 * film for film in rng.integers(0, 20, 20)])
        drawn.append(np.corrcoef(model[rows], people[rows])[0, 1])
    assert (low, high) == pytest.approx(np.percentile(drawn, [2.5, 97.5]), abs=0.02)


def test_without_spread_there_is_no_correlation():
    pairs = pairs_of([0.1 + 0.2] * 9, range(9), range(9))
    assert np.isnan(pairs.r)
    assert interval(pairs) is None
    assert interval(pairs_of([1, 2], [1, 2], [0, 1])) is None


def suite(tmp_path, content, *options):
    file = tmp_path / "films.json"
    file.write_text(json.dumps(content))
    out = tmp_path / "out"
    return run_command_line(
        ["suite", "food-trucks", "--data", str(file), "--out", str(out), *options]
    )


def test_the_suite_prints_correlations_and_writes_figures_and_tables(tmp_path, capsys):
    content = small({"true_spot2": "B", "true_spot3": None})
    content["parameters"] = {"reward_levels": [0, 40], "agent_prior_grid": "simplex of step 1/1"}
    content["groups"] = {"all": [1, 2, 3]}
    first = content["scenarios"][0]
    content["scenarios"] += [{**first, "id": 2}, {**first, "id": 3}, {**first, "id": 4}]
    del content["scenarios"][3]["human"]
    content["scenarios"][2]["excluded"] = True
    assert suite(tmp_path, content) == 0
    told = capsys.readouterr().out
    assert "food-trucks: 4 films, 3 of them scored" in told
    assert "all (2 films)" in told
    assert "0.908" in told
    assert "films without judgments of people" in told
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert [name for name in written if name not in {"rows.parquet", "seconds.jsonl"}] == [
        *("cells", "rows.csv", "scatter.pdf", "scatter.png", "scatter.svg", "study.json")
    ]
    frame = pandas.read_csv(tmp_path / "out/rows.csv")
    assert list(frame["variant"].unique()) == ["model", "true_belief", "no_cost"]
    assert frame["people"].notna().sum() == 3 * 3 * 3
    assert suite(tmp_path, content, "--json") == 0
    once = json.loads(capsys.readouterr().out)
    assert suite(tmp_path, content, "--json") == 0
    assert json.loads(capsys.readouterr().out) == once
    assert once["correlations"]["model"]["desires"]["judgments"] == 6
    assert set(once["correlations"]["true_belief"]) == {"desires"}


def test_films_that_people_did_not_judge_are_judged(tmp_path, capsys):
    assert suite(tmp_path, two_places()) == 0
    told = capsys.readouterr().out
    assert "people judged none of them" in told
    assert "K+L 0." in told
    assert not (tmp_path / "out/scatter.svg").exists()


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--world", "embedded"], "acted out in the scripted world"),
        (["--claims-from", "offline"], "--claims-from is for stories"),
        (["--rows", "7"], "none of the films asked for"),
        (["--limit", "0"], "--limit is 0"),
    ],
)
def test_odd_options_are_refused(tmp_path, capsys, options, told):
    assert suite(tmp_path, two_places(), *options) == 2
    assert told in capsys.readouterr().err


def changed(value, dice):
    """Return plain values with one of them, anywhere, replaced or taken away."""
    other = dice.choice([None, 1, 0, -1.5, "x", "unknown", [], {}, [[]], {"x": None}, True])
    if isinstance(value, dict) and value and dice.random() < 0.95:
        key = dice.choice(sorted(value))
        if dice.random() < 0.2:
            return {name: each for name, each in value.items() if name != key}
        return {**value, key: changed(value[key], dice)}
    if isinstance(value, list) and value and dice.random() < 0.95:
        index = dice.randrange(len(value))
        return [*value[:index], changed(value[index], dice), *value[index + 1 :]]
    return other


def test_files_of_a_slightly_other_form_are_read_or_refused(tmp_path):
    dice = random.Random(3)
    file = tmp_path / "films.json"
    human = {"location_KL_LK_mean_norm": [0.2, 0.8], "desire_KL_mean_1to7": [3, 4]}
    sound = [
        two_places(human=human),
        {**small({"true_spot2": "B", "true_spot3": None}), "groups": {"all": [1]}},
    ]
    refused = 0
    for number in range(400 if NIGHTLY else 150):
        content = sound[number % 2]
        for _ in range(dice.choice([1, 1, 2])):
            content = changed(content, dice)
        file.write_text(json.dumps(content))
        try:
            films, parameters = read_films(file)
            for film in films[:1]:
                judge(film, replace(parameters, rewards=(0, 40), grid=1))
        except InputError as error:
            refused += 1
            assert "\n" not in str(error)
    assert refused > 20


def test_the_form_in_the_docs_is_read(tmp_path):
    page = (Path(__file__).parents[3] / "docs/batteries.md").read_text()
    (example,) = re.findall(r"```json\n(\{\"worlds.*?)```", page, re.DOTALL)
    file = tmp_path / "films.json"
    file.write_text(example)
    ((film,), _) = read_films(file)
    assert film.known == {"spot1": "K"}
    assert film.group == "short"
    assert set(film.people) == {"desires", "beliefs"}


def test_a_grid_that_does_not_fit_into_memory_is_made_coarser_and_told(
    tmp_path, capsys, monkeypatch
):
    content = two_places(path_xy=[[3, 1], [4, 1]], ends_with_eat=False)
    world = content["worlds"][0]
    del world["alternatives"]
    world["possible_spot1"] = world["possible_spot2"] = ["K", "L", None]
    content["parameters"]["agent_prior_grid"] = "simplex of step 1/20"
    (film,) = films_from(content)
    assert len(film.alternatives) == 9
    parameters = parameters_from(content)
    assert grid_for(film, parameters) == 11
    assert grid_for(film, replace(parameters, grid=6)) == 6
    content["parameters"]["reward_levels"] = list(range(60))
    (film,) = films_from(content)
    assert grid_for(film, parameters_from(content)) == 2
    content["parameters"]["reward_levels"] = [0, 40]
    # In place of a film that fills the memory.
    monkeypatch.setattr("beliefnest.suites.films.film._MOST_WEIGHTS", 2000)
    assert suite(tmp_path, content) == 0
    assert "film a: credences are multiples of 1/1; finer ones" in capsys.readouterr().out
