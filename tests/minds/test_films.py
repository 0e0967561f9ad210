"""Films of food trucks: the format, and the correlations with people's judgments."""

from pathlib import Path

import pytest

from beliefnest.errors import InputError
from beliefnest.studies.films import LESIONS, correlation, films_from, judge, read_films

DATA = Path(__file__).parents[2].parent / "shared/samples/food-trucks/exp1.json"


@pytest.fixture(scope="module")
def published():
    if not DATA.exists():
        pytest.skip(f"no food-truck data at {DATA}")
    films, parameters = read_films(DATA)
    judgments = [judge(film, parameters) for film in films]
    return films, parameters, judgments


def test_correlates_with_people_as_published(published):
    films, _, judgments = published
    assert len(films) == 78
    assert sum(film.scored for film in films) == 73
    assert correlation(judgments, "desires").r >= 0.90
    assert correlation(judgments, "beliefs").r >= 0.76


def test_lesions_are_worse(published):
    films, parameters, judgments = published
    whole = [correlation(judgments, what).r for what in ("desires", "beliefs")]
    for lesion in LESIONS:
        lesioned = [judge(film, parameters, lesion) for film in films]
        for what, r in zip(("desires", "beliefs"), whole, strict=True):
            assert correlation(lesioned, what).r < r - 0.1


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
    assert film.actual == "B+none"
    from beliefnest.studies.films import FilmParameters

    judgment = judge(film, FilmParameters(rewards=(0, 40), grid=1))
    assert judgment.desires["B"] > judgment.desires["A"]


def test_an_observer_may_not_know_where_things_are():
    (film,) = films_from(small({"true_spot2": "unknown", "true_spot3": "unknown"}))
    assert film.actual is None
    from beliefnest.studies.films import FilmParameters

    judgment = judge(film, FilmParameters(rewards=(0, 40), grid=1))
    # Whoever sees one end of the lane and walks on towards the other has seen something there.
    locations = judgment.locations
    assert sum(locations.values()) == pytest.approx(1)
    assert locations["B+none"] > locations["none+none"]


def test_another_form_is_refused(tmp_path):
    file = tmp_path / "films.json"
    file.write_text('{"worlds": []}')
    with pytest.raises(InputError, match="not of the form"):
        read_films(file)
    with pytest.raises(InputError, match="cannot be read"):
        read_films(tmp_path / "missing.json")
