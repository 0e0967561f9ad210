"""Playing of items without any model: films and stories, and the right answers."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import msgspec

from beliefnest.errors import InputError, ProgramError, ScenarioError
from beliefnest.facts.states import StateFacts
from beliefnest.nest.face.nest import Nest
from beliefnest.prompts import Renderer
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.outcome import ExpectationOutcome
from beliefnest.scenarios.probing import resolved
from beliefnest.scenarios.records import expectation_json
from beliefnest.scenarios.right_answers_check import warn_of_answers, warn_of_scene
from beliefnest.studies.participants.film import SceneFilm, read_film
from beliefnest.studies.participants.items import Item
from beliefnest.studies.variation import Variation
from beliefnest.worlds.by_name import Worlds

OnItem = Callable[[str, int, int], None]
"""Function of a description, the number of items done, and of all items."""

STORY = "{{ branch | beginning }}\n\n{{ branch | story }}"
"""Text that the built-in template `story` shows to models, without the question."""


class ParticipantView(msgspec.Struct, frozen=True):
    """View of one simulator, as participants get it.

    Attributes:
        path: Belief path of the simulator.
        owner: Name of its owner; None: a narrator tells what happened.
        story: Paragraphs; empty: no story is shown.
        film: The film; None: no film is shown.
    """

    path: str
    owner: str | None
    story: tuple[str, ...]
    film: SceneFilm | None


class Judged(msgspec.Struct, frozen=True):
    """Right answers and results of an item, by which answers are judged.

    Attributes:
        probes: Probes of the scenario, with their right answers.
        expectations: Results of the scenario's expectations, as plain values.
        ticks: Length of the script.
    """

    probes: tuple[Probe, ...]
    expectations: tuple[Mapping[str, Any], ...]
    ticks: int


def shown_items(
    items: Sequence[Item], shown: str, on_item: OnItem
) -> Iterator[tuple[Item, list[ParticipantView]]]:
    """Play items and yield what participants see of each.

    Args:
        items: The items.
        shown: `film`, `story` or `both`.
        on_item: Function that receives the progress.

    Raises:
        BeliefNestError: A script failed; the message names the cell.
    """
    for item, nest, start in played_items(items, on_item):
        yield item, [view_of(nest, path, start, shown) for path in item.paths]


def judged_items(items: Sequence[Item], on_item: OnItem) -> Iterator[tuple[Item, Judged]]:
    """Play items and yield the right answers of each; arguments and errors as `shown_items`."""
    for item, nest, _ in played_items(items, on_item):
        yield item, _judged(nest, item)


def played_items(
    items: Sequence[Item], on_item: OnItem, world: str | None = None
) -> Iterator[tuple[Item, Nest, int]]:
    """Play items; yield each with its nest, which is open until the next item, and first tick.

    Args:
        items: The items.
        on_item: Function that receives the progress.
        world: Name of the world; None: that of the study.

    Raises:
        BeliefNestError: A script failed; the message names the cell.
    """
    with Worlds(0) as worlds:
        renderer = Renderer()
        for number, item in enumerate(items):
            on_item(_title(item), number, len(items))
            with _played(item, world or item.cell.key.setting["world"], worlds, renderer) as (
                nest,
                start,
            ):
                yield item, nest, start


def _title(item: Item) -> str:
    """Return scenario, condition and variation of an item."""
    key = item.cell.key
    condition = [] if key.condition is None else [f"condition {key.condition}"]
    return ", ".join([key.scenario, *condition, Variation(key.variation).text])


@contextmanager
def _played(
    item: Item, world: str, worlds: Worlds, renderer: Renderer
) -> Iterator[tuple[Nest, int]]:
    """Play the script of an item; give its nest and its first tick."""
    key, scenario = item.cell.key, item.cell.scenario
    try:
        with Nest.open(scenario, world, None, key.seed, worlds, renderer=renderer) as nest:
            start = nest.tick
            warn_of_scene(scenario)
            nest.play()
            warn_of_answers(nest, scenario)
            yield nest, start
    except (ProgramError, ScenarioError) as error:
        raise type(error)(f"{_title(item)}: {error}") from error


def view_of(nest: Nest, path: str, start: int, shown: str) -> ParticipantView:
    """Return what participants see of a simulator: `film`, `story` or `both` since a tick."""
    simulator = nest[path]
    story = simulator.render(STORY) if shown in ("story", "both") else ""
    return ParticipantView(
        path=path,
        owner=simulator.owner,
        story=tuple(part.strip() for part in story.split("\n\n") if part.strip()),
        film=read_film(nest, path, start) if shown in ("film", "both") else None,
    )


def _judged(nest: Nest, item: Item) -> Judged:
    scenario = item.cell.scenario
    expectations = [
        ExpectationOutcome(each, each.fact.instead(StateFacts(nest[each.simulator].state)))
        for each in scenario.expectations
    ]
    return Judged(
        probes=tuple(resolved(nest, probe) for probe in scenario.probes),
        expectations=tuple(expectation_json(each) for each in expectations),
        ticks=nest.tick,
    )


def refuse_claims(setting: Mapping[str, Any]) -> None:
    """Raise InputError if a model would have to read claims out of utterances."""
    if "claims_from" in setting:
        raise InputError(
            "the study reads claims with a model (`claims_from`), and its scripts are played here "
            "without any model; leave it out"
        )
