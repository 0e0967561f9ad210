"""Families of functional items, and their siblings: instances that look the same to an agent."""

from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.episodes.agent_view import AgentView
from beliefnest.episodes.task import Task
from beliefnest.episodes.trials import Trials
from beliefnest.errors import InputError
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.instances import drawn_instance, has_instances
from beliefnest.scenarios.loading import condition_numbers
from beliefnest.scenarios.parameters import choices, declared_in
from beliefnest.scenarios.scenario import Scenario
from beliefnest.studies.episode_design import EpisodeDesign
from beliefnest.world.texts import quoted


class TaskFamily(msgspec.Struct, frozen=True):
    """A task file under one condition.

    Attributes:
        name: Name or path of the file.
        document: Its document.
        condition: Number of the condition; None: the scenario as written.
    """

    name: str
    document: Document
    condition: int | None

    @property
    def folder(self) -> str:
        """Return a name for the folder of its episodes."""
        return f"{Path(self.name).stem}-{self.condition or 0}"

    def instance(self, seed: int) -> Task:
        """Return the instance of a seed."""
        return Task.instance_of(self.document, seed, self.condition, {})

    def values(self, seed: int) -> dict[str, Any]:
        """Return the values that an instance draws."""
        return drawn_instance(self.document, seed, {})

    def siblings(self, seed: int, name: str) -> tuple[Task, ...]:
        """Return the instances that differ from one in a parameter alone, itself first."""
        drawn = self.values(seed)
        others = [value for value in self.choices(name) if value != drawn[name]]
        every = ({**drawn, name: value} for value in (drawn[name], *others))
        return tuple(
            Task.of(Scenario.varied(self.document, self.condition, values)) for values in every
        )

    def choices(self, name: str) -> list[Any]:
        """Return the values that a parameter may have; empty: too many to list."""
        return list(choices(declared_in(self.document)[name]) or ())

    def hidden(self, seed: int, order: int) -> str:
        """Return the parameter whose values an agent of one order less cannot tell apart.

        Returns:
            Of such parameters that are drawn the one with the fewest values; empty: there is none.
        """
        names = sorted(self.values(seed), key=lambda name: len(self.choices(name)))
        for name in names:
            first, *others = self.siblings(seed, name)
            seen = _seen(first, order - 1)
            if others and all(_seen(each, order - 1) == seen for each in others):
                return name
        return ""


def families_of(design: EpisodeDesign) -> list[TaskFamily]:
    """Return the families of a study of episodes: each file under each of its conditions.

    Raises:
        InputError: A task has no random instances, or is of an order that the study does not name,
            or the study names an order of no task.
    """
    families: list[TaskFamily] = []
    orders: set[object] = {"omniscient"}
    for name in design.tasks:
        document = Task.scenario_document(name)
        if document is None or not has_instances(document):
            raise InputError(
                f"{name} has no `instances`; give a scenario file with `episode` and `instances`"
            )
        there = condition_numbers(document)
        for condition in there if there == (None,) else design.conditions or there:
            family = TaskFamily(name, document, condition)
            order = family.instance(design.seeds[0]).order
            if design.orders and order not in design.orders:
                named = ", ".join(map(str, design.orders))
                raise InputError(
                    f"condition {condition or 0} of {name} is of order {order}, and `orders` has "
                    f"{named}; add the order, or choose other `conditions`"
                )
            families.append(family)
            orders.add(order)
    for unused in set(design.orders) - orders:
        raise InputError(
            f"`orders` has {unused}, and no condition that is played is of this order; leave it "
            "out, or add a condition"
        )
    return families


def check_functional(design: object, name: str) -> EpisodeDesign:
    """Return a design as one of episodes.

    Raises:
        InputError: It is a study of scenarios.
    """
    if not isinstance(design, EpisodeDesign):
        raise InputError(f"{quoted(name)} is a study of scenarios; name the files under `tasks`")
    return design


def _seen(task: Task, depth: int) -> dict[tuple[str, ...], Any]:
    """Return what players believe at the beginning, and believe others to believe.

    Args:
        task: The instance.
        depth: Greatest number of agents below a player.
    """
    with Trials(task) as trials:
        return {
            path: believed
            for player in task.players
            for path, believed in _believed(trials.view(player), depth)
        }


def _believed(view: AgentView, depth: int) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield each path below an agent with the contents, agents, blocks and signs believed there."""
    for length in range(depth + 1):
        for path in product(view.brief.agents, repeat=length):
            whole = (view.agent, *path)
            if any(one == other for one, other in zip(whole, path, strict=False)):
                continue
            state = view.about(*path) if path else view.state
            agents = state.agents.items()
            yield (
                whole,
                (
                    {at: (dict(c.items), c.complete) for at, c in state.containers.items()},
                    {name: (each.position, dict(each.inventory)) for name, each in agents},
                    state.blocks.grid.tobytes(),
                    dict(state.signs),
                ),
            )
