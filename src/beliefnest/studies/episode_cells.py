"""Plan of a study of episodes: its cells."""

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, ClassVar

import msgspec
from msgspec.structs import replace

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.choosing import check_played
from beliefnest.episodes.episode import Episode, play_through
from beliefnest.episodes.policies import (
    draws_by_seed,
    is_program,
    resolve_policy,
    text_of_policy,
)
from beliefnest.episodes.task import Task
from beliefnest.errors import BeliefNestError, InputError, MissingExtraError, ModelError
from beliefnest.plan.cells import (
    Invalid,
    Key,
    Plan,
    alike,
    cell_seed,
    digest,
    variation_id,
)
from beliefnest.plan.draws import may_draw, script_draws
from beliefnest.plan.terms import PlayStage
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.loading import condition_numbers
from beliefnest.studies.cells import check_called
from beliefnest.studies.episode_design import EpisodeDesign, Player
from beliefnest.studies.variation import Variation, listed_variations
from beliefnest.world.texts import quoted


@dataclass(frozen=True, slots=True)
class EpisodeKey(Key):
    """Identity of a cell.

    Attributes:
        task: Name of the task.
        content: Hash of the instance and of the files that define policies.
        condition: Number of a scenario's condition; None: the scenario as written.
        variation: Values of parameters.
        player: Name of the player in the table.
        order: The player's order of Theory of Mind, as text; empty: part of `player`.
        policies: Names of the policies that the study gives, by agent.
        instance: Number of the instance of a built-in task.
        repeat: Number of the repeat, from 1.
        setting: Further settings that affect results.
    """

    task: str
    content: str
    condition: int | None
    variation: Mapping[str, Any]
    player: str
    order: str
    policies: Mapping[str, str]
    instance: int
    repeat: int
    setting: Mapping[str, Any]

    @property
    def seed(self) -> int:
        """Return the seed of all random numbers of the cell.

        The seed depends on variation, instance and repeat, but not on player and condition. The
        first repeat of an instance without variation has the instance's number as seed, as with
        `beliefnest play --seed`.
        """
        if self.variation:
            return cell_seed(self.task, dict(self.variation), self.instance, self.repeat)
        return self.instance if self.repeat == 1 else cell_seed(self.instance, self.repeat)


class EpisodeCell(msgspec.Struct, frozen=True):
    """Instance of a task, to be played once by a player.

    Attributes:
        key: Identity of the cell.
        task: The instance.
        draws: True if the episode draws random numbers from its seed.
    """

    key: EpisodeKey
    task: Task
    draws: bool
    world: ClassVar[str] = ""
    is_quick: ClassVar[bool] = False

    def plain(self) -> dict[str, Any]:
        """Return the cell as plain values for the study's plan."""
        key = self.key
        # Without instances, all seeds give the same task.
        has_instances = self.task.seed is not None
        seeds = ("repeat",) if has_instances else ("repeat", "instance")
        instance = key.instance if has_instances else None
        return {
            "name": key.name,
            "key": key.content_json(),
            "seed": key.seed,
            "variation": variation_id(key.task, dict(key.variation), instance),
            "alike": None if self.draws else alike(key, seeds),
        }

    def play(self, stage: PlayStage) -> dict[str, Any]:
        """Play the episode, and return its result as plain values.

        Raises:
            ModelError: A model could not be asked, or the limits of the study are reached. An
                answer without a program is no error: it loses the round.
        """
        key, terms = self.key, stage.terms
        connection = terms.connection()
        policies: dict[str, Policy] = {}
        names = {**self.task.form.policies, **key.policies}
        for agent, name in names.items():
            policies[agent] = resolve_policy(name, terms.surroundings, connection)
        store = terms.store(key.name)
        with Episode(
            self.task,
            policies,
            world=key.setting["world"],
            store=store,
            seed=key.seed,
            worlds=stage.worlds,
            names=names,
        ) as episode:

            def stop_at_error(*_: object) -> None:
                for error in episode.model_errors:
                    raise error

            measure_help = bool(key.setting.get("help"))
            play_through(episode, stop_at_error, rounds=None, measure_help=measure_help)
            return {
                "error": None,
                "run": "" if store is None else f"runs/{store.name}",
                "goal": [list(each) for each in episode.conditions],
                "why_not": episode.why_not,
                "measures": episode.measures.row(),
            }


