"""Imagined histories: weighted possible courses of events, and branches of them."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from beliefnest.belief.view import State
from beliefnest.errors import BranchError, InputError, PathError, StoreError
from beliefnest.facts.kinds import Heard, StatedFact
from beliefnest.facts.states import Facts, StateFacts
from beliefnest.minds.imagining.courses import Course
from beliefnest.minds.imagining.history_starts import HistoryStarts
from beliefnest.minds.imagining.imagine_arguments import Evidence, goal_conditions
from beliefnest.minds.imagining.particles import HistoryDraws, Lost, Particle
from beliefnest.nest.face.given import check_branch_name, whole
from beliefnest.nest.past.recording import Recording
from beliefnest.nest.past.summed_state import StateSums
from beliefnest.nest.past.timeline_state import TimelineState
from beliefnest.owned import Barred
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath, normalised, path_text
from beliefnest.world.values import Point
from beliefnest.world.words import counted
from beliefnest.worlds.scripted.world_facts import WorldFacts

if TYPE_CHECKING:  # These take long to import, and few histories are drawn or listed.
    import pandas as pd

    from beliefnest.pictures.figure import Figure


PastFace = Callable[[Recording, BeliefPath, int | None], Any]
"""Function that makes the read-only simulator of a path at a tick, in which users see histories."""


class History(Barred):
    """Possible course of events, as a branch that is not recorded.

    Belief paths are those inside the history: `/` is its world, `/bob` is Bob's belief in it.

    Attributes:
        number: Number of the history among those that were drawn.
        weight: Probability of the history, given that one of the drawn ones is true.
    """

    _called = "the imagined history"

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
        """The last tick of the history."""
        return self._course.tick

    @property
    def state(self) -> State:
        """The state of the history's world at its end."""
        state: State = self["/"].state
        return state

    def at(self, tick: int) -> Any:
        """Return the history's world at a tick; `at(tick)["/bob"]` is a belief in it.

        Raises:
            TickError: The tick is after the end of the history, or before the start of the run.
        """
        return self["/"].at(tick)

    def feet(self, agent: str) -> dict[int, Point]:
        """Return the feet of an agent at every tick from `since` at which the history has it.

        It reads the course itself, so it is far faster than `at` for each tick.

        Raises:
            PathError: There is no such agent.
        """
        imagined, course = self._imagined, self._course
        agents = imagined._recording.agents
        if agent not in agents:
            raise PathError(f"no agent {agent!r}; there are {', '.join(agents)}")
        first = imagined._starts.of(course.drawn).agents.get(agent)
        placed: dict[int, Point | None] = {}
        if first is not None:
            placed[imagined.since] = first.position
        for entry in course.entries:
            if isinstance(entry, Frame) and agent in entry.agents:
                state = entry.agents[agent]
                placed[entry.tick] = None if state is None else state.position
        feet_by_tick: dict[int, Point] = {}
        feet = None
        for tick in range(imagined.since, course.tick + 1):
            feet = placed.get(tick, feet)
            if feet is not None:
                feet_by_tick[tick] = feet
        return feet_by_tick

    def __getitem__(self, path: str) -> Any:
        """Return a simulator at the end of the history; `/` is the history's world."""
        imagined = self._imagined
        recording = imagined._recorded(self._course)
        return imagined._past(recording, imagined._path, self.tick)[path]

    def figure(self, against: str | None = None) -> "Figure":
        """Draw the end of the history; mark differences from a belief of the nest, if given."""
        figure: Figure = self["/"].figure(against)
        return figure

    def fork(self, name: str = "fork") -> Any:
        """Return a simulator that continues the history on a branch, in a scripted world.

        Programs run in it as in other simulators; the nest records nothing of it.

        Args:
            name: Name of the branch, which stays with the histories.

        Raises:
            InputError: The nest is only read.
            BranchError: The name is not allowed.
        """
        recording = self._imagined._recorded(self._course)
        own = recording.on(recording.selected[self._imagined._path])
        simulator = self._imagined._live(own)
        simulator.switch(name)
        return simulator

    def keep(self, name: str) -> None:
        """Record the history in the nest as a branch; see `Imagined.keep`."""
        self._imagined.keep(self.number, name)

    def __repr__(self) -> str:
        names = ", ".join(f"{agent}: {name or '-'}" for agent, name in self.candidates.items())
        return f"<history {self.number}, weight {self.weight:.3g}, tick {self.tick}: {names}>"


