"""Imagination of unseen events: weighted histories that explain an owner's percepts."""

import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np

from beliefnest.belief.columns import cell_of
from beliefnest.belief.condition_form import condition_entry, conditions_of
from beliefnest.belief.conditions import GoalCondition, GoalFacts, StateFacts
from beliefnest.belief.view import State
from beliefnest.errors import BranchError, InputError, PathError, StoreError, TickError
from beliefnest.minds.mind_model import MindModel
from beliefnest.minds.walking import Strategy
from beliefnest.nest.acting.course_agreement import Agreement, Tolerance, Witness
from beliefnest.nest.acting.courses import Candidate, Course, CoursePlan, PolicyProgram
from beliefnest.nest.acting.particles import Drawing, Drawn, Lost, Particle, spread
from beliefnest.nest.acting.script import Progress
from beliefnest.nest.acting.starting import start_of
from beliefnest.nest.face.branch_names import check_branch_name
from beliefnest.nest.face.ticks import tick_of, whole
from beliefnest.nest.inferring.node_inference import ModelStart, start_of_model
from beliefnest.nest.past.percepts import Percept, percepts_of
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import Edit, ForkPoint, TimelineKey
from beliefnest.timeline.side import SideJournal
from beliefnest.world.frames import BlockGrid, Frame, Snapshot
from beliefnest.world.paths import BeliefPath, normalised, parse_path, path_text
from beliefnest.world.registry import Registry
from beliefnest.world.signs import plain_state
from beliefnest.world.values import AgentState, Block, Items, Point, Position
from beliefnest.worlds.scripted.world import ScriptedWorld

if TYPE_CHECKING:  # These take long to import, and few histories are drawn or listed.
    import pandas as pd

    from beliefnest.pictures.figure import Figure

__all__ = ["Faces", "History", "ImaginationWarning", "Imagined", "imagine_in"]

_FEW = 0.1
"""Share of the histories below which a small effective number raises a warning."""

_SUM_SLACK = 1e-9


class ImaginationWarning(UserWarning):
    """Warning that few histories explain the percepts."""


@dataclass(frozen=True, slots=True)
class Faces:
    """Functions that make the simulators in which users see histories.

    Attributes:
        past: Function that makes the read-only simulator of a path at a tick.
        live: Makes the simulator that histories are of, able to act, on other timelines.
    """

    past: Callable[[Recording, BeliefPath, int | None], Any]
    live: Callable[[Recording], Any]


@dataclass(frozen=True, slots=True)
class _WorldFacts:
    """The facts of a scripted world."""

    world: ScriptedWorld

    def items_in(self, place: Position) -> Items:
        return self.world.containers.get(place, {})

    def is_empty(self, place: Position) -> bool:
        return self.world.containers.get(place) == {}

    def items_of(self, agent: str) -> Items:
        state = self.world.agents.get(agent)
        return {} if state is None else state.inventory

    def feet_of(self, agent: str) -> Point | None:
        state = self.world.agents.get(agent)
        return None if state is None else state.position

    def block(self, place: Position) -> str | None:
        index = self.world.box.index(place)
        return Registry.load().text(int(self.world.blocks[index]))


