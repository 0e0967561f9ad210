"""What simulators and nests show of themselves, now or in the past; nothing here acts."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.errors import BeliefNestError, InputError, PathError
from beliefnest.nest.explain.chain import element_of, explain
from beliefnest.nest.explain.comparison import Difference, compare, false_beliefs
from beliefnest.nest.explain.explanation import Explanation
from beliefnest.nest.explain.made_claims import MadeClaim, claims_made
from beliefnest.nest.face.ticks import tick_of
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.past.placing import placed_in
from beliefnest.nest.past.recording import Recording
from beliefnest.pictures.words import place_words, state_words
from beliefnest.prompts import Template
from beliefnest.world.paths import BeliefPath, normalised, parse_path, path_text
from beliefnest.world.values import Placements, Position

if TYPE_CHECKING:  # What draws or infers takes long to import, and few nests are asked to.
    from beliefnest.minds.inference import Inference
    from beliefnest.minds.model import MindModel
    from beliefnest.pictures.figure import Figure
    from beliefnest.pictures.scene import Scene

__all__ = ["Past", "PastSimulator", "ShownNest", "ShownSimulator"]


class ShownSimulator(ABC):
    """What a simulator shows of itself, at one tick or at the latest of its timeline."""

    _tick: int | None = None

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
        return self._recording.info(self._path).head if self._tick is None else self._tick

    @property
    @in_turn
    def state(self) -> State:
        """What the simulator holds, read-only."""
        return self._recording.state(self._path, self._tick)

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
        return explain(self._recording, self._path, self._tick, element)

    @in_turn
    def infer(
        self,
        model: "MindModel",
        since: int = 0,
        until: int | None = None,
        *,
        ended: bool = False,
        smooth: bool = False,
    ) -> "Inference":
        """Infer what an agent wants and believes from what this simulator holds of its course.

        Args:
            model: The hypotheses.
            since: The tick from which on evidence counts; its percept is the first.
            until: The last tick; None: the tick that the simulator shows.
            ended: Whether the agent acted, after the last tick, on the goal at its place.
            smooth: Whether marginals of `cell` and `credence_now` use later evidence too.

        Raises:
            InputError: The model does not fit: no goal can be reached in any alternative, no
                alternative agrees with what the simulator holds, or the agent was never seen.
            PathError: There is no such agent.
            TickError: A tick lies in the future or before the start.
        """
        from beliefnest.nest.inferring.asking import infer_in

        last = self._tick if until is None else tick_of(until)
        recording, path = self._recording, self._path
        return infer_in(recording, path, model, tick_of(since), last, ended=ended, smooth=smooth)

    @in_turn
    def credence(
        self,
        agent: str,
        doubt: "Mapping[str, Mapping[str, Any]]",
        initial: "npt.ArrayLike | None" = None,
        tick: int | None = None,
        *,
        since: int = 0,
        actual: str | Mapping[str, float] | None = None,
        lapse: float = 0.0,
    ) -> dict[str, float]:
        """Return the credence that this simulator attributes to an agent, from its percepts alone.

        Args:
            agent: The agent.
            doubt: Alternatives by name, as for `MindModel`.
            initial: Probabilities of the alternatives just before the percept at `since`; None:
                the uniform ones.
            tick: When; None: the tick that the simulator shows.
            since: The tick whose percept is the first to count.
            actual: What is the case, as for `MindModel`.
            lapse: As for `MindModel`.

        Returns:
            Probability by name of the alternative.

        Raises:
            InputError, PathError, TickError: As for `infer`.
        """
        from beliefnest.minds.model import MindModel
        from beliefnest.nest.inferring.asking import credence_in

        rows: Any = None if initial is None else [initial]
        model = MindModel(
            agent, {"any": {"at": (0, 0, 0)}}, {"any": 0}, doubt, rows, actual, lapse=lapse
        )
        last = self._tick if tick is None else tick_of(tick)
        return credence_in(self._recording, self._path, model, tick_of(since), last)

    @property
    @in_turn
    def placed(self) -> Placements:
        """List what its body had to place otherwise than believed.

        A belief may be impossible: somebody in a doorway that is now believed shut, two in one
        place, a diamond in a block that is unknown or no container. The belief is left as it is.
        Its body begins with agents at the nearest place where they can stand, and has a chest
        wherever contents are believed that the block cannot hold. Empty in follow mode and where
        nothing had to be changed.

        Returns:
            Agent to (from where, to where), feet in blocks, as of when the body began; and
            position to (the believed block or None, "chest"), as of now.
        """
        return placed_in(self._recording, self._path, self._tick)

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
        return self._recording.reading(self._path, self._tick).visible_from(agent)

    def figure(
        self,
        against: str | None = None,
        *,
        sight: Sequence[str] | None = None,
        height: int | None = None,
        inference: "Inference | None" = None,
        steps: int = 5,
    ) -> "Figure":
        """The simulator, drawn from what it holds itself; as `Nest.figure`."""
        with self._recording.turn:
            scenes = _scenes(self._recording, [self], against, sight, height)
            return _figure(scenes, inference, steps, self._tick)

    def __repr__(self) -> str:
        recording = self._recording
        try:
            with recording.turn:
                key = recording.selected.get(self._path)
                state = self.state
                wrong = [_named(each, recording) for each in self._otherwise(())]
                words = state_words(state)
        except BeliefNestError as error:
            # As for a nest.
            return f"<simulator {self.path}: {error}>"
        mode = "follow mode" if key is None else f"branch {key.branch}"
        false = f"; false: {', '.join(wrong)}" if wrong else ""
        return f"<simulator {self.path}, {mode}, tick {state.tick}: {words}{false}>"

    def _repr_html_(self) -> str:
        return self.figure()._repr_html_()

    def scene(self, against: BeliefPath, sight: Sequence[str] | None, height: int) -> "Scene":
        """What `figure` draws of it."""
        from beliefnest.nest.face.drawing import scene_of

        path, state = self._path, self.state
        # Who is not perceived at this tick is drawn at a remembered place: what it sees is unknown.
        own = [name for name in path[-1:] if state.agents[name].current]
        seen = {name: self.visible_blocks(name) for name in (own if sight is None else sight)}
        otherwise = self._otherwise(against)
        return scene_of(self._recording, path, state, otherwise, against, seen, height)

    def _otherwise(self, against: BeliefPath) -> Sequence[Difference]:
        """What it holds (`b`) otherwise than another (`a`), at its tick or that one's latest."""
        recording, path, tick = self._recording, self._path, self._tick
        if path == against:
            return []
        then = None if tick is None else min(tick, recording.info(against).head)
        return false_beliefs(recording, path, tick, against, then)

    def _child_path(self, agent: str) -> BeliefPath:
        agents = self._recording.agents
        if agent not in agents:
            raise PathError(f"no agent {agent!r}; there are {', '.join(agents)}")
        return normalised((*self._path, agent))


