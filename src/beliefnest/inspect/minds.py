"""Tasks about minds: a course in words, ratings of desires and beliefs, exact inference."""

import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from anyio.to_thread import run_sync
from inspect_ai import Task
from inspect_ai.dataset import Sample
from inspect_ai.model import ChatMessageUser
from inspect_ai.scorer import Score, Scorer, scorer
from inspect_ai.solver import Generate, Solver, TaskState, solver

from beliefnest.errors import InputError
from beliefnest.inspect.metrics import (
    CLUSTER,
    beliefs_r,
    desires_r,
    mean_of_epochs,
    not_answered,
    rated,
    stderr_of_epochs,
)
from beliefnest.inspect.task_parts import answer_scorer, several_files, task_of
from beliefnest.llm.messages import Finish
from beliefnest.llm.reading_numbers import NumbersReading
from beliefnest.nest.face.nest import Nest
from beliefnest.plan.cells import variation_id
from beliefnest.scenarios.inferring import Inferred, Inferring
from beliefnest.scenarios.scenario import Scenario
from beliefnest.studies.probe_orders import order_of
from beliefnest.suites.films.film import Film, FilmParameters
from beliefnest.suites.films.film_files import read_films
from beliefnest.suites.films.film_inference import model_of, staged
from beliefnest.suites.films.rating import (
    Comparison,
    compared,
    rating_prompt,
    ratings_in,
    read_ratings,
)
from beliefnest.worlds.by_name import Worlds


def minds_task(
    scenarios: str | list[str], *, conditions: int | list[int] | None, world: str, seed: int
) -> Task:
    """Return the task of the probes of scenarios that infer; each is a sample.

    Args:
        scenarios: Names of built-in scenarios, or paths of files.
        conditions: Numbers of conditions; None for all.
        world: Name of the world.
        seed: Seed of the world.

    Raises:
        BeliefNestError: There is no such scenario, or no probe infers.
    """
    names = several_files(scenarios)
    samples = [each for name in names for each in _samples(name, conditions, world, seed)]
    if not samples:
        listed_names = ", ".join(names)
        raise InputError(f"{listed_names} has no probes with infer; give a scenario that infers")
    about = ", ".join(dict.fromkeys(str((each.metadata or {})["name"]) for each in samples))
    return task_of(f"minds of {about}", samples, like_inference(), course_in_words())


def _samples(
    scenario: str, conditions: int | list[int] | None, world: str, seed: int
) -> list[Sample]:
    if conditions is None:
        loaded: tuple[Scenario, ...] = Scenario.load_all(scenario)
    else:
        numbers = [conditions] if isinstance(conditions, int) else conditions
        loaded = tuple(Scenario.load(scenario, number) for number in numbers)
    return [
        Sample(
            input=probe.asked,
            target="",
            id=f"{scenario}-{each.condition or 0}-{number}",
            metadata={
                "scenario": scenario,
                "name": each.name,
                "condition": each.condition,
                "probe": number,
                "world": world,
                "seed": seed,
                "label": probe.label,
                "path": probe.path,
                "order": order_of(probe.path, None),
                CLUSTER: variation_id(each.name, each.condition),
            },
        )
        for each in loaded
        for number, probe in enumerate(each.probes)
        if not probe.asks_model
    ]


def films_task(file: str | list[str], limit: int | None) -> Task:
    """Return the task of files of films; each film is a sample.

    Args:
        file: Files of films, as `beliefnest suite food-trucks` takes them.
        limit: Greatest number of films of each file; None for all.

    Raises:
        InputError: There is no such file, or it is of another form.
    """
    files = several_files(file)
    samples = [
        Sample(
            input=f"film {film.name}",
            target="",
            id=film.name if len(files) == 1 else f"{Path(each).stem}-{film.name}",
            metadata={
                "file": str(Path(each).absolute()),
                "film": film.name,
                "group": film.group,
                CLUSTER: variation_id(str(Path(each).stem), film.name),
            },
        )
        for each in files
        for film in read_films(each)[0][:limit]
    ]
    return task_of("films", samples, like_inference(), course_in_words())


class _Courses:
    """Plays the courses of samples, one at a time, in worlds that stay open."""

    def __init__(self) -> None:
        self._turn = threading.Lock()
        self._worlds = Worlds(0)
        self._films: dict[str, tuple[dict[str, Film], FilmParameters]] = {}

    def prompt(self, sample: Mapping[str, Any]) -> str:
        """Return the course of a sample in words, with the questions."""
        with self._played(sample) as (nest, path, infer):
            return rating_prompt(nest, path, infer)

    def compared(
        self, sample: Mapping[str, Any], answer: str, finish: Finish
    ) -> tuple[NumbersReading, Comparison]:
        """Return the ratings in an answer, also beside exact inference."""
        with self._played(sample) as (nest, path, infer):
            inference = nest[path].infer(
                infer.model,
                since=infer.since,
                until=infer.until,
                ended=infer.ended,
                smooth=infer.smooth,
            )
            reading = read_ratings(answer, infer.model, finish)
            ratings = ratings_in(reading, infer.model)
            return reading, compared(ratings, infer.model, Inferred.of(inference))

    @contextmanager
    def _played(self, sample: Mapping[str, Any]) -> Iterator[tuple[Nest, str, Inferring]]:
        with self._turn:
            if "film" in sample:
                film, parameters = self._film(sample["file"], sample["film"])
                model = model_of(film, parameters)
                with staged(film) as nest:
                    where = f"film {film.name}"
                    yield nest, "/", Inferring(model, 0, None, film.ended, False, where)
                return
            scenario = Scenario.load(sample["scenario"], sample["condition"])
            probe = scenario.probes[sample["probe"]]
            assert probe.infer is not None
            world, seed = sample["world"], sample["seed"]
            with Nest.open(scenario, world, None, seed, self._worlds) as nest:
                nest.play()
                yield nest, probe.path, probe.infer

    def _film(self, file: str, name: str) -> tuple[Film, FilmParameters]:
        if file not in self._films:
            films, parameters = read_films(file)
            self._films[file] = {film.name: film for film in films}, parameters
        by_name, parameters = self._films[file]
        return by_name[name], parameters


@solver
def course_in_words() -> Solver:
    """Replace the messages by the course as the observer saw it, and the questions."""
    courses = _Courses()

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        state.messages = [ChatMessageUser(content=await run_sync(courses.prompt, state.metadata))]
        return state

    return solve


@scorer(
    metrics=[
        mean_of_epochs(),
        stderr_of_epochs(),
        rated(),
        not_answered(),
        desires_r(),
        beliefs_r(),
    ]
)
def like_inference() -> Scorer:
    """Score 1 less the mean absolute error of the ratings against exact inference."""
    courses = _Courses()

    async def score(state: TaskState, answer: str, finish: Finish) -> Score:
        reading, match = await run_sync(courses.compared, state.metadata, answer, finish)
        lines = [f"{about}: {_pairs_text(pairs)}" for about, pairs in match.pairs.items()]
        outcome = "rated" if reading.outcome == "read" else reading.row_outcome
        if reading.reason:
            lines = [f"{outcome}: {reading.reason}"]
        return Score(
            value=1 - match.error,
            answer=answer,
            explanation="\n".join(lines),
            metadata={
                "outcome": outcome,
                "error": match.error,
                **{about: [list(pair) for pair in pairs] for about, pairs in match.pairs.items()},
            },
        )

    return answer_scorer(score)


def _pairs_text(pairs: Any) -> str:
    return ", ".join(f"{rated:.2f} (inferred {inferred:.2f})" for inferred, rated in pairs)