class History:
    """Possible course of events, as a branch that is not recorded.

    Belief paths are those inside the history: `/` is its world, `/bob` is Bob's belief in it.

    Attributes:
        number: Number of the history among those that were drawn.
        weight: Probability of the history among them.
    """

    def __init__(self, imagined: "Imagined", number: int, particle: Particle) -> None:
        self.number, self.weight = number, particle.weight
        self._imagined, self._course = imagined, particle.course

    @property
    def candidates(self) -> Mapping[str, str]:
        """Names of the candidates that its agents followed."""
        return {name: each.name for name, each in self._course.candidates.items()}

    @property
    def hypotheses(self) -> Mapping[str, Mapping[str, float | str]]:
        """The drawn hypotheses by factor, for each agent whose candidate is a model."""
        return {
            name: each.strategy.told(self._course.draws[name])
            for name, each in self._course.candidates.items()
            if each.strategy is not None
        }

    @property
    def failed(self) -> Mapping[str, str]:
        """The reasons why programs failed, by agent."""
        return {name: str(fault) for name, fault in self._course.faults.items()}

    @property
    def tick(self) -> int:
        """Its latest tick."""
        return self._course.tick

    @property
    def state(self) -> State:
        """The state of the history's world at its end."""
        state: State = self["/"].state
        return state

    def at(self, tick: int) -> Any:
        """Return the history's world at a tick.

        Raises:
            TickError: The tick is after the end of the history, or before the start of the run.
        """
        recording = self._imagined._recorded(self._course)
        then = tick_of(tick)
        recording.moment(self._imagined._path, then)
        return self._imagined._faces.past(recording, self._imagined._path, then)

    def __getitem__(self, path: str) -> Any:
        """Return a simulator of it in the end; `/` is what is the case in it."""
        recording = self._imagined._recorded(self._course)
        whole_path = self._imagined._within(path)
        return self._imagined._faces.past(recording, whole_path, self._course.tick)

    def figure(self, against: str | None = None) -> "Figure":
        """Draw it as it is in the end; compared with a belief path of the nest, if one is given."""
        figure: Figure = self["/"].figure(against)
        return figure

    def fork(self, name: str = "fork") -> Any:
        """Return a simulator in which it goes on, on a branch of its own, in a scripted world.

        Programs run in it as in any other; nothing of it is recorded in the nest.

        Args:
            name: Name of the branch, which stays with the histories.

        Raises:
            InputError: The nest is only read.
            BranchError: The name is not allowed.
        """
        recording = self._imagined._recorded(self._course)
        own = recording.on(recording.selected[self._imagined._path])
        simulator = self._imagined._faces.live(own)
        simulator.switch(name)
        return simulator

    def keep(self, name: str) -> None:
        """Record it in the nest as a branch; see `Imagined.keep`."""
        self._imagined.keep(self.number, name)

    def __repr__(self) -> str:
        names = ", ".join(f"{agent}: {name or '-'}" for agent, name in self.candidates.items())
        return f"<history {self.number}, weight {self.weight:.3g}, tick {self.tick}: {names}>"


