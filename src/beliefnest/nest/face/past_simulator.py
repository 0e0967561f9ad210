"""What a simulator shows of itself, and simulators as they were; nothing here acts."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Self

import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.errors import PathError
from beliefnest.nest.explain.chain import element_of, explain
from beliefnest.nest.explain.explanation import Explanation
from beliefnest.nest.face.comparing import Comparing
from beliefnest.nest.face.looking import Looking, LookingAtOne
from beliefnest.nest.face.telling import Telling
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.past.placing import placed_in
from beliefnest.nest.past.recording import Recording
from beliefnest.prompts import Template
from beliefnest.world.paths import BeliefPath, normalised, parse_path, path_text
from beliefnest.world.values import Point, Position

__all__ = ["Past", "PastSimulator", "ShownSimulator"]


class ShownSimulator(LookingAtOne, ABC):
    """What a simulator shows of itself at one tick, now or in the past."""

    def __init__(self, recording: Recording, path: BeliefPath) -> None:
        self._recording = recording
        self._path = path

    @property
    def path(self) -> str:
        """The normalised belief path, as text."""
        return path_text(self._path)

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""
        return self._path[-1] if self._path else None

    @property
    def labels(self) -> Mapping[Position, str]:
        """What containers are called and look as if they held, where prompts may say so."""
        return self._recording.setting.prompt_labels

    @property
    def tick(self) -> int:
        """The tick it shows; in the present the latest of the timeline it is on."""
        moment = self._moment()
        return self._recording.info(self._path).head if moment is None else moment

    @property
    @in_turn
    def state(self) -> State:
        """What the simulator holds, read-only."""
        return self._recording.state(self._path, self._moment())

    def render(self, template: Template | Path | str, **variables: object) -> str:
        """The text of a prompt template, filled from this simulator.

        Args:
            template: A Jinja2 template: its text, or the path of its file.
            variables: Further variables of the template, as `task`.

        Raises:
            TemplateError: The template is wrong; the message names its line.
        """
        with self._recording.turn:
            return self._recording.renderer.render(template, self, variables)

    @in_turn
    def explain(
        self,
        *,
        container: Position | None = None,
        agent: str | None = None,
        block: Position | None = None,
    ) -> Explanation:
        """The chain of perceptions behind what it holds of one thing; `str()` puts it in words.

        Args:
            container: Position of a container, whose contents are explained.
            agent: Name of an agent, whose place is explained.
            block: Position of a block.

        Raises:
            InputError: None of the three was given, or several were.
            PathError: There is no such agent.
            PositionError: The position is outside the box.
        """
        element = element_of(self._recording, container, agent, block)
        return explain(self._recording, self._path, self._moment(), element)

    @property
    @in_turn
    def placed(self) -> Mapping[str, tuple[Point, Point]]:
        """Whom its body had to move when it began: agent to (from where, to where), feet in blocks.

        A belief may be impossible: somebody in a doorway that is now believed shut, two in one
        place. Its body begins with them at the nearest place where they can stand; the belief is
        left as it is. Empty in follow mode and where nobody had to be moved.
        """
        return placed_in(self._recording, self._path, self._moment())

    @abstractmethod
    def child(self, agent: str) -> Self:
        """The simulator of what `agent` believes in this one."""

    @in_turn
    def visible_blocks(self, agent: str) -> npt.NDArray[np.bool_]:
        """Which blocks an agent sees from its pose in this simulator.

        Returns:
            bool, shape of the box; all false where the agent's pose is unknown.

        Raises:
            PathError: There is no such agent.
        """
        self._child_path(agent)
        return self._recording.reading(self._path, self._moment()).visible_from(agent)

    def _child_path(self, agent: str) -> tuple[str, ...]:
        agents = self._recording.agents
        if agent not in agents:
            raise PathError(f"no agent {agent!r}; there are {', '.join(agents)}")
        return normalised((*self._path, agent))


class PastSimulator(ShownSimulator):
    """A simulator as it was at a past tick; read-only."""

    def __init__(self, recording: Recording, path: BeliefPath, tick: int) -> None:
        super().__init__(recording, path)
        self._tick = tick

    def child(self, agent: str) -> "PastSimulator":
        """The simulator of what `agent` believed in this one."""
        return PastSimulator(self._recording, self._child_path(agent), self._tick)

    def _moment(self) -> int:
        return self._tick


class Past(Looking, Telling, Comparing):
    """All simulators at one past tick."""

    def __init__(self, recording: Recording, tick: int) -> None:
        self._recording = recording
        self._tick = tick

    def _moment(self) -> int:
        return self._tick

    def __getitem__(self, path: str) -> PastSimulator:
        """The simulator of a belief path as it was."""
        return PastSimulator(self._recording, parse_path(path, self._recording.agents), self._tick)
