"""Read-only methods of simulators and nests, for the present and the past. Nothing here acts."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.errors import BeliefNestError, BranchError, InputError, PathError
from beliefnest.importing import part
from beliefnest.nest.explain.chain import element_of, explain
from beliefnest.nest.explain.comparison import Difference, compare, false_beliefs
from beliefnest.nest.explain.explanation import Explanation
from beliefnest.nest.explain.made_claims import MadeClaim, claims_made
from beliefnest.nest.face.given import tick_of
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.past.over_time import each_entry
from beliefnest.nest.past.percepts import percepts_of
from beliefnest.nest.past.placing import placed_in
from beliefnest.nest.past.recording import Recording
from beliefnest.nest.past.shown_words import state_words
from beliefnest.nest.past.telling import mind_view
from beliefnest.nest.past.views import visible_from
from beliefnest.prompts import Template
from beliefnest.prompts.mind_view import MindView
from beliefnest.prompts.observations import Observation
from beliefnest.timeline.journal import FOLLOW, TimelineKey
from beliefnest.world.claims import Claim, claims_from_plain
from beliefnest.world.paths import BeliefPath, normalised, parse_path, path_text
from beliefnest.world.values import Placements, Position
from beliefnest.world.words import nearest_or_all, point_words

if TYPE_CHECKING:  # Modules for drawing and inference take long to import, and few nests use them.
    from beliefnest.minds.imagining.histories import Imagined
    from beliefnest.minds.inference import Inference
    from beliefnest.minds.mind_model import MindModel
    from beliefnest.pictures.figure import Figure
    from beliefnest.pictures.scene import Scene


class ShownSimulator(ABC):
    """Read-only methods of a simulator at one tick, or at the latest tick of its timeline."""

    _tick: int | None = None

    def __init__(self, recording: Recording, path: BeliefPath) -> None:
        self._recording = recording
        self._path = path

    @property
    def path(self) -> str:
        """The normalised belief path as text."""
        return path_text(self._path)

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""
        return self._path[-1] if self._path else None

    @property
    @in_turn
    def labels(self) -> Mapping[Position, str]:
        """The labels of containers that the owner knows: names and suggested contents."""
        return self.view.labels

    @property
    @in_turn
    def names(self) -> Mapping[Position, str]:
        """The names that the owner has for containers, signs, doors and switches, for prose."""
        return self.view.names

    @property
    @in_turn
    def places(self) -> Mapping[str, Position]:
        """The positions of the named places that the owner knows, by name."""
        return self.view.places

    @property
    def unique(self) -> frozenset[str]:
        """The items of which everybody knows that there is one."""
        return self._recording.setting.unique

    @property
    @in_turn
    def observations(self) -> Sequence[Observation]:
        """The observations of the simulator's owner in the order of time; in reality, all."""
        return self.view.observations

    @property
    @in_turn
    def view(self) -> MindView:
        """The view of this simulator that templates get: its state, percepts and names alone."""
        return mind_view(self._recording, self._path, self._tick)

    @in_turn
    def changes(self, since: int) -> list[int]:
        """Return the ticks at which the owner perceived something new, `since` first.

        In the real world these are the ticks at which anything changed or happened.

        Raises:
            TickError: `since` is in the future or before the start.
        """
        recording, path = self._recording, self._path
        start, end = recording.moment(path, tick_of(since)), recording.moment(path, self._tick)
        if path:
            return [percept.tick for percept, _ in percepts_of(recording, path, start, end)]
        entries = each_entry(recording, [path], start.tick, end.tick)
        return list(dict.fromkeys([start.tick, *(entry.tick for entry, _ in entries)]))

    @property
    def tick(self) -> int:
        """The tick that it shows; for the present, the latest tick of its timeline."""
        return self._recording.info(self._path).head if self._tick is None else self._tick

    @property
    @in_turn
    def state(self) -> State:
        """The state of the simulator, read-only."""
        return self._recording.state(self._path, self._tick)

    @in_turn
    def on(self, branch: str) -> "PastSimulator":
        """Return this simulator on another of its branches, read-only, at that branch's last tick.

        The simulator itself stays where it is, so that one prompt can show several branches.

        Args:
            branch: Name of the branch; `follow`: the belief as it follows its parent.

        Raises:
            BranchError: There is no such branch, or the real world is to follow.
        """
        recording = self._recording
        if branch == FOLLOW and self._path:
            return PastSimulator(recording.following(self._path), self._path, None)
        key = TimelineKey(self._path, branch)
        if not recording.journal.has(key):
            timelines = recording.journal.timelines()
            own = [each.key.branch for each in timelines if each.key.path == self._path]
            raise BranchError(f"{self.path} has no branch {branch!r}{nearest_or_all(branch, own)}")
        return PastSimulator(recording.on(key), self._path, None)

    def render(self, template: Template | Path | str, **variables: object) -> str:
        """Return the text of a prompt template, filled from this simulator.

        Args:
            template: A Jinja2 template: its text, or the path of its file.
            variables: Further variables of the template, for example `task`. Simulators, also in
                lists and mappings, are for filters, as `branch` is: other paths, past ticks
                (`nest.at`) and other branches (`on`).

        Raises:
            TemplateError: The template is wrong; the message names its line.
        """
        with self._recording.turn:
            views = {name: _viewed(value) for name, value in variables.items()}
            return self._recording.renderer.render(template, self.view, views)

    @in_turn
    def explain(
        self,
        *,
        container: Position | None = None,
        agent: str | None = None,
        block: Position | None = None,
    ) -> Explanation:
        """Return the chain of perceptions behind a belief; `str()` puts it into words.

        Args:
            container: Position of a container, to explain its contents.
            agent: Name of an agent, to explain its position.
            block: Position of a block, to explain the block.

        Raises:
            InputError: None or several of the three were given.
            PathError: There is no such agent.
            PositionError: The position is outside the box.
        """
        element = element_of(self._recording, container, agent, block)
        (explanation,) = explain(self._recording, self._path, [(self._tick, element)])
        return explanation

    @property
    @in_turn
    def heard_claims(self) -> list[tuple[int, str, Claim]]:
        """Claims that the simulator perceived, oldest first: tick, speaker, claim.

        A claim that names half of a chest known as double is about the whole one.
        """
        state = self._recording.state(self._path, self._tick)
        return [
            (event.tick, event.actor, claim.of_whole(state.container_at))
            for event in state.perceived
            if event.actor is not None
            for claim in claims_from_plain(event.detail.get("claims", []))
        ]

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
        """Infer an agent's desires and beliefs from its course in this simulator.

        Args:
            model: The hypotheses.
            since: First tick of the evidence.
            until: Last tick of the evidence; None: the tick that the simulator shows.
            ended: True if the agent acted, after the last tick, on the goal at its position.
            smooth: True if marginals of `cell` and `credence_now` use later evidence too.

        Raises:
            InputError: The model does not fit: no goal can be reached in any alternative, no
                alternative agrees with the simulator, or the agent was never seen.
            PathError: There is no such agent.
            TickError: A tick is in the future or before the start.
        """
        last = self._tick if until is None else tick_of(until)
        asked = (self._recording, self._path, model, tick_of(since), last)
        inference: Inference = part("infer")(*asked, ended=ended, smooth=smooth)
        return inference

    @in_turn
    def imagine(
        self,
        since: int,
        until: int | None = None,
        *,
        actors: "Mapping[str, Mapping[str, object]]",
        n: int = 200,
        seed: int = 0,
        weights: Mapping[str, Mapping[str, float]] | None = None,
        evidence: Sequence[Mapping[str, Any]] | None = None,
        tolerance: tuple[int, int] = (0, 0),
        on_progress: Callable[[str, int, int], None] | None = None,
    ) -> "Imagined":
        """Draw possible courses of unseen events as weighted histories, without recording them.

        Each history is a fork of this simulator at `since`, in a scripted world of its own. Each
        actor follows one of its candidates. Other agents repeat the acts that this simulator
        knows of them. A history counts if the owner of this belief would have had the same
        percepts in it; see docs/imagine.md.

        Args:
            since: Tick at which histories begin.
            until: Tick at which they end; None: the tick that the simulator shows.
            actors: Candidates by name, by agent. A candidate is a program (JavaScript; empty:
                nothing), a `MindModel` of that agent, or a policy: a function that takes the
                agent's simulator in the history and returns its next program. A policy with a
                parameter `random` gets a `random.Random` by it, seeded for each history.
            n: Number of histories to draw; the result has those that agree.
            seed: Seed of every random choice.
            weights: Probabilities of candidates by name, by agent; None: uniform.
            evidence: Conditions at `until` that replace the percepts as evidence, in the language
                of goals, each with an optional probability of being `mistaken`.
            tolerance: Number of cells by which positions of agents may differ, and number of ticks
                by which events may come earlier or later.
            on_progress: Function of a description, the number of ticks done, and of all ticks.

        Raises:
            InputError: An argument has the wrong form, an actor's position is unknown, or a
                candidate's program has a syntax error.
            PathError: There is no such agent.
            TickError: A tick is in the future or before the start, or `since` is after `until`.
        """
        last = self._tick if until is None else until
        asked = (since, last, actors, n, seed, weights, evidence, tolerance)
        imagine = part("imagine")
        imagined: Imagined = imagine(
            self._recording, self._path, asked, (HistorySimulator, self._live_on), on_progress
        )
        return imagined

    def _live_on(self, recording: Recording) -> Any:
        """Return the simulator, able to act, on other timelines."""
        raise InputError(
            f"{self.path} is only read, so that nothing can go on in its histories; imagine in an "
            "open nest, which Nest.resume gives for a recorded run, and fork there"
        )

    @in_turn
    def credence(
        self,
        agent: str,
        doubt: "Mapping[str, Any]",
        initial: "npt.ArrayLike | None" = None,
        tick: int | None = None,
        *,
        since: int = 0,
        actual: str | Mapping[str, float] | None = None,
        lapse: float = 0.0,
    ) -> dict[str, float]:
        """Return the credence that this simulator attributes to an agent, from its percepts alone.

        Args:
            agent: Name of the agent.
            doubt: Alternatives by name, as for `MindModel`.
            initial: Probabilities of the alternatives just before the percept at `since`; None:
                uniform.
            tick: Tick of the credence; None: the tick that the simulator shows.
            since: Tick of the first percept that counts.
            actual: The actual alternative, as for `MindModel`.
            lapse: As for `MindModel`.

        Returns:
            Probabilities by name of the alternative.

        Raises:
            InputError, PathError, TickError: As for `infer`.
        """
        last = self._tick if tick is None else tick_of(tick)
        asked = (self._recording, self._path, agent, doubt, initial, actual, lapse)
        credence: dict[str, float] = part("credence")(*asked, tick_of(since), last)
        return credence

    @property
    @in_turn
    def placed(self) -> Placements:
        """The differences between the belief and its body.

        A belief may be physically impossible: an agent in a doorway whose door is now believed
        shut, two agents in one place, a diamond in a block that is unknown or no container. The
        belief stays as it is. In its body agents begin at the nearest place where they can stand,
        and a chest stands wherever contents are believed that the block cannot hold.

        By agent name: (believed place, first place in the body), feet in blocks, as the body began.
        By position of a chest: (believed block or None, "chest"), as of now. Empty in follow mode,
        and where nothing had to be changed.
        """
        return placed_in(self._recording, self._path, self._tick)

    @abstractmethod
    def child(self, agent: str) -> Self:
        """Return the simulator of the belief that `agent` has in this one."""

    @in_turn
    def visible_blocks(self, agent: str) -> npt.NDArray[np.bool_]:
        """Return a mask of the blocks that an agent sees from its pose in this simulator.

        Returns:
            bool, shape of the box; all False if the agent's pose is unknown.

        Raises:
            PathError: There is no such agent.
        """
        self._child_path(agent)
        recording = self._recording
        return visible_from(recording.state(self._path, self._tick), recording.context.sight, agent)

    def figure(
        self,
        against: str | None = None,
        *,
        sight: Sequence[str] | None = None,
        height: int | None = None,
        inference: "Inference | None" = None,
        steps: int = 5,
    ) -> "Figure":
        """Return a drawing of the simulator's state; see `Nest.figure`."""
        with self._recording.turn:
            scenes = part("drawing").scenes_of(self._recording, [self], against, sight, height)
            figure: Figure = part("drawing").figure_with(scenes, inference, steps, self._tick)
            return figure

    def __repr__(self) -> str:
        recording = self._recording
        try:
            with recording.turn:
                key = recording.selected.get(self._path)
                state = self.state
                wrong = [_named(each, recording) for each in self.otherwise(())]
                words = state_words(state)
        except BeliefNestError as error:
            # As in `ShownNest.__repr__`.
            return f"<simulator {self.path}: {error}>"
        mode = "follow mode" if key is None else f"branch {key.branch}"
        false = f"; false: {', '.join(wrong)}" if wrong else ""
        return f"<simulator {self.path}, {mode}, tick {state.tick}: {words}{false}>"

    def _repr_html_(self) -> str:
        return self.figure()._repr_html_()

    def otherwise(self, against: BeliefPath) -> Sequence[Difference]:
        """Return the false beliefs of this simulator (`b`) against another (`a`).

        The other one is read at this tick, or at its latest one if that is earlier.
        """
        recording, path, tick = self._recording, self._path, self._tick
        if path == against:
            return []
        then = None if tick is None else min(tick, recording.info(against).head)
        return false_beliefs(recording, path, tick, against, then)

    def _child_path(self, agent: str) -> BeliefPath:
        agents = self._recording.agents
        if agent not in agents:
            raise PathError(f"there is no agent {agent!r}; the agents are {', '.join(agents)}")
        return normalised((*self._path, agent))