class Imagined:
    """Weighted histories of a simulator, drawn by `imagine`.

    If none agrees with what was perceived, `impossible` says at which tick the last one was lost;
    the histories are then those that were lost last, as they were at that tick.

    Attributes:
        since: The tick at which they begin.
        until: The tick at which they end.
        n: How many were drawn.
        impossible: When and why the last one was lost; None: some agree.
        log_evidence: Natural logarithm of the probability of what was perceived, estimated.
    """

    def __init__(
        self,
        recording: Recording,
        path: BeliefPath,
        base: ForkPoint,
        drawing: Drawing,
        starts: "_Starts",
        until: int,
        side: Recording,
        faces: Faces,
    ) -> None:
        self._recording, self._path, self._base = recording, path, base
        self._starts, self._side, self._faces = starts, side, faces
        self._drawing = drawing
        self.since, self.until, self.n = base.tick, until, len(drawing.drawn)
        self.impossible: Lost | None = drawing.lost
        self.log_evidence = -math.inf if drawing.lost is not None else drawing.log_evidence
        self._particles = [each for each in drawing.particles if each.weight > 0]
        self._keys: dict[Course, TimelineKey] = {}

    def __len__(self) -> int:
        return len(self._particles)

    def __getitem__(self, number: int) -> History:
        """Return one history."""
        index = whole(number)
        if index is None or not -len(self) <= index < len(self):
            raise InputError(f"no history {number!r}; there are {len(self)}, from 0")
        return History(self, index % len(self), self._particles[index])

    def __iter__(self) -> Iterator[History]:
        return (self[number] for number in range(len(self)))

    @property
    def weights(self) -> tuple[float, ...]:
        """Weights of the histories, which sum to 1."""
        return tuple(particle.weight for particle in self._particles)

    @property
    def effective_size(self) -> float:
        """The effective number of histories, counted as different ones at the first tick.

        0 if none agrees with what was perceived.
        """
        return 0.0 if self.impossible is not None else self._drawing.effective_size

    def share(self, condition: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> float:
        """Return the probability that a condition, or all of several, holds in the end.

        Args:
            condition: As in goals: `{"container": place, "items": {name: count}}`, `{"agent": name,
                "at": place}`, `{"block": place, "state": text}` and so on. Its `path` is one inside
                the histories: `/` is what is the case in them.

        Raises:
            InputError, PathError, UnknownNameError: The condition is malformed.
        """
        wanted = _conditions(self._recording, condition)
        with self._recording.turn:
            held: dict[Course, bool] = {}
            for particle in self._particles:
                if particle.course not in held:
                    held[particle.course] = self._holds(particle.course, wanted)
        return math.fsum(each.weight for each in self._particles if held[each.course])

    def by_candidate(self, agent: str) -> dict[str, float]:
        """Return the probability of each candidate of an agent.

        Raises:
            PathError: The agent had no candidates.
        """
        actors = self._starts.candidates
        if agent not in actors:
            raise PathError(f"{agent!r} had no candidates; those who had are {', '.join(actors)}")
        followed = [(each.course.candidates[agent].name, each.weight) for each in self._particles]
        return {
            name: math.fsum(weight for other, weight in followed if other == name)
            for name in actors[agent]
        }

    @property
    def failed(self) -> dict[str, dict[str, str]]:
        """The first reason why a candidate's program failed, by agent and candidate.

        Histories that were dropped count too.
        """
        found: dict[str, dict[str, str]] = {}
        for (agent, name), fault in self._drawing.plan.failures.items():
            found.setdefault(agent, {})[name] = str(fault)
        return found

    def frame(self) -> "pd.DataFrame":
        """Return the candidates of all histories.

        Returns:
            Columns history, weight, agent, candidate, failed (the reason, or None).
        """
        import pandas as pd

        rows = [
            (history.number, history.weight, agent, name, history.failed.get(agent))
            for history in self
            for agent, name in history.candidates.items()
        ]
        return pd.DataFrame(rows, columns=["history", "weight", "agent", "candidate", "failed"])

    def keep(self, number: int, name: str) -> None:
        """Record one history in the nest, as a branch of the simulator; nothing else is recorded.

        Raises:
            BranchError: The name is not allowed, or there is such a branch.
            StoreError: The run is only read; resume it to keep anything.
            InputError: There is no such history.
        """
        check_branch_name(name)
        recording, key = self._recording, TimelineKey(self._path, name)
        self[number]
        course = self._particles[number].course
        with recording.turn:
            journal = recording.journal
            if not journal.writable:
                raise StoreError(
                    "this run is only read, so that no history can be kept in it; open it with "
                    "Nest.resume and imagine there"
                )
            if any(info.key == key for info in journal.timelines()):
                raise BranchError(
                    f"{path_text(self._path)} already has a branch {name!r}; choose another name"
                )
            with journal.together():
                journal.create(key, self._base, self._base.tick)
                journal.append(key, self._starts.entries(course), course.tick)

    def __repr__(self) -> str:
        head = f"<{self.n} histories of {path_text(self._path)}, ticks {self.since} to {self.until}"
        for agent, named in self.failed.items():
            head += "".join(f", {agent} {name!r} failed ({why})" for name, why in named.items())
        if self.impossible is not None:
            return (
                f"{head}: none agrees with what was perceived; the last was lost at tick "
                f"{self.impossible.tick}>"
            )
        shares = [
            f"{agent} {name or repr(name)} {share:.3g}"
            for agent in self._starts.candidates
            for name, share in self.by_candidate(agent).items()
        ]
        return f"{head}, effective size {self.effective_size:.3g}: {', '.join(shares)}>"

    # Histories as branches

    def _within(self, path: str) -> BeliefPath:
        return normalised((*self._path, *parse_path(path, self._recording.agents)))

    def _recorded(self, course: Course) -> Recording:
        """Return timelines with the course on one of its own, beside those of the nest."""
        key = self._keys.get(course)
        if key is None:
            key = self._keys[course] = TimelineKey(self._path, f"history {len(self._keys)}")
            journal = self._side.journal
            journal.create(key, self._base, self._base.tick)
            journal.append(key, self._starts.entries(course), course.tick)
        return self._side.on(key)

    def _holds(self, course: Course, wanted: Sequence[GoalCondition]) -> bool:
        def look(path: BeliefPath) -> GoalFacts:
            inside = normalised((*self._path, *path))
            if inside == self._path:
                return _WorldFacts(course.world)
            return StateFacts(self._recorded(course).state(inside))

        return all(condition.holds(look) for condition in wanted)


@dataclass(frozen=True, eq=False)
class _Doubt:
    """A doubt that one or several models share."""

    elements: frozenset[tuple[str, object]]
    strategy: Strategy


@dataclass(eq=False)
class _Starts:
    """Beginnings of histories, by the alternatives drawn."""

    recording: Recording
    path: BeliefPath
    base: ForkPoint
    snapshot: Snapshot
    filled: Mapping[Position, Block]
    candidates: Mapping[str, Mapping[str, Candidate]]
    doubts: list[_Doubt] = field(default_factory=list)

    def of(self, drawn: tuple[int, ...]) -> Snapshot:
        """Return the beginning with the alternatives that were drawn."""
        blocks, contents, agents = self._edits(drawn)
        registry, snapshot = Registry.load(), self.snapshot
        if not (blocks or contents or agents):
            return snapshot
        grid = snapshot.blocks.copy()
        held = {place: dict(items) for place, items in snapshot.containers.items()}
        for place, block in blocks.items():
            state = max(0, plain_state(block))
            grid[snapshot.box.index(place)] = state
            if registry.is_container(registry.name(state)):
                held.setdefault(place, {})
            else:
                held.pop(place, None)
        chest = registry.state_id("chest")
        for place, items in contents.items():
            index = snapshot.box.index(place)
            if not registry.is_container(registry.name(int(grid[index]))):
                grid[index] = chest
            held[place] = dict(items)
        states = {**snapshot.agents, **agents}
        return replace(snapshot, blocks=grid, containers=held, agents=states)

    def entries(self, course: Course) -> list[Edit | Frame]:
        """Return what is recorded of a course."""
        blocks, contents, agents = self._edits(course.drawn)
        tick = self.base.tick
        entries: list[Edit | Frame] = []
        if agents:
            entries.append(Frame(tick, agents=agents))
        if blocks or contents:
            entries.append(Edit(tick, self.path, blocks, contents))
        return [*entries, *course.frames]

    def _edits(
        self, drawn: tuple[int, ...]
    ) -> tuple[dict[Position, Block], dict[Position, Items], dict[str, AgentState]]:
        registry = Registry.load()
        blocks: dict[Position, Block] = dict(self.filled)
        contents: dict[Position, Items] = {}
        agents: dict[str, AgentState] = {}
        for doubt, number in zip(self.doubts, drawn, strict=True):
            chosen = doubt.strategy.model.alternatives[number]
            blocks |= {place: registry.state_id(text) for place, text in chosen.blocks.items()}
            contents |= {place: dict(items) for place, items in chosen.containers.items()}
            for name, feet in chosen.agents.items():
                known = self.snapshot.agents.get(name)
                agents[name] = AgentState(feet) if known is None else replace(known, position=feet)
        return blocks, contents, agents


def imagine_in(
    recording: Recording,
    path: BeliefPath,
    since: int,
    until: int | None,
    actors: Mapping[str, Mapping[str, object]],
    n: int,
    seed: int,
    weights: Mapping[str, Mapping[str, float]] | None,
    evidence: Sequence[Mapping[str, Any]] | None,
    tolerance: tuple[int, int],
    on_progress: Progress | None,
    faces: Faces,
) -> Imagined:
    """Draw histories; see `ShownSimulator.imagine`."""
    checked = _Checked.of(recording, path, since, until, actors, n, seed, weights, tolerance)
    conditions = None if evidence is None else _evidence(recording, evidence)
    base, end = checked.base, checked.end
    journal, history = recording.journal, recording.history
    percepts = percepts_of(recording, path, base, end)
    # Blocks that the owner first sees later are taken to have been there all the time.
    believed = percepts[0][1]
    filled = _filled(recording, believed, percepts)
    snapshot = start_of(journal, history, path, base, has_physics=False).snapshot
    starts = _Starts(recording, path, base, snapshot, filled, {})
    side = Recording(
        recording.setting, SideJournal(journal), recording.seed, recording.renderer, "scripted"
    )
    side.selected = dict(recording.selected)
    side.records.set_run(recording.records.run())
    policies = _Policies(side, starts, path, faces)
    starts.candidates = {
        agent: {
            name: _candidate(recording, path, base, end, agent, name, given, starts, policies)
            for name, given in named.items()
        }
        for agent, named in actors.items()
    }
    for agent in actors:
        if agent not in snapshot.agents:
            raise InputError(
                f"where {agent} was at tick {base.tick} is not known in {path_text(path)}; imagine "
                "from a tick at which it was seen"
            )
    owner = path[-1] if path else None
    plan = CoursePlan(
        tuple(actors),
        [percept for percept, _ in percepts],
        recording.setting.perception.speech_ticks,
        starts.of,
    )
    agreement = None
    if conditions is None:
        witness = _witness(recording, path, base, starts, plan, owner, checked.tolerance)
        agreement = Agreement(witness)
    drawing = Drawing(plan, _drawn(starts, checked, seed), agreement, seed)
    tell = on_progress or _say_nothing
    drawing.run(end.tick, lambda done, total: tell("imagining histories", done, total))
    imagined = Imagined(recording, path, base, drawing, starts, end.tick, side, faces)
    if conditions is not None:
        _weigh(imagined, conditions)
    _warn(imagined)
    return imagined


@dataclass(frozen=True)
class _Checked:
    """Arguments of a call, checked."""

    base: ForkPoint
    end: ForkPoint
    n: int
    weights: Mapping[str, Sequence[float]]
    tolerance: Tolerance

    @classmethod
    def of(
        cls,
        recording: Recording,
        path: BeliefPath,
        since: int,
        until: int | None,
        actors: Mapping[str, Mapping[str, object]],
        n: int,
        seed: int,
        weights: Mapping[str, Mapping[str, float]] | None,
        tolerance: tuple[int, int],
    ) -> "_Checked":
        begin = tick_of(since)
        end = recording.moment(path, None if until is None else tick_of(until))
        if begin > end.tick:
            raise TickError(
                f"since is {begin}, after until, which is {end.tick}; histories go forward"
            )
        first = recording.journal.info(recording.stretches(end)[0].timeline).start
        begin = max(begin, first) if begin == 0 else begin
        key, entries = recording.place_of(end.timeline, begin)
        count = whole(n)
        if count is None or count < 1:
            raise InputError(f"n is {n!r}; give a whole number from 1")
        if whole(seed) is None:
            raise InputError(f"seed is {seed!r}; give a whole number")
        if not isinstance(actors, Mapping) or not actors:
            raise InputError(f"actors is {actors!r}; give candidates by name, by agent")
        for agent, named in actors.items():
            if agent not in recording.agents:
                raise PathError(f"no agent {agent!r}; there are {', '.join(recording.agents)}")
            if not isinstance(named, Mapping) or not named:
                raise InputError(f"the candidates of {agent} are {named!r}; give them by name")
        return cls(
            ForkPoint(key, entries, begin),
            end,
            count,
            _weights(actors, weights or {}),
            _tolerance(tolerance),
        )


def _tolerance(given: object) -> Tolerance:
    parts = [whole(part) for part in given] if isinstance(given, Sequence) else []
    if len(parts) != 2 or any(part is None or part < 0 for part in parts):
        raise InputError(f"tolerance is {given!r}; give (cells, ticks), whole numbers from 0")
    return Tolerance(int(parts[0] or 0), int(parts[1] or 0))


def _weights(
    actors: Mapping[str, Mapping[str, object]], given: Mapping[str, Mapping[str, float]]
) -> Mapping[str, Sequence[float]]:
    if not isinstance(given, Mapping):
        raise InputError(f"weights are {given!r}; give weights by candidate, by agent")
    for agent in given:
        if agent not in actors:
            raise PathError(f"weights name {agent!r}, who has no candidates")
    found: dict[str, Sequence[float]] = {}
    for agent, named in actors.items():
        mine = given.get(agent)
        if mine is None:
            found[agent] = [1 / len(named)] * len(named)
            continue
        if not isinstance(mine, Mapping):
            raise InputError(f"the weights of {agent} are {mine!r}; give them by candidate")
        unknown = [str(name) for name in mine if name not in named]
        if unknown:
            raise InputError(
                f"weights of {agent} name {', '.join(unknown)}; the candidates are "
                f"{', '.join(map(repr, named))}"
            )
        listed = [mine.get(name, 0.0) for name in named]
        if not all(_is_weight(weight) for weight in listed):
            raise InputError(f"weights of {agent} are {dict(mine)!r}; give numbers from 0")
        total = math.fsum(listed)
        if abs(total - 1) > _SUM_SLACK:
            raise InputError(f"the weights of {agent} sum to {total:.6g}; let them sum to 1")
        found[agent] = listed
    return found


def _is_weight(value: object) -> bool:
    return (
        isinstance(value, int | float)
        and not isinstance(value, bool)
        and math.isfinite(value)
        and value >= 0
    )


def _candidate(
    recording: Recording,
    path: BeliefPath,
    base: ForkPoint,
    end: ForkPoint,
    agent: str,
    name: str,
    given: object,
    starts: _Starts,
    policies: "_Policies",
) -> Candidate:
    if isinstance(given, str):
        return Candidate(name, program=given)
    if isinstance(given, MindModel):
        if given.agent != agent:
            raise InputError(
                f"candidate {name!r} of {agent} is a model of {given.agent}; give one of {agent}"
            )
        start = start_of_model(recording, path, given, base.tick, end.tick)
        return Candidate(name, strategy=_strategy(recording, start, starts, name))
    if callable(given):
        return Candidate(name, policy=policies.of(given, agent, name))
    raise InputError(
        f"candidate {name!r} of {agent} is {given!r}; give a program (text), a MindModel, or a "
        "policy (a function from the agent's simulator to a program)"
    )


def _strategy(recording: Recording, start: ModelStart, starts: _Starts, name: str) -> Strategy:
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
    for known in starts.doubts:
        same = known.strategy.model
        if elements & known.elements and (
            [repr(each) for each in same.alternatives]
            != [repr(each) for each in start.model.alternatives]
            or same.actual_weights != start.model.actual_weights
        ):
            raise InputError(
                f"candidate {name!r} of {start.model.agent} and one of {same.agent} doubt the same "
                "elements in different ways; give both the same doubt and the same actual"
            )
    if elements and not any(elements == known.elements for known in starts.doubts):
        starts.doubts.append(_Doubt(elements, strategy))
    return strategy


@dataclass(eq=False)
class _Policies:
    """Policies as programs: shows each policy the course so far."""

    side: Recording
    starts: _Starts
    path: BeliefPath
    faces: Faces
    _keys: dict[Course, tuple[TimelineKey, int]] = field(default_factory=dict)

    def of(self, policy: Callable[..., object], agent: str, name: str) -> PolicyProgram:
        """Return what asks a policy for the next program."""

        def program(course: Course, actor: str) -> str:
            simulator = self._shown(course, actor)
            code = policy(simulator)
            if not isinstance(code, str):
                raise InputError(
                    f"policy {name!r} of {agent} returned {code!r}; return a program, or an empty "
                    "text to do nothing more"
                )
            return code

        return program

    def _shown(self, course: Course, agent: str) -> Any:
        journal = self.side.journal
        known = self._keys.get(course)
        entries = self.starts.entries(course)
        if known is None:
            key = TimelineKey(self.path, f"drawing {len(self._keys)}")
            journal.create(key, self.starts.base, self.starts.base.tick)
            known = (key, 0)
        key, written = known
        journal.append(key, entries[written:], course.tick)
        self._keys[course] = (key, len(entries))
        recording = self.side.on(key)
        return self.faces.past(recording, normalised((*self.path, agent)), course.tick)


def _filled(
    recording: Recording, believed: BlockGrid, percepts: Sequence[tuple[Percept, BlockGrid]]
) -> dict[Position, Block]:
    """Return blocks that were unknown at first, as they were when they were seen first."""
    unknown = believed < 0
    if not unknown.any():
        return {}
    filled: dict[Position, Block] = {}
    box = recording.box
    for _, blocks in percepts[1:]:
        new = np.argwhere(unknown & (blocks >= 0))
        for index in new.tolist():
            i, j, k = index
            x, y, z = box.low
            filled[x + i, y + j, z + k] = int(blocks[i, j, k])
        unknown &= blocks < 0
    return filled


def _witness(
    recording: Recording,
    path: BeliefPath,
    base: ForkPoint,
    starts: _Starts,
    plan: CoursePlan,
    owner: str | None,
    tolerance: Tolerance,
) -> Witness:
    ignored: set[int] = set()
    contents: set[Position] = set()
    doubted: set[Position] = set()
    for doubt in starts.doubts:
        alternative = doubt.strategy.model.alternatives[0]
        doubted |= set(alternative.containers)
        if doubt.strategy.model.actual is not None:
            ignored |= {cell_of(recording.box, place) for place in alternative.blocks}
            contents |= set(alternative.containers)
    view = recording.history.reading(base.timeline, path, base.entries)
    unknown = {
        place
        for percept in plan.percepts
        for place in percept.contents
        if place not in view.containers or not view.containers[place].complete
    }
    return Witness(
        owner,
        plan.percepts,
        plan.agents,
        frozenset(ignored),
        frozenset(contents),
        frozenset(unknown - doubted),
        tuple(view.items.values()),
        recording.box,
        recording.context.sight,
        tolerance,
    )


def _drawn(starts: _Starts, checked: _Checked, seed: int) -> list[Drawn]:
    """Draw candidates, alternatives and hypotheses of all histories."""
    chosen: dict[str, list[Candidate]] = {}
    for agent, named in starts.candidates.items():
        chance = Random(f"{seed} candidates of {agent}")
        listed = list(named.values())
        numbers = spread(checked.weights[agent], checked.n, chance)
        chance.shuffle(numbers)
        chosen[agent] = [listed[number] for number in numbers]
    found = []
    for number in range(checked.n):
        chance = Random(f"{seed} {number} hypotheses")
        drawn = tuple(doubt.strategy.draw_actual(chance) for doubt in starts.doubts)
        actual = {doubt.elements: each for doubt, each in zip(starts.doubts, drawn, strict=True)}
        candidates = {agent: each[number] for agent, each in chosen.items()}
        draws = {
            agent: each.strategy.draw(
                chance, actual.get(each.strategy.model.alternatives[0].elements, 0)
            )
            for agent, each in candidates.items()
            if each.strategy is not None
        }
        found.append(Drawn(drawn, candidates, draws))
    return found


def _conditions(
    recording: Recording, given: Mapping[str, Any] | Sequence[Mapping[str, Any]]
) -> list[GoalCondition]:
    listed = [given] if isinstance(given, Mapping) else list(given)
    return [
        condition
        for each in listed
        for condition in conditions_of(
            condition_entry(each, recording.agents, recording.box), recording.agents
        )
    ]


def _evidence(
    recording: Recording, evidence: Sequence[Mapping[str, Any]]
) -> list[tuple[list[GoalCondition], float]]:
    if isinstance(evidence, Mapping) or not isinstance(evidence, Sequence) or not evidence:
        raise InputError(f"evidence is {evidence!r}; give a list of conditions, or None")
    found = []
    for each in evidence:
        if not isinstance(each, Mapping):
            raise InputError(f"evidence has {each!r}; give conditions as mappings")
        mistaken = each.get("mistaken", 0.0)
        if not _is_weight(mistaken) or mistaken > 1:
            raise InputError(f"mistaken is {mistaken!r}; give a probability")
        plain = {key: value for key, value in each.items() if key != "mistaken"}
        found.append((_conditions(recording, plain), float(mistaken)))
    return found


def _weigh(imagined: Imagined, evidence: Sequence[tuple[Sequence[GoalCondition], float]]) -> None:
    """Weigh histories by the probability of conditions at their end."""
    likely: dict[Course, float] = {}
    for particle in imagined._particles:
        course = particle.course
        if course not in likely:
            factor = 0.0 if course.contradiction is not None else 1.0
            for conditions, mistaken in evidence:
                holds = imagined._holds(course, conditions)
                factor *= 1 - mistaken if holds else mistaken
            likely[course] = factor
    total = math.fsum(each.weight * likely[each.course] for each in imagined._particles)
    if total <= 0:
        text = "no history leads to what the evidence says"
        imagined.impossible = Lost(imagined.until, text)
        imagined.log_evidence = -math.inf
        return
    for particle in imagined._particles:
        particle.weight *= likely[particle.course] / total
    imagined._particles = [each for each in imagined._particles if each.weight > 0]
    imagined.log_evidence += math.log(total)


def _warn(imagined: Imagined) -> None:
    for agent, named in imagined.failed.items():
        for name, why in named.items():
            warnings.warn(
                f"the program of candidate {name!r} of {agent} failed: {why}. From there on it "
                f"does nothing in that history, which counts all the same; correct the program, or "
                "look at history.failed",
                ImaginationWarning,
                stacklevel=5,
            )
    if imagined.impossible is not None:
        warnings.warn(
            f"none of {imagined.n} histories agrees with what was perceived: "
            f"{imagined.impossible}. "
            "Add a candidate that explains it, draw more histories, or allow a tolerance",
            ImaginationWarning,
            stacklevel=5,
        )
    elif imagined.effective_size < _FEW * imagined.n:
        warnings.warn(
            f"the effective size is {imagined.effective_size:.1f} of {imagined.n} histories: few "
            "explain what was perceived. Draw more histories, allow a tolerance, or add a "
            "candidate that explains it better",
            ImaginationWarning,
            stacklevel=5,
        )


def _say_nothing(what: str, done: int, total: int) -> None:
    """Progress that nobody asked for."""
