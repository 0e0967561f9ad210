"""Imagination of unseen events: weighted histories that explain an owner's percepts."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from inspect import signature
from random import Random
from typing import Any

import msgspec

from beliefnest.belief.columns import cell_of
from beliefnest.belief.view import State
from beliefnest.errors import InputError
from beliefnest.minds.imagining.course_agreement import Agreement, Tolerance, Witness
from beliefnest.minds.imagining.courses import Candidate, Course, CoursePlan, PolicyProgram
from beliefnest.minds.imagining.histories import Imagined, PastFace, weigh
from beliefnest.minds.imagining.history_starts import Doubt, HistoryStarts
from beliefnest.minds.imagining.imagine_arguments import Asked, Checked
from beliefnest.minds.imagining.particles import Drawn, HistoryDraws, spread
from beliefnest.minds.mind_model import MindModel
from beliefnest.minds.node_inference import ModelStart, start_of_model
from beliefnest.minds.walking import Strategy
from beliefnest.nest.acting.script import OnProgress
from beliefnest.nest.acting.starting import start_of
from beliefnest.nest.past.percepts import Percept, percepts_of
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.side import SideJournal
from beliefnest.world.paths import BeliefPath, normalised, path_text
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Block, Position, block_at
from beliefnest.world.words import counted

_FEW = 0.1
"""Share of the histories below which a small effective number raises a warning."""


class ImaginationWarning(UserWarning):
    """Warning that few histories explain the percepts."""


def imagine_in(
    recording: Recording,
    path: BeliefPath,
    arguments: tuple[Any, ...],
    faces: tuple[PastFace, Callable[[Recording], Any]],
    on_progress: OnProgress | None,
) -> Imagined:
    """Draw histories; see `ShownSimulator.imagine`.

    Args:
        recording: Recording of the nest.
        path: Path of the simulator that imagines.
        arguments: Values of `Asked`.
        faces: Functions that make the simulators of users: one to read at a tick, and one that can
            act, on the timelines of a history.
        on_progress: As for `ShownSimulator.imagine`.
    """
    asked, (past, live) = Asked(*arguments), faces
    checked = Checked.of(recording, path, asked)
    base, end = checked.base, checked.end
    journal, history = recording.journal, recording.history
    percepts = percepts_of(recording, path, base, end)
    # Blocks that the owner first sees later are taken to have been there all the time.
    believed = percepts[0][1]
    filled = _filled(recording, believed, percepts)
    snapshot = start_of(journal, history, path, base, has_physics=False).snapshot
    starts = HistoryStarts(recording, path, base, snapshot, filled, {})
    side = Recording(
        recording.setting, SideJournal(journal), recording.seed, recording.renderer, "scripted"
    )
    side.selected = dict(recording.selected)
    side.records.set_run(recording.records.run())
    policies = _HistoryPolicies(side, starts, path, past)
    candidates = _Candidates(recording, path, base, end, starts, policies, len(asked.actors) == 1)
    starts.candidates = {
        agent: {name: candidates.of(agent, name, policy) for name, policy in named.items()}
        for agent, named in asked.actors.items()
    }
    if absent := [agent for agent in asked.actors if agent not in snapshot.agents]:
        raise InputError(
            f"where {absent[0]} was at tick {base.tick} is not known in {path_text(path)}; imagine "
            "from a tick at which it was seen"
        )
    plan = CoursePlan(
        tuple(asked.actors),
        [percept for percept, _ in percepts],
        recording.setting.perception.speech_ticks,
        starts.of,
        _known_contents(history.state(base.timeline, path, base.entries), starts),
        lambda place: believed[recording.box.index(place)] < 0 and place not in filled,
    )
    agreement = None
    if checked.evidence is None:
        agreement = Agreement(_witness(recording, path, base, starts, plan, checked.tolerance))
    drawing = HistoryDraws(plan, _drawn(starts, checked, asked.seed), agreement, asked.seed)
    tell = on_progress or _say_nothing
    drawing.run(end.tick, lambda done, total: tell("imagining histories", done, total))
    imagined = Imagined(recording, path, base, drawing, starts, end.tick, side, past, live)
    if checked.evidence is not None:
        weigh(imagined, checked.evidence)
    _warn(imagined)
    return imagined


def _known_contents(view: State, starts: HistoryStarts) -> frozenset[Position]:
    """Return the containers whose contents a belief knows, or whose contents are drawn."""
    doubted = [each.strategy.model.alternatives[0].containers for each in starts.doubts]
    complete = {place for place, each in view.containers.items() if each.complete}
    return frozenset(complete.union(*doubted))


def _filled(
    recording: Recording, believed: Terrain, percepts: Sequence[tuple[Percept, Terrain]]
) -> dict[Position, Block]:
    """Return blocks that were unknown at first, as they were when they were seen first."""
    if believed.span[0] >= 0:
        return {}
    filled: dict[Position, Block] = {}
    x, y, z = recording.box.low
    draft = believed.draft()
    for _, blocks in percepts[1:]:
        new = blocks.differing(draft.terrain(), lambda after, before: (before < 0) & (after >= 0))
        for i, j, k in new.tolist():
            draft[i, j, k] = filled[x + i, y + j, z + k] = blocks[i, j, k]
    return filled


def _witness(
    recording: Recording,
    path: BeliefPath,
    base: ForkPoint,
    starts: HistoryStarts,
    plan: CoursePlan,
    tolerance: Tolerance,
) -> Witness:
    ignored: set[int] = set()
    contents: set[Position] = set()
    for doubt in starts.doubts:
        alternative = doubt.strategy.model.alternatives[0]
        if doubt.strategy.model.actual is not None:
            ignored |= {cell_of(recording.box, place) for place in alternative.blocks}
            contents |= set(alternative.containers)
    view = recording.history.state(base.timeline, path, base.entries)
    return Witness(
        path[-1] if path else None,
        plan.percepts,
        plan.agents,
        frozenset(ignored),
        frozenset(contents),
        tuple(view.items.values()),
        recording.box,
        recording.context.sight,
        tolerance,
    )


def _drawn(starts: HistoryStarts, checked: Checked, seed: int) -> list[Drawn]:
    """Draw candidates, alternatives and hypotheses of all histories."""
    chosen: dict[str, list[Candidate]] = {}
    for agent, named in starts.candidates.items():
        chance = Random(f"{seed} candidates of {agent}")
        listed = list(named.values())
        numbers = spread(checked.weights[agent], checked.n, chance)
        chance.shuffle(numbers)
        chosen[agent] = [listed[number] for number in numbers]
    drawn_starts = []
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
        drawn_starts.append(Drawn(drawn, candidates, draws))
    return drawn_starts


def _warn(imagined: Imagined) -> None:
    for agent, named in imagined.failed.items():
        for name, why in named.items():
            warnings.warn(
                f"the program of candidate {name!r} of {agent} failed: {why.rstrip('.')}. From "
                "there on it does nothing in that history, which counts all the same; correct the "
                "program, or look at history.failed",
                ImaginationWarning,
                stacklevel=5,
            )
    if imagined.impossible is not None:
        warnings.warn(
            f"none of {counted(imagined.n, 'history')} agrees with what was perceived: "
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
    """Report no progress."""


class _Candidates(msgspec.Struct, frozen=True):
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
    policies: "_HistoryPolicies"
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
class _HistoryPolicies:
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