def _viewed(value: object) -> object:
    """Return a variable of a template, with views in place of simulators."""
    if isinstance(value, ShownSimulator):
        return value.view
    if isinstance(value, Mapping):
        return {key: _viewed(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_viewed(each) for each in value]
    return value


class PastSimulator(ShownSimulator):
    """Read-only simulator at a past tick, or at its latest tick (None)."""

    def __init__(self, recording: Recording, path: BeliefPath, tick: int | None) -> None:
        super().__init__(recording, path)
        self._tick = tick

    def child(self, agent: str) -> "PastSimulator":
        """Return the simulator of the belief that `agent` had in this one."""
        return PastSimulator(self._recording, self._child_path(agent), self._tick)


class HistorySimulator(PastSimulator):
    """Read-only simulator in a history; belief paths start at its own path."""

    def at(self, tick: int) -> "HistorySimulator":
        """Return the simulator at another tick.

        Raises:
            TickError: The tick is after the end of the history, or before the start of the run.
        """
        then = self._recording.moment(self._path, tick_of(tick)).tick
        return HistorySimulator(self._recording, self._path, then)

    def __getitem__(self, path: str) -> "HistorySimulator":
        """Return a belief in it at the same tick; `/` is itself."""
        within = normalised((*self._path, *parse_path(path, self._recording.agents)))
        return HistorySimulator(self._recording, within, self._tick)


class ShownNest:
    """Read-only methods of a nest: live, recorded, or at a past tick.

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
        """Return a drawing of simulators side by side, each from its own state.

        Args:
            paths: Belief paths, or a single one.
            tick: Tick to draw; None: the latest.
            against: Path with which they are compared, to mark false beliefs; None: the real world.
            sight: Agents whose sight is shown in each drawing; None: the belief's owner.
            height: Storey to draw, as the y of blocks on its floor; None: the storey of most
                containers, or of most agents.
            inference: Posterior to draw as bars beside the plans, at the tick of the figure. Cells
                of the plans are tinted by the probability that the agent will be there.
            steps: Number of actions after which it will be there.

        Raises:
            TickError: The tick is in the future or before the start, of the nest or the inference.
            InputError: There is no path, the height lies outside the box, or steps is below 1.
        """
        scenes = self.scenes(paths, tick, against, sight=sight, height=height)
        then = self._tick if tick is None else tick
        figure: Figure = part("drawing").figure_with(scenes, inference, steps, then)
        return figure

    def scenes(
        self,
        paths: str | Sequence[str] = "/",
        tick: int | None = None,
        against: str | None = None,
        *,
        sight: Sequence[str] | None = None,
        height: int | None = None,
    ) -> "tuple[Scene, ...]":
        """Return the scenes that `figure` draws, as values, with the same arguments and errors."""
        wanted = [paths] if isinstance(paths, str) else list(paths)
        then = self._tick if tick is None else tick
        recording = self._recording
        with recording.turn:
            names = [parse_path(path, recording.agents) for path in wanted]
            shown = [PastSimulator(recording, path, then) for path in names]
            scenes_of = part("drawing").scenes_of
            scenes: tuple[Scene, ...] = scenes_of(recording, shown, against, sight, height)
            return scenes

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
        """Return a plot of beliefs over time: a row for each simulator, a band for each value.

        False bands are marked. Above the rows stand the acts in the real world that concern the
        thing, and the claims about it. Above each row a balloon stands for each claim that was
        heard, struck out if it was not believed. The plot follows the contents of a container, an
        item wherever it is, a block, the position of an agent, or with `agent` and `item` the
        number of items that the agent has.

        Args:
            container: Position of the container to follow.
            item: The item to follow. Without a container or agent it is followed in all containers
                and with all agents. None: all contents of the container, or the agent's position.
            paths: Belief paths of the simulators.
            agent: Name of the agent to follow.
            block: Position of the block to follow.

        Raises:
            PathError: There is no such agent.
            PositionError: The container or block lies outside the box.
            InputError: There is no path, there is not exactly one thing to follow, or there never
                was a container at the position.
            UnknownNameError: There is no such item.
        """
        followed = (container, item, agent, block)
        figure: Figure = part("plotting").plot_of(self._recording, followed, paths, self._tick)
        return figure

    @in_turn
    def compare(self, a: str, b: str, *, unknown: bool = True) -> list[Difference]:
        """Return the differences between two simulators: blocks, containers, poses, inventories.

        Args:
            a: Belief path of one simulator.
            b: Belief path of the other.
            unknown: True to list elements that one of them does not know or have.

        Raises:
            TickError: The tick of this view is in the future or before the start.
        """
        recording = self._recording
        one, other = parse_path(a, recording.agents), parse_path(b, recording.agents)
        return compare(recording, one, other, self._tick, unknown=unknown)

    @in_turn
    def false_beliefs(self, path: str) -> list[Difference]:
        """Return the false beliefs of a simulator; the real world is `a`. Unknown is not false.

        Contents are false if they have items that are not there, or if they count as complete and
        lack some. The position of an agent is false if it is off by half a block or
        more. Angles do not count.

        Raises:
            TickError: The tick of this view is in the future or before the start.
        """
        names = parse_path(path, self._recording.agents)
        return false_beliefs(self._recording, names, self._tick)

    @in_turn
    def claims(self, path: str = "/") -> list[MadeClaim]:
        """Return all claims that were made in a simulator, oldest first.

        Each claim has its tick, text, speaker and hearers. It says if it was false, if it was a
        lie, and for any belief if that took it up and why.

        Args:
            path: Belief path. A simulator in control mode has claims of its own world.
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
            # Printing a closed nest, or a tick that does not exist, must not raise.
            return f"<nest of {recording.setting.name}: {error}>"
        shown = f"<nest of {recording.setting.name} at tick {state.tick}"
        return f"{shown}, {branches} timeline{'s' * (branches > 1)}: {words}>"

    def _repr_html_(self) -> str:
        return self.figure()._repr_html_()


class Past(ShownNest):
    """Read-only nest at one past tick."""

    def __init__(self, recording: Recording, tick: int) -> None:
        self._recording = recording
        self._tick = tick

    def __getitem__(self, path: str) -> PastSimulator:
        """Return the simulator of a belief path as it was."""
        return PastSimulator(self._recording, parse_path(path, self._recording.agents), self._tick)


def _named(wrong: Difference, recording: Recording) -> str:
    """Return the element of a false belief in words, with the name that people have for it."""
    if isinstance(wrong.where, str):
        is_owned = wrong.kind == "inventory"
        return f"what {wrong.where} has" if is_owned else f"where {wrong.where} is"
    return recording.setting.labels.get(wrong.where, point_words(wrong.where))
