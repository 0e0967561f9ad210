"""People as agents of an episode: rounds in real time, in which they act by themselves."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace

import msgspec

from beliefnest.bodies.listening import is_hosted
from beliefnest.bodies.protocol import ProgramPast, ProgramResult
from beliefnest.bodies.worlds import world_name
from beliefnest.episodes.policies.simple import Person
from beliefnest.episodes.task import Task
from beliefnest.episodes.view import Policy
from beliefnest.errors import InputError
from beliefnest.nest.face.nest import Nest
from beliefnest.world.values import TICKS_PER_SECOND, EventKind

__all__ = ["RealRound", "check_repeats", "people_in", "played_by_people", "world_of_people"]

_LONGEST = 20
"""Rounds' times after which somebody who does nothing is not waited for any more."""
_NO_DEED = (EventKind.THINK, EventKind.BLOCK_UPDATE)


def people_in(policies: Mapping[str, Policy]) -> frozenset[str]:
    """Return the agents that are played by people."""
    return frozenset(name for name, policy in policies.items() if isinstance(policy, Person))


def world_of_people(world: str, listen: int | str | None, people: Collection[str]) -> str:
    """Return the name of the world that is played in.

    Raises:
        InputError: Nobody can join it, or nobody is to.
    """
    if not people:
        if listen is not None:
            raise InputError("listen is given, and nobody is played by `person`; leave it out")
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
    """Refuse what needs the same to happen again.

    Raises:
        InputError: People play in this world.
    """
    if is_hosted(world):
        raise InputError(f"an episode with people cannot be {what}: nobody does the same twice")


def played_by_people(task: Task, people: Collection[str]) -> Task:
    """Return a task whose scenario says which of its agents are people."""
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


class RealRound:
    """One round in real time: programs run, people do what they do, and time passes by itself.

    Args:
        nest: Where it is played.
        policies: By agent, people among them.
        ticks: How long it lasts; longer, if somebody is waited for.
        decided: Whether nothing that is done any more matters; then nobody is waited for.

    Attributes:
        began: The tick at which it began.
        cut: The tick at which programs were over.
    """

    def __init__(
        self,
        nest: Nest,
        policies: Mapping[str, Policy],
        ticks: int,
        decided: Callable[[], bool],
    ) -> None:
        self._nest, self._ticks, self._decided = nest, ticks, decided
        self._people = people_in(policies)
        self._awaited = frozenset(
            name for name, each in policies.items() if isinstance(each, Person) and each.is_awaited
        )
        # What happened while policies were deciding lies before the round.
        nest["/"].step(0)
        self.began = self.cut = nest.tick

    def run(
        self, programs: Mapping[str, str], past: Mapping[str, ProgramPast]
    ) -> Mapping[str, ProgramResult]:
        """Let it be played up to its end."""
        nest = self._nest
        results: Mapping[str, ProgramResult] = {}
        if programs:
            results = nest["/"].run_all(programs, self._ticks, senses="percepts", past=past)
        self.cut = nest.tick
        most = self._ticks * (_LONGEST if self._awaited else 1)
        left = max(0, self.began + most - nest.tick)
        nest.wait(self._is_over, left / TICKS_PER_SECOND)
        return results

    @property
    def acted(self) -> frozenset[str]:
        """The people who have done or said something in it."""
        state = self._nest["/"].state
        did = {e.actor for e in state.events if e.tick > self.began and e.kind not in _NO_DEED}
        did |= {speaker for tick, speaker, _ in state.chat if tick > self.began}
        return frozenset(name for name in self._people if name in did)

    def _is_over(self) -> bool:
        if not self._awaited:
            return self._nest.tick >= self.began + self._ticks
        return self._awaited <= self.acted or self._decided()
