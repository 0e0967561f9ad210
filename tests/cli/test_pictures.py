"""Pictures of runs: nothing overlaps, is cut off or is empty, in any built-in scenario."""

from collections.abc import Iterator

import pytest
from tests.pictures.measuring import faults, texts

from beliefnest.cli.pictures import read_condition
from beliefnest.llm.offline.model import OfflineModel
from beliefnest.nest.face.nest import Nest
from beliefnest.pictures.figure import figure_of
from beliefnest.pictures.marks import Circle
from beliefnest.pictures.overview import Condition, overview
from beliefnest.pictures.palette import agent_looks
from beliefnest.pictures.scene import Scene
from beliefnest.scenarios import Scenario
from beliefnest.scenarios.running import run_scenario
from beliefnest.timeline.store import SqliteJournal

BUILT_IN = ("sally-anne", "ice-cream-van", "help-sally")
SIZES = (None, "one column", "two columns")


@pytest.fixture(scope="module", params=BUILT_IN)
def drawn(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[list[Condition], list[Scene]]]:
    """The conditions of a scenario, and all beliefs that it names."""
    conditions, scenes = [], []
    for number, scenario in enumerate(Scenario.load_all(request.param)):
        store = tmp_path_factory.mktemp("run") / f"{number}.bn"
        with Nest.open(scenario, store=store) as nest:
            outcome = run_scenario(nest, scenario, OfflineModel(), 0, 0.0, lambda *_: None)
            with SqliteJournal.read(store) as journal:
                conditions.append(read_condition(nest, journal, outcome))
            tick = outcome.reality.tick
            scenes += nest.scenes(["/", *outcome.beliefs], tick)
    yield conditions, scenes


@pytest.mark.parametrize("size", SIZES)
def test_nothing_overlaps_is_cut_off_or_empty(
    drawn: tuple[list[Condition], list[Scene]], size: object
) -> None:
    conditions, scenes = drawn
    figures = [overview(conditions, "title"), *(overview([each], "title") for each in conditions)]
    figures += [figure_of(scenes), figure_of(scenes[:1])]
    for figure in figures:
        drawing = figure.drawing(size)  # type: ignore[arg-type]
        assert faults(drawing) == []
        looks = agent_looks(scenes[0].agents).values()
        fills = {mark.fill for mark in drawing.marks if isinstance(mark, Circle)}
        assert fills & {look.colour for look in looks}


def test_every_prediction_says_of_which_probe_it_is_and_maps_are_of_the_cards_tick(
    drawn: tuple[list[Condition], list[Scene]],
) -> None:
    conditions, _ = drawn
    for condition in conditions:
        said = texts(overview([condition], "title").drawing())
        predictions = [card for card in condition.cards if card.prediction]
        assert predictions
        for card in predictions:
            assert card.title in said
            assert card.path in said
        assert f"the real world at tick {condition.scene.tick}, after the script" in said


def test_the_van_has_its_three_predictions_at_places_with_names(
    drawn: tuple[list[Condition], list[Scene]],
) -> None:
    condition = drawn[0][0]
    if condition.title != "ice-cream-van, condition 1":
        pytest.skip("another scenario")
    said = texts(overview([condition], "title").drawing())
    for words in ("Probe: third order", "Probe: second order", "Probe: reality"):
        assert words in said
    assert any(words.startswith("Mary ends at A") for words in said)
    assert condition.scene.places == (("A", (4, 1, 4)), ("B", (20, 1, 16)))