class PastSimulator(ShownSimulator):
    """A simulator as it was at a past tick, or is now (None); read-only."""

    def __init__(self, recording: Recording, path: BeliefPath, tick: int | None) -> None:
        super().__init__(recording, path)
        self._tick = tick

    def child(self, agent: str) -> "PastSimulator":
        """The simulator of what `agent` believed in this one."""
        return PastSimulator(self._recording, self._child_path(agent), self._tick)


class ShownNest:
    """What a nest shows: live, recorded, or as it was at a past tick.

    A belief path that is malformed, or names an unknown agent, raises PathError.
    """

    _recording: Recording
    _tick: int | None = None

    def figure(
        self,
        paths: str | Sequence[str] = "/",
        tick: int | None = None,
        against: str | None = None,
        *,
        sight: Sequence[str] | None = None,
        height: int | None = None,
        inference: "Inference | None" = None,
        steps: int = 5,
    ) -> "Figure":
        """Simulators side by side, each drawn from what it holds itself.

        Args:
            paths: Belief paths; one can stand alone.
            tick: When; None: the latest tick.
            against: The path that they are compared with, to mark what is false; None: reality.
            sight: Agents whose sight is shown in each; None: that of the belief's owner.
            height: The storey, y of what stands on its floor; None: that of most containers, or
                of most agents.
            inference: A posterior, drawn as bars beside the plans, at the tick of the figure; the
                cells of the plans are tinted by the probability that the agent will be there.
            steps: After how many actions it will be there.

        Raises:
            TickError: The tick is in the future or before the start, of the nest or the inference.
            InputError: There is no path, the height lies outside the box, or steps is below 1.
        """
        scenes = self.scenes(paths, tick, against, sight=sight, height=height)
        return _figure(scenes, inference, steps, self._tick if tick is None else tick)

    def scenes(
        self,
        paths: str | Sequence[str] = "/",
        tick: int | None = None,
        against: str | None = None,
        *,
        sight: Sequence[str] | None = None,
        height: int | None = None,
    ) -> "tuple[Scene, ...]":
        """What `figure` draws, as values; arguments and errors are the same."""
        wanted = [paths] if isinstance(paths, str) else list(paths)
        then = self._tick if tick is None else tick
        recording = self._recording
        with recording.turn:
            names = [parse_path(path, recording.agents) for path in wanted]
            shown = [PastSimulator(recording, path, then) for path in names]
            return _scenes(recording, shown, against, sight, height)

    @in_turn
    def plot_beliefs(
        self,
        container: Position | None = None,
        item: str | None = None,
        paths: Sequence[str] = ("/",),
        *,
        agent: str | None = None,
        block: Position | None = None,
    ) -> "Figure":
        """What simulators held of a thing over time: a row for each, a band for each value.

        Bands are marked where they are false; above stand the deeds of the real world that
        mattered, and what was claimed of it. Claims that were heard have a balloon above each
        row, struck out where they were not believed. Followed are a container's contents, an
        item wherever it is, a block, an agent's place, or with `agent` and `item`, how much of
        it the agent has with it.

        Args:
            container: Where the container is.
            item: The item to follow, alone in all containers and with all agents; None: all that
                is in the container, or the agent's place.
            paths: Belief paths.
            agent: The agent to follow, in place of a container.
            block: Where the block is that is followed, in place of a container.

        Raises:
            PathError: There is no such agent.
            PositionError: The container or block lies outside the box.
            InputError: There is no path, not one thing to follow, or never was a container there.
            UnknownNameError: There is no such item.
        """
        from beliefnest.nest.face.plotting import matter_of, plot_of

        matter = matter_of(self._recording, container, item, agent, block)
        return plot_of(self._recording, matter, paths, self._tick)

    @in_turn
    def compare(self, a: str, b: str, *, unknown: bool = True) -> list[Difference]:
        """Where two simulators differ: blocks, containers, agents' poses, inventories.

        Args:
            a: Belief path of one.
            b: Belief path of the other.
            unknown: Whether to list what one of them does not know or have.

        Raises:
            TickError: The tick that is looked at is in the future or before the start.
        """
        recording = self._recording
        one, other = parse_path(a, recording.agents), parse_path(b, recording.agents)
        return compare(recording, one, other, self._tick, unknown=unknown)

    @in_turn
    def false_beliefs(self, path: str) -> list[Difference]:
        """What a simulator holds otherwise than reality (`a`) does; unknown is not false.

        Contents are false if they claim items that are not in them, or claim to be complete
        and miss some; an agent's place from half a block on, wherever its head has turned to.

        Raises:
            TickError: The tick that is looked at is in the future or before the start.
        """
        names = parse_path(path, self._recording.agents)
        return false_beliefs(self._recording, names, self._tick)

    @in_turn
    def claims(self, path: str = "/") -> list[MadeClaim]:
        """Every claim that was made in a simulator, oldest first.

        Each has its tick, text, speaker and hearers, whether it was false and whether a lie, and
        for any belief whether that took it up, and why.

        Args:
            path: The simulator; a claim made in one in control mode is made in its own world.
        """
        names = parse_path(path, self._recording.agents)
        return claims_made(self._recording, names, self._tick)

    def __repr__(self) -> str:
        recording = self._recording
        try:
            with recording.turn:
                state = recording.state((), self._tick)
                branches = len(recording.journal.timelines())
                words = state_words(state)
        except BeliefNestError as error:
            # Whoever prints a closed nest, or a tick that does not exist, wants no further fault.
            return f"<nest of {recording.setting.name}: {error}>"
        shown = f"<nest of {recording.setting.name} at tick {state.tick}"
        return f"{shown}, {branches} timeline{'s' * (branches > 1)}: {words}>"

    def _repr_html_(self) -> str:
        return self.figure()._repr_html_()


