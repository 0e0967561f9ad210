"""People as agents of an episode, in rounds of real time."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace

import msgspec

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.policies.simple import Person
from beliefnest.episodes.task import Task
from beliefnest.errors import InputError
from beliefnest.nest.face.nest import Nest
from beliefnest.world.values import TICKS_PER_SECOND
from beliefnest.worlds.names import world_name
from beliefnest.worlds.protocol import ProgramPast, ProgramResult
from beliefnest.worlds.servers.listening import is_hosted

_LONGEST = 20
"""Number of round lengths after which the episode no longer waits for an idle person."""


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


class RealRound:
    """Round in real time: programs run and people act.

    Args:
        nest: Nest of the episode.
        policies: Policies by agent, including people.
        ticks: Length of the round; it is longer if a person is awaited.
        decided: Function that returns True when the outcome of the episode is certain; the round
            then waits for nobody.
        mute: Agents whose programs may not speak.

    Attributes:
        began: Tick at which the round began.
        cut: Tick at which its programs ended.
    """

    def __init__(
        self,
        nest: Nest,
        policies: Mapping[str, Policy],
        ticks: int,
        decided: Callable[[], bool],
        mute: Collection[str],
    ) -> None:
        self._nest, self._ticks, self._decided, self._mute = nest, ticks, decided, mute
        self._people = people_in(policies)
        self._awaited = frozenset(
            name for name, each in policies.items() if isinstance(each, Person) and each.is_awaited
        )
        # Events while policies were deciding belong to the time before the round.
        nest["/"].step(0)
        self.began = self.cut = nest.tick

    def run(
        self, programs: Mapping[str, str], past: Mapping[str, ProgramPast]
    ) -> Mapping[str, ProgramResult]:
        """Run the round to its end."""
        nest = self._nest
        results: Mapping[str, ProgramResult] = {}
        if programs:
            results = nest["/"].run_all(
                programs, self._ticks, senses="percepts", past=past, mute=self._mute
            )
        self.cut = nest.tick
        most = self._ticks * (_LONGEST if self._awaited else 1)
        left = max(0, self.began + most - nest.tick)
        nest.wait(self._is_over, left / TICKS_PER_SECOND)
        return results

    @property
    def acted(self) -> frozenset[str]:
        """Return the people who have done or said something in the round."""
        state = self._nest["/"].state
        did = {e.actor for e in state.events if e.tick > self.began and e.kind.is_act}
        did |= {speaker for tick, speaker, _ in state.chat if tick > self.began}
        return frozenset(name for name in self._people if name in did)

    def _is_over(self) -> bool:
        if not self._awaited:
            return self._nest.tick >= self.began + self._ticks
        return self._awaited <= self.acted or self._decided()