class Imagined(Barred):
    """Weighted histories of a simulator, drawn by `imagine`.

    If no history agrees with the percepts, `impossible` names the tick at which the last ones
    stopped agreeing. The result then contains these, as they were at that tick.

    Attributes:
        since: The tick at which they begin.
        until: The tick at which they end.
        n: Number of drawn histories.
        impossible: When and why the last ones stopped agreeing; None: some agree.
        log_evidence: Estimated natural logarithm of the probability of the percepts.
    """

    _called = "the set of imagined histories"

    def __init__(
        self,
        recording: Recording,
        path: BeliefPath,
        base: ForkPoint,
        drawing: HistoryDraws,
        starts: HistoryStarts,
        until: int,
        side: Recording,
        past: PastFace,
        live: Callable[[Recording], Any],
    ) -> None:
        self._recording, self._path, self._base = recording, path, base
        self._starts, self._side, self._past, self._live = starts, side, past, live
        self._drawing = drawing
        self.since, self.until, self.n = base.tick, until, len(drawing.drawn)
        self.impossible: Lost | None = drawing.lost
        self.log_evidence = -math.inf if drawing.lost is not None else drawing.log_evidence
        self._particles = [each for each in drawing.particles if each.weight > 0]
        self._read: dict[Course, Recording] = {}
        self._begun: dict[tuple[int, ...], TimelineState] = {}

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
        """The effective number of histories that were different at the first tick.

        0 if none agrees with the percepts.
        """
        return 0.0 if self.impossible is not None else self._drawing.effective_size

    def share(self, condition: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> float:
        """Return the probability that a condition, or all of several, holds in the end.

        Args:
            condition: As in goals: `{"container": place, "items": {name: count}}`, `{"agent": name,
                "at": place}`, `{"block": place, "state": text}` and so on. Its `path` is inside
                the history: `/` is the history's world.

        Raises:
            InputError, PathError, UnknownNameError: The condition is malformed.
        """
        wanted = goal_conditions(self._recording, condition)
        with self._recording.turn:
            holds: dict[Course, bool] = {}
            for particle in self._particles:
                if particle.course not in holds:
                    holds[particle.course] = self._holds(particle.course, wanted)
        return math.fsum(each.weight for each in self._particles if holds[each.course])

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
        faults: dict[str, dict[str, str]] = {}
        for (agent, name), fault in self._drawing.plan.failures.items():
            faults.setdefault(agent, {})[name] = str(fault)
        return faults

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
            if journal.has(key):
                raise BranchError(
                    f"{path_text(self._path)} already has a branch {name!r}; choose another name"
                )
            with journal.together():
                self._append(journal, key, course)

    def __repr__(self) -> str:
        head = (
            f"<{counted(self.n, 'history')} of {path_text(self._path)}, ticks {self.since} to "
            f"{self.until}"
        )
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

    def _recorded(self, course: Course) -> Recording:
        """Return timelines with the course on one of its own, beside those of the nest."""
        recording = self._read.get(course)
        if recording is None:
            key = TimelineKey(self._path, f"history {len(self._read)}")
            self._append(self._side.journal, key, course)
            recording = self._read[course] = self._side.on(key)
            recording.sums = {self._path: self._sums(key, course)}
        return recording

    def _sums(self, key: TimelineKey, course: Course) -> StateSums:
        """Return the sums of a course; courses with the same alternatives share their beginning."""
        first = self._side.journal.info(key).entries - len(course.entries)
        if course.drawn not in self._begun:
            state = self._side.history.state(key, self._path, first, self.since)
            self._begun[course.drawn] = state
        return StateSums(self._begun[course.drawn], key, first, course.entries, course.tick)

    def _append(self, journal: Journal, key: TimelineKey, course: Course) -> None:
        """Add a course to a journal as a timeline of its own."""
        journal.create(key, self._base, self._base.tick)
        journal.append(key, self._starts.entries(course), course.tick)

    def _holds(self, course: Course, wanted: Sequence[StatedFact]) -> bool:
        is_about_speech = any(isinstance(each.fact, Heard) for each in wanted)

        def look(path: BeliefPath) -> Facts:
            inside = normalised((*self._path, *path))
            if inside == self._path and not is_about_speech:
                return WorldFacts(course.world)
            return StateFacts(self._recorded(course).state(inside))

        return all(condition.holds(look) for condition in wanted)


def weigh(imagined: Imagined, evidence: Evidence) -> None:
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