class Past(ShownNest):
    """All simulators at one past tick."""

    def __init__(self, recording: Recording, tick: int) -> None:
        self._recording = recording
        self._tick = tick

    def __getitem__(self, path: str) -> PastSimulator:
        """The simulator of a belief path as it was."""
        return PastSimulator(self._recording, parse_path(path, self._recording.agents), self._tick)


def _figure(
    scenes: "tuple[Scene, ...]", inference: "Inference | None", steps: int, tick: int | None
) -> "Figure":
    """Return a figure of scenes, with a posterior at their tick or, before that, at its last."""
    from beliefnest.pictures.figure import figure_of

    if inference is None:
        return figure_of(scenes)
    from beliefnest.minds.charts import bars_of, heat_of

    then = None if tick is None or tick >= inference.until else tick
    heat = heat_of(inference, steps, then)
    actions = "1 action" if steps == 1 else f"{steps} actions"
    words = f"where {inference.model.agent} will be after {actions}"
    tinted = [replace(scene, heat=heat, heat_words=words) for scene in scenes]
    return figure_of(tinted, bars_of(inference, then))


def _scenes(
    recording: Recording,
    shown: Sequence[ShownSimulator],
    against: str | None,
    sight: Sequence[str] | None,
    height: int | None,
) -> "tuple[Scene, ...]":
    from beliefnest.pictures.scene import best_height

    if not shown:
        raise InputError("a figure of no simulator is empty; give a belief path")
    other = parse_path("/" if against is None else against, recording.agents)
    for name in sight or ():
        parse_path(path_text((name,)), recording.agents)
    low, high = recording.box.low[1], recording.box.high[1]
    if height is not None and not low <= height <= high:
        raise InputError(f"height {height} lies outside the box; give {low} to {high}")
    # One storey for all of them, so that they can be compared.
    level = best_height([each.state for each in shown]) if height is None else height
    return tuple(each.scene(other, sight, level) for each in shown)


def _named(wrong: Difference, recording: Recording) -> str:
    """What is false, by the name that people have for it."""
    if isinstance(wrong.where, str):
        is_owned = wrong.kind == "inventory"
        return f"what {wrong.where} has" if is_owned else f"where {wrong.where} is"
    return recording.setting.labels.get(wrong.where, place_words(wrong.where))
