"""The cells of a study of episodes."""

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from beliefnest.episodes.policies import resolve_policy, text_of_policy
from beliefnest.episodes.task import Task
from beliefnest.errors import BeliefNestError, MissingExtraError, ModelError
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.loading import condition_numbers
from beliefnest.scenarios.scenario import Scenario
from beliefnest.studies.chance import episode_draws
from beliefnest.studies.episode_design import EpisodeDesign, Player
from beliefnest.studies.plan import (
    Invalid,
    Plan,
    alike,
    cell_seed,
    check_called,
    digest,
    variation_id,
)
from beliefnest.studies.variation import Variation, listed_variations

__all__ = ["EpisodeCell", "EpisodeKey", "plan_episodes"]


@dataclass(frozen=True, slots=True)
class EpisodeKey:
    """What tells a cell from all others.

    Attributes:
        task: Name of the task.
        content: A hash of the instance, and of the files that policies are read from.
        condition: Number of a scenario's condition; None: as written.
        variation: Values of parameters.
        player: What stands in the table for who plays.
        order: Its order of Theory of Mind, as text; empty: `player` says all.
        policies: By agent, who plays it, of those that the study names.
        instance: Which instance of a built-in task.
        repeat: Number of the repeat, from 1.
        setting: What else decides about results.
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
    def name(self) -> str:
        """Sixteen letters and digits, the same for the same cell on every machine."""
        return digest(self.content_json())[:16]

    def content_json(self) -> dict[str, Any]:
        """Return all of it as plain values."""
        return {
            "task": self.task,
            "content": self.content,
            "condition": self.condition,
            "variation": dict(self.variation),
            "player": self.player,
            "order": self.order,
            "policies": dict(self.policies),
            "instance": self.instance,
            "repeat": self.repeat,
            "setting": dict(self.setting),
        }

    @property
    def seed(self) -> int:
        """Drives every random number of the cell.

        Of one repeat of one instance of one variation all players and conditions have the same.
        An instance as written has its own number, as with `beliefnest play --seed`.
        """
        if self.variation:
            return cell_seed(self.task, dict(self.variation), self.instance, self.repeat)
        return self.instance if self.repeat == 1 else cell_seed(self.instance, self.repeat)


@dataclass(frozen=True)
class EpisodeCell:
    """An instance of a task, to be played by somebody once.

    Attributes:
        key: What tells it from all others.
        task: The instance.
        draws: Whether anything in the episode is drawn by its seed.
    """

    key: EpisodeKey
    task: Task
    draws: bool

    def plain(self) -> dict[str, Any]:
        """What a study's plan says of it."""
        key = self.key
        # What is read from a file has no instances: every one of them is the same.
        from_file = self.task.seed is None
        seeds = ("repeat", "instance") if from_file else ("repeat",)
        instance = None if from_file else key.instance
        return {
            "name": key.name,
            "key": key.content_json(),
            "seed": key.seed,
            "variation": variation_id(key.task, dict(key.variation), instance),
            "alike": None if self.draws else alike(key, seeds),
        }


def plan_episodes(design: EpisodeDesign) -> Plan[EpisodeCell]:
    """The plan of a study of episodes; what is done first is a smaller study of the same form.

    Raises:
        UnknownNameError: There is no such task or policy.
        ScenarioError: A task's file is wrong.
        InputError: A policy's file cannot be read.
    """
    texts = {player.text: _texts(player) for player in design.players}
    found: list[EpisodeCell | Invalid] = []
    called: dict[str, str] = {}
    for name in design.tasks:
        document = Task.scenario_document(name)
        there = (None,) if document is None else condition_numbers(document)
        chosen = there if there == (None,) else design.conditions or there
        for condition, variation in itertools.product(chosen, listed_variations(design.variations)):
            place = _Place(name, document, condition, variation)
            if condition in there:
                # As it is written it has to be right: a fault in it is no matter of a variation.
                replace(place, variation=Variation()).task(design.seeds[0])
            try:
                tasks = {seed: place.task(seed) for seed in design.seeds}
            except MissingExtraError:
                raise
            except BeliefNestError as error:
                found.append(place.invalid(str(error)))
                continue
            check_called(called, tasks[design.seeds[0]].name, name)
            found += _cells(design, place, tasks, texts)
    cells = [each for each in found if isinstance(each, EpisodeCell)]
    seeds = {seed: number for number, seed in enumerate(design.seeds)}
    cells.sort(key=lambda cell: (cell.key.repeat, seeds[cell.key.instance]))
    return Plan(tuple(cells), tuple(each for each in found if isinstance(each, Invalid)))


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a cell stands in a study, but for who plays, and which instance and repeat it is.

    Attributes:
        name: Name, or path, of a task or scenario.
        document: What is written in the scenario; None: it is a task.
        condition: Number of the scenario's condition; None: as written.
        variation: What varies.
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
        scene = varied.scene if varied.changes_scene else None
        return Task.of(Scenario.varied(self.document, self.condition, varied.parameters, scene))

    def invalid(self, why: str) -> Invalid:
        """It makes no episode."""
        return Invalid(self.name, self.condition, self.variation.values, why)


def _cells(
    design: EpisodeDesign, place: _Place, tasks: Mapping[int, Task], texts: Mapping[str, list[str]]
) -> Iterator[EpisodeCell | Invalid]:
    instances = {seed: digest(task.plain()) for seed, task in tasks.items()}
    for player in design.players:
        policies = _policies(tasks[design.seeds[0]], player)
        strange = sorted(policies.keys() - set(tasks[design.seeds[0]].agents))
        if strange:
            why = f"{place.name} has no agent {strange[0]!r} for the policies {player.text}"
            yield place.invalid(why)
            continue
        if place.document is not None and place.variation.changes_scene and any(texts[player.text]):
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
            draws = episode_draws(tasks[seed], policies, texts[player.text])
            yield EpisodeCell(key, tasks[seed], draws)


def _policies(task: Task, player: Player) -> dict[str, str]:
    if isinstance(player.policies, str):
        return dict.fromkeys(task.players, player.policies)
    return dict(player.policies)


def _texts(player: Player) -> list[str]:
    """What the policies of a player are read from; that there is no such policy is told here."""
    policies = player.policies
    names = [policies] if isinstance(policies, str) else list(policies.values())
    for name in names:
        try:
            resolve_policy(name)
        except ModelError:
            # The machines of a cluster may have keys that this one has not.
            continue
    return [text_of_policy(name) for name in names]
