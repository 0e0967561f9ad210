"""People as agents of an episode, in rounds of real time."""

from collections.abc import Collection, Mapping
from dataclasses import replace

import msgspec

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.policies.simple import Person
from beliefnest.episodes.task import Task
from beliefnest.errors import InputError
from beliefnest.worlds.names import world_name
from beliefnest.worlds.servers.listening import is_hosted


def people_in(policies: Mapping[str, Policy]) -> frozenset[str]:
    """Return the agents that people play."""
    return frozenset(name for name, policy in policies.items() if isinstance(policy, Person))


def world_of_people(world: str, listen: int | str | None, people: Collection[str]) -> str:
    """Return the name of the world in which people play.

    Raises:
        InputError: People cannot join the world, or no agent is played by a person.
    """
    if not people:
        if listen is not None:
            raise InputError("listen is given, but no agent has the policy `person`; leave it out")
        return world
    if is_hosted(world):
        return world
    if world != "embedded":
        raise InputError(
            f"people cannot join the world {world!r}; play {', '.join(sorted(people))} in "
            "world='embedded'"
        )
    return world_name(world, realtime=True, listen=listen)


def check_repeats(world: str, what: str) -> None:
    """Refuse an operation that repeats an episode if people play in it.

    Raises:
        InputError: People play in this world.
    """
    if is_hosted(world):
        raise InputError(
            f"an episode with people cannot be {what}: people cannot repeat their acts exactly"
        )


def played_by_people(task: Task, people: Collection[str]) -> Task:
    """Return the task with some agents marked as people in its scenario."""
    agents = {
        name: {**entry, "type": "human" if name in people else "bot"}
        if name in people or "type" in entry
        else entry
        for name, entry in task.form.scenario["agents"].items()
    }
    if agents == task.form.scenario["agents"]:
        return task
    scenario = {**task.form.scenario, "agents": agents}
    return replace(task, form=msgspec.structs.replace(task.form, scenario=scenario))
