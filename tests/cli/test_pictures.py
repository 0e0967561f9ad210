"""Pictures of runs: nothing overlaps, is cut off or is empty, in any built-in scenario."""

from collections.abc import Iterator

import pytest
from tests.pictures.measuring import faults, texts
from tests.profiles import few_by_day
from tests.shared_worlds import Lent

from beliefnest.cli.run_cells import read_condition
from beliefnest.llm.offline.offline_model import OfflineModel
from beliefnest.nest.face.nest import Nest
from beliefnest.pictures.figure import figure_of
from beliefnest.pictures.marks import Circle, Rectangle, Text
from beliefnest.pictures.overview import ConditionPicture, overview
from beliefnest.pictures.palette import Mark, agent_looks
from beliefnest.pictures.scene import Scene
from beliefnest.scenarios.running import run_scenario
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import builtin_names
from beliefnest.timeline.store import Journal

BUILT_IN = builtin_names()
SIZES = (None, "one column", "two columns")


@pytest.fixture(scope="module", params=BUILT_IN)
def drawn(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, lent: Lent
) -> Iterator[tuple[list[ConditionPicture], list[Scene]]]:
    """Yield the conditions of a scenario, and all beliefs that it names."""
    conditions, scenes = [], []
    with lent(0) as worlds:
        for number, scenario in enumerate(Scenario.load_all(request.param)):
            store = tmp_path_factory.mktemp("run") / f"{number}.bn"
            with Nest.open(scenario, store=store, worlds=worlds) as nest:
                outcome = run_scenario(nest, scenario, OfflineModel(), 0, 0.0, lambda *_: None)
                with Journal.read(store) as journal:
                    conditions.append(read_condition(nest, journal, outcome))
                predicted = any(card.prediction for card in conditions[-1].cards)
                assert predicted == bool(scenario.probes)
                tick = outcome.reality.tick
                scenes += nest.scenes(["/", *outcome.beliefs], tick)
    yield conditions, scenes


@pytest.mark.parametrize("size", few_by_day(SIZES))
def test_nothing_overlaps_is_cut_off_or_empty(
    drawn: tuple[list[ConditionPicture], list[Scene]], size: object
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
    drawn: tuple[list[ConditionPicture], list[Scene]],
) -> None:
    conditions, _ = drawn
    for condition in conditions:
        said = texts(overview([condition], "title").drawing())
        for card in [card for card in condition.cards if card.prediction]:
            assert card.title in said
            assert card.path in said
        assert f"the real world at tick {condition.scene.tick}, after the script" in said


def test_the_van_has_its_three_predictions_at_places_with_names(
    drawn: tuple[list[ConditionPicture], list[Scene]],
) -> None:
    condition = drawn[0][0]
    if condition.title != "ice-cream-van, condition 1":
        return
    said = texts(overview([condition], "title").drawing())
    for words in ("Probe: third order", "Probe: second order", "Probe: reality"):
        assert words in said
    assert any(words.startswith("Mary ends at A") for words in said)
    assert condition.scene.places == (("A", (4, 1, 4)), ("B", (20, 1, 16)))


def test_cards_mark_what_is_false(drawn: tuple[list[ConditionPicture], list[Scene]]) -> None:
    conditions, all_scenes = drawn
    starts = [number for number, scene in enumerate(all_scenes) if scene.path == "/"]
    for condition, start in zip(conditions, starts, strict=True):
        scenes = all_scenes[start:]
        reality, *beliefs = (card for card in condition.cards if not card.prediction)
        assert not any(store.mark is Mark.FALSE for store in reality.stores)
        assert not any(note.false for note in reality.notes)
        for card in beliefs:
            scene = next(each for each in scenes if each.path == card.path)
            false = [store.label for store in scene.stores if store.mark is Mark.FALSE]
            assert [store.label for store in card.stores if store.mark is Mark.FALSE] == false
            if false:
                assert "false" in texts(overview([condition], "title").drawing())


def test_the_same_beliefs_and_probes_of_conditions_are_level(
    drawn: tuple[list[ConditionPicture], list[Scene]],
) -> None:
    conditions, _ = drawn
    drawing = overview(conditions, "title").drawing(85.0 * len(conditions))
    tops: dict[str, set[float]] = {}
    cards = [m for m in drawing.having("card") if isinstance(m, Rectangle)]
    for card in cards:
        title = next(
            mark
            for mark in drawing.having("text")
            if isinstance(mark, Text)
            and card.x <= mark.bounds[0] <= card.x + card.width
            and card.y <= mark.bounds[1] <= card.y + card.height
        )
        tops.setdefault(title.text, set()).add(card.y)
    assert all(len(each) == 1 for each in tops.values()), tops
