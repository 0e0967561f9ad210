"""Execution of the actions of a step: skills tick by tick, or programs in any world."""

from collections.abc import Mapping
from typing import Protocol

import msgspec

from beliefnest.errors import BeliefNestError
from beliefnest.nest.face.nest import Nest
from beliefnest.skills.calls import Call
from beliefnest.timeline.run_records import Senses
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame
from beliefnest.world.paths import path_text
from beliefnest.world.values import AgentState, Position
from beliefnest.worlds.scripted.footpaths import Ground
from beliefnest.worlds.scripted.ground_cache import Grounds
from beliefnest.worlds.scripted.hand import Doing, Hand
from beliefnest.worlds.scripted.skills import perform


class ActionState(msgspec.Struct, frozen=True):
    """State of an agent's latest action.

    Attributes:
        error: Error message; empty if there is no error.
        busy: True if the action continues in the next step.
    """

    error: str = ""
    busy: bool = False


class JointStep(msgspec.Struct, frozen=True):
    """Result of a joint step.

    Attributes:
        deeds: State of each agent's action.
        spoken: True if any agent said something.
    """

    deeds: Mapping[str, ActionState]
    spoken: bool


class Acting(Protocol):
    """Executor of joint actions."""

    def act(self, actions: Mapping[str, Call | str]) -> JointStep:
        """Begin the actions and let time pass."""


class ProgramActing:
    """Executor that runs actions as programs until the last has ended, in any world.

    Args:
        nest: The nest.
        timeout_ticks: Ticks after which programs are stopped.
        senses: What programs can read of the world.
    """

    def __init__(self, nest: Nest, timeout_ticks: int, senses: Senses) -> None:
        self._real = nest["/"]
        self._timeout_ticks = timeout_ticks
        self._senses = senses

    def act(self, actions: Mapping[str, Call | str]) -> JointStep:
        """Run all programs that are not empty; let one tick pass if there are none.

        Raises:
            BodyError: The Minecraft side failed.
        """
        codes = {
            agent: action if isinstance(action, str) else action.program
            for agent, action in actions.items()
        }
        programs = {agent: code for agent, code in codes.items() if code.strip()}
        if not programs:
            self._real.step(1)
            return JointStep({agent: ActionState() for agent in actions}, spoken=False)
        results = self._real.run_all(programs, self._timeout_ticks, self._senses)
        # Lines are those of programs that their agents wrote.
        errors = {
            agent: str(each.error) if isinstance(actions[agent], str) else each.error.message
            for agent, each in results.items()
            if each.error is not None
        }
        spoken = any(
            event.kind is EventKind.CHAT for each in results.values() for event in each.events
        )
        return JointStep({agent: ActionState(errors.get(agent, "")) for agent in actions}, spoken)


class SkillActing:
    """Executor that performs skills in the scripted world without a JavaScript engine.

    Agents act in the order of their names. A new action stops the agent's current one.

    Args:
        nest: The nest, in the scripted world.
        ticks: Ticks of a step; None: a step lasts until all actions have ended.
        timeout_ticks: Ticks after which actions are stopped, if `ticks` is None.
        senses: Knowledge with which skills look for ways, containers and other agents.
        speech_ticks: Ticks per utterance, as in programs.
    """

    def __init__(
        self, nest: Nest, ticks: int | None, timeout_ticks: int, senses: Senses, speech_ticks: int
    ) -> None:
        world = nest.scripted_world
        self._nest = nest
        self._world = world
        self._senses = senses
        self._ticks = ticks
        self._timeout_ticks = timeout_ticks
        self._speech_ticks = speech_ticks
        self._doing: dict[str, Doing] = {}
        self._spoken = False
        self._grounds = Grounds()
        world.listen(self._hear)

    def act(self, actions: Mapping[str, Call | str]) -> JointStep:
        """Begin the actions and let at least one tick pass."""
        self._spoken = False
        errors: dict[str, str] = {}
        for agent, call in sorted(actions.items()):
            if isinstance(call, Call) and not call.is_nothing:
                self._begin(agent, call, errors)
        passed = 0
        while True:
            with self._world.tick():
                for agent in sorted(self._doing):
                    self._advance(agent, errors)
            passed += 1
            if passed == (self._ticks or self._timeout_ticks):
                break
            if self._ticks is None and not self._doing:
                break
        if self._ticks is None:
            for agent in self._doing:
                errors[agent] = f"it did not end within {self._timeout_ticks} ticks"
            self._doing.clear()
        deeds = {
            agent: ActionState(errors.get(agent, ""), busy=agent in self._doing)
            for agent in actions
        }
        return JointStep(deeds, self._spoken)

    def _begin(self, agent: str, call: Call, errors: dict[str, str]) -> None:
        hand = Hand(
            agent,
            self._world,
            known=lambda: self._known_ground(agent),
            others=lambda: self._others(agent),
            signs=lambda: self._signs(agent),
            ground=self._real_ground,
            speech_ticks=self._speech_ticks,
        )
        self._doing[agent] = perform(hand, call)
        # Run the skill up to its first tick: it checks its arguments and has no effect yet.
        self._advance(agent, errors)

    def _advance(self, agent: str, errors: dict[str, str]) -> None:
        try:
            next(self._doing[agent])
        except StopIteration:
            del self._doing[agent]
        except BeliefNestError as error:
            del self._doing[agent]
            errors[agent] = str(error)

    def _known_ground(self, agent: str) -> Ground:
        if self._senses == "world":
            return self._real_ground()
        terrain = self._nest[path_text((agent,))].state.blocks.terrain
        return self._grounds.of(self._world.box, terrain)

    def _real_ground(self) -> Ground:
        return self._grounds.of(self._world.box, self._world.terrain)

    def _others(self, agent: str) -> Mapping[str, AgentState]:
        others = {name: each for name, each in self._world.agents.items() if name != agent}
        if self._senses == "world":
            return others
        seen = self._nest[path_text((agent,))].state.agents
        # An agent that is perceived now is believed to be where it really is.
        return {name: each for name, each in others.items() if seen[name].current}

    def _signs(self, agent: str) -> Mapping[Position, str]:
        if self._senses == "world":
            return self._world.signs
        return self._nest[path_text((agent,))].state.signs

    def _hear(self, frame: Frame) -> None:
        if any(event.kind is EventKind.CHAT for event in frame.events):
            self._spoken = True
