"""Candidates of imagined histories: programs, models of minds, and policies."""

from collections.abc import Callable
from dataclasses import dataclass, field
from inspect import signature
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.minds.imagining.courses import Candidate, Course, PolicyProgram
from beliefnest.minds.imagining.histories import PastFace
from beliefnest.minds.imagining.history_starts import Doubt, HistoryStarts
from beliefnest.minds.mind_model import MindModel
from beliefnest.minds.node_inference import ModelStart, start_of_model
from beliefnest.minds.walking import Strategy
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.world.paths import BeliefPath, normalised
from beliefnest.world.values import block_at


class Candidates(msgspec.Struct, frozen=True):
    """Checks of candidates, and their preparation.

    Attributes:
        recording: Recording of the nest.
        path: The simulator that histories are of.
        base: The point from which they begin.
        end: The point at which they end.
        starts: Beginnings of the histories, which learn the doubts of models.
        policies: Policies as programs.
        is_alone: True if a single agent has candidates; others may open it a way.
    """

    recording: Recording
    path: BeliefPath
    base: ForkPoint
    end: ForkPoint
    starts: HistoryStarts
    policies: "HistoryPolicies"
    is_alone: bool

    def of(self, agent: str, name: str, one: object) -> Candidate:
        """Return a candidate of an agent.

        Raises:
            InputError: It is no program, model of that agent, or policy; or the model cannot
                reach any of its goals.
        """
        if isinstance(one, str):
            return Candidate(name, program=one)
        if isinstance(one, MindModel):
            if one.agent != agent:
                raise InputError(
                    f"candidate {name!r} of {agent} is a model of {one.agent}; give one of {agent}"
                )
            start = start_of_model(self.recording, self.path, one, self.base.tick, self.end.tick)
            feet = self.starts.snapshot.agents.get(agent)
            if feet is not None and self.is_alone:
                start.check_goals(block_at(feet.position))
            return Candidate(name, strategy=_strategy(self.recording, start, self.starts, name))
        if callable(one):
            return Candidate(name, policy=self.policies.of(one, agent, name))
        raise InputError(
            f"candidate {name!r} of {agent} is {one!r}; give a program (text), a MindModel, or a "
            "policy (a function from the agent's simulator to a program)"
        )


def _strategy(
    recording: Recording, start: ModelStart, starts: HistoryStarts, name: str
) -> Strategy:
    context = recording.context
    strategy = Strategy(
        start.model,
        start.scene,
        start.agrees,
        start.step_ticks,
        context.sight,
        transparent=context.options.containers == "transparent",
    )
    elements = start.model.alternatives[0].elements
    for doubt in starts.doubts:
        same = doubt.strategy.model
        if elements & doubt.elements and (
            [repr(each) for each in same.alternatives]
            != [repr(each) for each in start.model.alternatives]
            or same.actual_weights != start.model.actual_weights
        ):
            raise InputError(
                f"candidate {name!r} of {start.model.agent} and one of {same.agent} doubt the same "
                "elements in different ways; give both the same doubt and the same actual"
            )
    if elements and not any(elements == doubt.elements for doubt in starts.doubts):
        starts.doubts.append(Doubt(elements, strategy))
    return strategy


@dataclass(eq=False)
class HistoryPolicies:
    """Policies as programs: shows each policy the course so far."""

    side: Recording
    starts: HistoryStarts
    path: BeliefPath
    past: PastFace
    _keys: dict[Course, tuple[TimelineKey, int]] = field(default_factory=dict)

    def of(self, policy: Callable[..., object], agent: str, name: str) -> PolicyProgram:
        """Return what asks a policy for the next program.

        A policy with a parameter `random` gets the random numbers of its history by it.
        """
        draws = "random" in signature(policy).parameters

        def program(course: Course, actor: str) -> str:
            simulator = self._shown(course, actor)
            code = policy(simulator, random=course.chance(actor)) if draws else policy(simulator)
            if not isinstance(code, str):
                raise InputError(
                    f"policy {name!r} of {agent} returned {code!r}; return a program, or an empty "
                    "text to do nothing more"
                )
            return code

        return program

    def _shown(self, course: Course, agent: str) -> Any:
        journal = self.side.journal
        latest = self._keys.get(course)
        entries = self.starts.entries(course)
        if latest is None:
            key = TimelineKey(self.path, f"drawing {len(self._keys)}")
            journal.create(key, self.starts.base, self.starts.base.tick)
            latest = (key, 0)
        key, written = latest
        journal.append(key, entries[written:], course.tick)
        self._keys[course] = (key, len(entries))
        recording = self.side.on(key)
        return self.past(recording, normalised((*self.path, agent)), course.tick)
