"""How the actions of a step come about: skills tick by tick, or programs in any world."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from beliefnest.bodies.footpaths import Ground
from beliefnest.bodies.scripted_skills import CALLS, SKILLS, Doing, Hand
from beliefnest.env.actions import Call
from beliefnest.errors import BeliefNestError
from beliefnest.nest.face.nest import Nest
from beliefnest.world.frames import Frame
from beliefnest.world.registry import Registry
from beliefnest.world.scripted import ScriptedWorld
from beliefnest.world.values import EventKind

__all__ = ["Acting", "Deed", "ProgramActing", "SkillActing", "Step"]


@dataclass(frozen=True, slots=True)
class Deed:
    """What has become of an agent's latest action.

    Attributes:
        error: Why it failed; empty if it did not.
        busy: Whether it goes on.
    """

    error: str = ""
    busy: bool = False


@dataclass(frozen=True, slots=True)
class Step:
    """What happened in a joint step.

    Attributes:
        deeds: By agent.
        spoken: Whether anybody said anything.
    """

    deeds: Mapping[str, Deed]
    spoken: bool


class Acting(Protocol):
    """Brings about what agents do together."""

    def act(self, actions: Mapping[str, Call | str]) -> Step:
        """Begin the actions, and let time pass."""


class ProgramActing:
    """Runs actions as programs, together, until the last has ended; in any world.

    Args:
        nest: The nest.
        timeout_ticks: Ticks after which programs are ended.
    """

    def __init__(self, nest: Nest, timeout_ticks: int) -> None:
        self._real = nest["/"]
        self._timeout_ticks = timeout_ticks

    def act(self, actions: Mapping[str, Call | str]) -> Step:
        """Run what is no empty program; one tick passes if there is none.

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
            return Step({agent: Deed() for agent in actions}, spoken=False)
        results = self._real.run_all(programs, self._timeout_ticks)
        errors = {agent: str(each.error or "") for agent, each in results.items()}
        spoken = any(
            event.kind is EventKind.CHAT for each in results.values() for event in each.events
        )
        return Step({agent: Deed(errors.get(agent, "")) for agent in actions}, spoken)


class SkillActing:
    """Does skills of the scripted world itself, without a JavaScript engine.

    Agents act in the order of their names. A new action ends what its agent was doing.

    Args:
        world: The real world of the nest.
        ticks: How many ticks a step takes; None: until nobody is doing anything.
        timeout_ticks: Ticks after which what goes on is ended, where `ticks` is None.
    """

    def __init__(self, world: ScriptedWorld, ticks: int | None, timeout_ticks: int) -> None:
        self._world = world
        self._ticks = ticks
        self._timeout_ticks = timeout_ticks
        self._doing: dict[str, Doing] = {}
        self._spoken = False
        self._ground = Ground(Registry.load(), world.box, world.blocks)
        self._grid = world.blocks
        world.listen(self._hear)

    def act(self, actions: Mapping[str, Call | str]) -> Step:
        """Begin the actions, and let at least one tick pass."""
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
        deeds = {agent: Deed(errors.get(agent, ""), busy=agent in self._doing) for agent in actions}
        return Step(deeds, self._spoken)

    def _begin(self, agent: str, call: Call, errors: dict[str, str]) -> None:
        skill = SKILLS.get(call.skill) or CALLS[call.skill]
        hand = Hand(agent, self._world, self._known_ground, self._known_ground)
        self._doing[agent] = _near(hand, skill(hand, *call.args), call)
        # Up to its first tick nothing is done, and what cannot be done is told.
        self._advance(agent, errors)

    def _advance(self, agent: str, errors: dict[str, str]) -> None:
        try:
            next(self._doing[agent])
        except StopIteration:
            del self._doing[agent]
        except BeliefNestError as error:
            del self._doing[agent]
            errors[agent] = str(error)

    def _known_ground(self) -> Ground:
        if self._grid is not self._world.blocks:
            self._grid = self._world.blocks
            self._ground = Ground(Registry.load(), self._world.box, self._grid)
        return self._ground

    def _hear(self, frame: Frame) -> None:
        if any(event.kind is EventKind.CHAT for event in frame.events):
            self._spoken = True


def _near(hand: Hand, doing: Doing, call: Call) -> Doing:
    """Go near a container before it is opened, as its program does."""
    if call.skill == "openContainer":
        yield from SKILLS["goToPosition"](hand, call.args[0], 2)
    yield from doing