def plan_episodes(design: EpisodeDesign) -> Plan[EpisodeCell]:
    """Return the plan of a study of episodes.

    Cells are ordered by repeat and then by instance, so an interrupted study has played a smaller
    study of the same design.

    Raises:
        UnknownNameError: A task does not exist.
        ScenarioError: A task's file is wrong.
        InputError: A policy's file cannot be read.
    """
    texts = {
        player.text: [text_of_policy(name) for name in _names(player)] for player in design.players
    }
    planned: list[EpisodeCell | Invalid] = []
    called: dict[str, str] = {}
    for name in design.tasks:
        document = Task.scenario_document(name)
        there = (None,) if document is None else condition_numbers(document)
        chosen = there if there == (None,) else design.conditions or there
        for condition, variation in itertools.product(chosen, listed_variations(design.variations)):
            place = _Place(name, document, condition, variation)
            if condition in there:
                # An error without any variation is an error of the file, not an invalid cell.
                replace(place, variation=Variation()).task(design.seeds[0])
            try:
                tasks = {seed: place.task(seed) for seed in design.seeds}
            except MissingExtraError:
                raise
            except BeliefNestError as error:
                planned.append(place.invalid(str(error)))
                continue
            check_called(called, tasks[design.seeds[0]].name, name)
            planned += _cells(design, place, tasks, texts)
    cells = [each for each in planned if isinstance(each, EpisodeCell)]
    seeds = {seed: number for number, seed in enumerate(design.seeds)}
    cells.sort(key=lambda cell: (cell.key.repeat, seeds[cell.key.instance]))
    return Plan(tuple(cells), tuple(each for each in planned if isinstance(each, Invalid)))


class _Place(msgspec.Struct, frozen=True):
    """Place of cells in a study, without player, instance and repeat.

    Attributes:
        name: Name, or path, of a task or scenario.
        document: Document of the scenario; None: a task.
        condition: Number of the scenario's condition; None: the scenario as written.
        variation: Values of parameters.
    """

    name: str
    document: Document | None
    condition: int | None
    variation: Variation

    def task(self, seed: int) -> Task:
        """Return an instance."""
        if self.document is None:
            return Task.load(self.name, seed, **self.variation.values)
        varied = self.variation
        change = varied.change
        return Task.instance_of(self.document, seed, self.condition, varied.parameters, change)

    def invalid(self, why: str) -> Invalid:
        """Return an entry that says why this place makes no episode."""
        return Invalid(self.name, self.condition, self.variation.values, why)


def task_of_cell(key: EpisodeKey, name: str, document: Document | None) -> Task:
    """Return the instance that a recorded key names.

    Args:
        key: The key.
        name: Name of the task, or path of its file.
        document: Document of the scenario; None: a task.

    Raises:
        BeliefNestError: They make no task.
    """
    return _Place(name, document, key.condition, Variation(key.variation)).task(key.instance)


def _cells(
    design: EpisodeDesign, place: _Place, tasks: Mapping[int, Task], texts: Mapping[str, list[str]]
) -> Iterator[EpisodeCell | Invalid]:
    instances = {seed: digest(task.plain()) for seed, task in tasks.items()}
    for player in design.players:
        policies = _policies(tasks[design.seeds[0]], player)
        has_program = any(is_program(name) and text_of_policy(name) for name in policies.values())
        strange = sorted(policies.keys() - set(tasks[design.seeds[0]].agents))
        if strange:
            why = f"{place.name} has no agent {quoted(strange[0])} for the policies {player.text}"
            yield place.invalid(why)
            continue
        try:
            check_played(tasks[design.seeds[0]], policies)
        except InputError as error:
            yield place.invalid(str(error))
            continue
        if place.document is not None and place.variation.change is not None and has_program:
            why = f"programs of files are not moved or renamed with the scene: {player.text}"
            yield place.invalid(why)
            continue
        for seed, repeat in itertools.product(design.seeds, range(1, design.repeats + 1)):
            key = EpisodeKey(
                task=tasks[seed].name,
                content=digest([instances[seed], texts[player.text]])[:16],
                condition=place.condition,
                variation=place.variation.values,
                player=player.name,
                order="" if player.order is None else str(player.order),
                policies=policies,
                instance=seed,
                repeat=repeat,
                setting=design.setting,
            )
            draws = _episode_draws(tasks[seed], policies, texts[player.text])
            yield EpisodeCell(key, tasks[seed], draws)


def _policies(task: Task, player: Player) -> dict[str, str]:
    if isinstance(player.policies, str):
        return dict.fromkeys(task.players, player.policies)
    return dict(player.policies)


def check_player(player: Player) -> None:
    """Raise UnknownNameError if a policy of a player does not exist."""
    for name in _names(player):
        # Machines of a cluster may have keys that this machine does not have.
        with suppress(ModelError):
            resolve_policy(name)


def _names(player: Player) -> Sequence[str]:
    policies = player.policies
    return [policies] if isinstance(policies, str) else list(policies.values())


def _episode_draws(task: Task, policies: Mapping[str, str], texts: Iterable[str]) -> bool:
    """Return True if an episode draws random numbers, apart from its instance and the world.

    Args:
        task: Instance of the task; its own policies play agents that `policies` does not name.
        policies: Names of policies by agent.
        texts: Texts of the files that define these policies.
    """
    names = {**task.form.policies, **policies}.values()
    return (
        any(draws_by_seed(name) for name in names)
        or any(may_draw(text) for text in texts)
        or script_draws(task.scenario)
    )
