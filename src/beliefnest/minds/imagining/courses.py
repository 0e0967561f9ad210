"""Courses: possible continuations from a moment, each in a scripted world of its own.

Agents in question follow candidates: programs, policies or models of minds. All other agents repeat
their perceived actions. A course is a function of its start and its seeds, so it can be run again
up to any tick.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from random import Random
from typing import Any

import msgspec
import numpy as np
from msgspec.structs import replace

from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.errors import InputError, WorldError
from beliefnest.minds.walking import Draw, Open, Strategy, WalkAct, WalkChanges, Walker, WalkStep
from beliefnest.nest.past.percepts import DeedKey, Percept, deed_of
from beliefnest.timeline.journal import Edit, Entry
from beliefnest.world.event_kinds import AT_CONTAINERS, EventKind
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.signs import plain_state
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Items, Point, Position
from beliefnest.worlds.protocol import Fault, RunRules
from beliefnest.worlds.scripted.circuit import may_be_of_power
from beliefnest.worlds.scripted.desk import Desk
from beliefnest.worlds.scripted.footpaths import Ground
from beliefnest.worlds.scripted.ground_cache import Grounds
from beliefnest.worlds.scripted.powered import switches_in
from beliefnest.worlds.scripted.programs import RunningPrograms
from beliefnest.worlds.scripted.world import ScriptedWorld

PolicyProgram = Callable[["Course", str], str]
"""Function that returns the next program of an agent in a course; empty: nothing more."""

_AT_BLOCKS = frozenset(
    {
        EventKind.MINE_BLOCK,
        EventKind.PLACE_BLOCK,
        EventKind.USE_DOOR,
        EventKind.USE_LEVER,
        EventKind.PRESS_BUTTON,
    }
)
"""Kinds of deeds that move blocks."""

Seeds = tuple[tuple[int, str], ...]
"""Seeds, each with the tick from which it is used."""


class Candidate(msgspec.Struct, frozen=True):
    """A course of action that an agent may have followed.

    Attributes:
        name: Its name.
        program: JavaScript; empty: nothing.
        strategy: Strategy, if the candidate is a model of its mind.
        policy: Function, if the candidate is a policy.
    """

    name: str
    program: str = ""
    strategy: Strategy | None = None
    policy: PolicyProgram | None = None

    @property
    def is_fixed(self) -> bool:
        """Return True if it is a program; only calls for random numbers vary its course."""
        return self.strategy is None and self.policy is None


@dataclass(frozen=True, eq=False)
class CoursePlan:
    """Things that all courses of one call have in common.

    Attributes:
        agents: The agents in question, in order.
        percepts: Percepts of the observer, oldest first; they contain the actions of other agents.
        speech_ticks: Duration of an utterance in ticks.
        starts: Starts of courses, by drawn edits.
        known: Containers whose contents the observer knew at the start, or which are drawn.
        is_unseen: Returns True for places whose block the observer never saw.
    """

    agents: tuple[str, ...]
    percepts: Sequence[Percept]
    speech_ticks: int
    starts: Callable[[tuple[int, ...]], Snapshot]
    known: frozenset[Position]
    is_unseen: Callable[[Position], bool]

    @cached_property
    def grounds(self) -> Grounds:
        """Cache of the data of grids."""
        return Grounds()

    @cached_property
    def desk(self) -> Desk:
        """Desk of their programs."""
        return Desk()

    @cached_property
    def failures(self) -> dict[tuple[str, str], Fault]:
        """First failure of each program that failed in a course, by agent and candidate."""
        return {}

    @cached_property
    def _worlds(self) -> dict[tuple[int, ...], ScriptedWorld]:
        return {}

    @cached_property
    def by_tick(self) -> Mapping[int, Percept]:
        """Percepts by tick."""
        return {percept.tick: percept for percept in self.percepts}

    def world(self, drawn: tuple[int, ...]) -> ScriptedWorld:
        """Return a new world at the start."""
        if drawn not in self._worlds:
            self._worlds[drawn] = ScriptedWorld.from_snapshot(self.starts(drawn))
        return self._worlds[drawn].again()


class Glimpse(msgspec.Struct, frozen=True):
    """Perceptible facts of a course at one tick.

    Attributes:
        tick: The tick.
        blocks: Block states; a returned grid never changes.
        agents: All agents.
        containers: Contents of containers.
        deeds: Actions at containers in this tick.
        is_new: False: equal to the tick before.
    """

    tick: int
    blocks: Terrain
    agents: Mapping[str, AgentState]
    containers: Mapping[Position, Items]
    deeds: tuple[DeedKey, ...]
    is_new: bool


class Course:
    """Course at its latest tick.

    Args:
        plan: The part that all courses share.
        drawn: The actual alternatives, by doubt.
        candidates: Candidates by agent.
        draws: Hypotheses of agents whose candidate is a model.
        seeds: Seeds with their first ticks.

    Attributes:
        entries: What has happened so far, without quiet ticks.
        known: Containers whose contents are compared: those known at the start, those that agents
            in question have changed since, and those of which the observer has learnt otherwise.
        contradiction: Perceived action of another agent that is impossible here; None: none.
        faults: Reasons of failed programs, by agent.
        is_fixed: True if all candidates are programs.
        shared_from: Number of random numbers drawn before histories began to share the course. They
            can share it until another one is drawn.
    """

    def __init__(
        self,
        plan: CoursePlan,
        drawn: tuple[int, ...],
        candidates: Mapping[str, Candidate],
        draws: Mapping[str, Draw],
        seeds: Seeds,
    ) -> None:
        self.plan, self.drawn, self.candidates, self.draws = plan, drawn, candidates, draws
        self.seeds = seeds
        self.entries: list[Entry] = []
        self.known = plan.known
        self.contradiction: str | None = None
        self.shared_from = 0
        self.faults: dict[str, Fault] = {}
        self.world = plan.world(drawn)
        self.start = self.world.now
        self._changed_blocks: dict[tuple[int, int, int], int] = {}
        self._moved: dict[tuple[Position, str], int] = {}
        self._changes = WalkChanges()
        self._latest: Frame | None = None
        self.is_fixed = all(each.is_fixed for each in candidates.values())
        self._ended_draws = 0
        self._programs: dict[str, RunningPrograms] = {}
        self.world.listen(self._take)
        self._seed(seeds[0][1])
        self._walkers = [
            self._walker(name, candidate.strategy, draws[name])
            for name, candidate in candidates.items()
            if candidate.strategy is not None
        ]
        self._begin_programs()

    @property
    def tick(self) -> int:
        """The latest tick."""
        return self.world.now

    @property
    def numbers_drawn(self) -> int:
        """Number of random numbers that its programs have drawn."""
        return self._ended_draws + sum(each.draws for each in self._programs.values())

    def again(self, seeds: Seeds) -> "Course":
        """Return a copy that continues with other seeds; they must begin like its own."""
        if self._programs or any(each.policy is not None for each in self.candidates.values()):
            other = Course(self.plan, self.drawn, self.candidates, self.draws, seeds)
            other.run_to(self.tick)
            other.reseed()
            return other
        other = Course.__new__(Course)
        other.__dict__.update(self.__dict__)
        other.seeds = seeds
        other.entries, other.faults = list(self.entries), dict(self.faults)
        other._changed_blocks, other._moved = dict(self._changed_blocks), dict(self._moved)
        other._walkers = [walker.again() for walker in self._walkers]
        other._programs = {}
        other.world = self.world.again()
        other.world.listen(other._take)
        other.reseed()
        return other

    def reseed(self) -> None:
        """Use the seed that begins at the latest tick."""
        tick, seed = self.seeds[-1]
        if tick == self.tick and len(self.seeds) > 1:
            self._seed(seed)

    def run_to(self, tick: int) -> None:
        """Run up to a tick with the recorded seeds."""
        later = dict(self.seeds[1:])
        while self.tick < tick and self.contradiction is None:
            if self.tick in later:
                self._seed(later[self.tick])
            self.step()

    def step(self) -> Glimpse:
        """Let one tick pass."""
        world, now = self.world, self.world.now + 1
        self._latest = None
        done = self.plan.by_tick.get(now)
        if done is not None:
            self._let_in(done)
        with world.tick():
            if done is not None:
                self._do_as_seen(done)
            for walker in self._walkers:
                self._walk(walker, now)
            for programs in self._programs.values():
                programs.act()
        if self._programs:
            self._settle()
        if done is not None:
            self._learn(done)
            for edit in done.edits:
                self._edit(edit)
        return self._glimpse()

    def glimpse(self) -> Glimpse:
        """Return the perceptible facts at the start."""
        return self._glimpse()

    # Seeds

    def chance(self, name: str) -> Random:
        """Return the random numbers of an agent that follows a model or a policy."""
        return self._chances[name]

    def _seed(self, seed: str) -> None:
        self._chances = {
            name: Random(f"{seed} {name}")
            for name, candidate in self.candidates.items()
            if not candidate.is_fixed
        }
        for name, programs in self._programs.items():
            programs.reseed(f"{seed} {name}")
        self._seed_text = seed

    # Programs

    def _begin_programs(self) -> None:
        for name, candidate in self.candidates.items():
            code = candidate.program if candidate.policy is None else candidate.policy(self, name)
            self._begin(name, code)

    def _begin(self, name: str, code: str) -> None:
        if not code.strip():
            return
        programs = RunningPrograms(
            self.world,
            {name: code},
            {},
            RunRules(self.plan.speech_ticks),
            self._seed_text,
            self.plan.grounds,
            self.plan.desk,
        )
        self._programs[name] = programs

    def _settle(self) -> None:
        for name, programs in list(self._programs.items()):
            programs.settle()
            if not programs.are_over:
                continue
            del self._programs[name]
            self._ended_draws += programs.draws
            programs.leave()
            fault = programs.results()[name].error
            if fault is not None:
                candidate = self.candidates[name].name
                if fault.kind == "syntax":
                    raise InputError(f"candidate {candidate!r} of {name}: {fault}")
                self.faults[name] = fault
                self.plan.failures.setdefault((name, candidate), fault)
            policy = self.candidates[name].policy
            if policy is not None:
                self._begin(name, policy(self, name))

    # Models of minds

    def _walker(self, name: str, strategy: Strategy, draw: Draw) -> Walker:
        state = self.world.agent(name)
        pose = (state.position, state.yaw, state.pitch)
        return Walker(strategy, draw, pose, self._ground.cell_of(state.position))

    @property
    def _ground(self) -> Ground:
        # A model's agent walks through shut doors, like its planner.
        return self.plan.grounds.of(self.world.box, self.world.terrain).with_doors_opened

    def _walk(self, walker: Walker, now: int) -> None:
        if walker.is_over or (now - self.start) % walker.strategy.step_ticks:
            return
        action = walker.choose(self.chance(walker.name), self._changes)
        world, name = self.world, walker.name
        state = world.agent(name)
        if isinstance(action, WalkStep):
            if action.cell != walker.cell:
                feet = self._ground.feet(action.cell)
                yaw = _yaw(state.position, feet)
                world.place_agent(name, feet, yaw=yaw, pitch=0.0)
                state = world.agent(name)
        elif isinstance(action, Open):
            world.open(name, action.place)
        elif isinstance(action, WalkAct) and action.item is not None:
            self._take_item(walker, action.item)
        if not walker.is_over:
            cell = action.cell if isinstance(action, WalkStep) else walker.cell
            walker.arrive((state.position, state.yaw, state.pitch), cell)

    def _take_item(self, walker: Walker, item: str) -> None:
        """Take an item out of the nearest container; dropped items stay where they are."""
        x, y, z = walker.cell
        holding = [place for place, items in self.world.containers.items() if items.get(item)]
        near = [
            (abs(place[0] - x) + abs(place[2] - z), abs(place[1] - y), place)
            for place in walker.in_reach(holding)
        ]
        for _, _, place in sorted(near)[:1]:
            self.world.withdraw(walker.name, place, {item: 1})

    # Agents that are not in question

    def _let_in(self, now: Percept) -> None:
        """Add the agents that are seen, with the items that they are seen to give or put in."""
        agents = dict(self.world.agents)
        for name, (feet, _, _) in now.agents.items():
            if name not in self.plan.agents and name not in agents:
                agents[name] = AgentState(feet)
        for event in now.events:
            if event.kind.traits.gains >= 0 or event.actor in self.plan.agents:
                continue
            if (holder := agents.get(event.actor or "")) is not None:
                inventory = dict(holder.inventory)
                for item, count in event.detail["items"].items():
                    inventory[item] = max(count, inventory.get(item, 0))
                if inventory != holder.inventory:
                    agents[event.actor or ""] = replace(holder, inventory=inventory)
        if agents != self.world.agents:
            self.world.set_state(replace(self.world.snapshot(), agents=agents))
        self._supply(now)

    def _supply(self, now: Percept) -> None:
        """Add what others are seen to take out of contents that the observer did not know.

        What they use where it never saw a block is a chest.
        """
        deeds = [
            each
            for each in now.events
            if each.kind in AT_CONTAINERS and each.actor not in self.plan.agents
        ]
        if not deeds:
            return
        taken: Counter[tuple[Position, str]] = Counter()
        contents = {place: dict(items) for place, items in self.world.containers.items()}
        blocks = self.world.terrain.draft()
        for event in deeds:
            place = self.world.container_at(_place(event.detail))
            if place not in contents and self.plan.is_unseen(place):
                blocks[self.world.box.index(place)] = Registry.load().state_id("chest")
                contents[place] = {}
            is_taking = event.kind is EventKind.GET_ITEM_FROM_CHEST
            if is_taking and place in contents and place not in self.known:
                for item, count in event.detail["items"].items():
                    taken[place, item] += count
        for (place, item), count in taken.items():
            contents[place][item] = max(count, contents[place].get(item, 0))
        if contents != self.world.containers:
            snapshot = replace(self.world.snapshot(), blocks=blocks.terrain(), containers=contents)
            self.world.set_state(snapshot)

    def _learn(self, now: Percept) -> None:
        """Take contents that the observer learns, and nobody in question changed, to be so."""
        learnt = {place: dict(now.contents[place]) for place in now.contents.keys() - self.known}
        contents = self.world.containers
        there = {place: items for place, items in learnt.items() if place in contents}
        if any(contents[place] != items for place, items in there.items()):
            self.world.set_state(replace(self.world.snapshot(), containers={**contents, **there}))
        self.known |= there.keys()

    def _do_as_seen(self, now: Percept) -> None:
        for name, (feet, yaw, pitch) in now.agents.items():
            if name in self.plan.agents:
                continue
            state = self.world.agent(name)
            if (state.position, state.yaw, state.pitch) != (feet, yaw, pitch):
                self.world.place_agent(name, feet, yaw=yaw, pitch=pitch)
        used = {place for event in now.events for place in _moved_by(event)}
        # Out of sight, an agent in question may have made any change.
        is_all_seen = now.agents.keys() >= set(self.plan.agents)
        for event in now.events:
            if event.actor in self.plan.agents:
                continue
            if event.kind is EventKind.BLOCK_UPDATE:
                if _place(event.detail) in used or not (event.actor or is_all_seen):
                    continue
                if event.actor is None and self._is_of_circuit(event):
                    continue
            elif event.actor is None:
                continue
            self._do_event(event)

    def _is_of_circuit(self, event: PerceivedEvent) -> bool:
        """Return True if a change is one that power makes; the course's own circuits make it."""
        world, registry = self.world, Registry.load()
        if not switches_in(world.box, world.terrain):
            return False
        before = world.terrain[world.box.index(_place(event.detail))]
        return may_be_of_power(registry, before, registry.state_id(event.detail["block"]))

    def _do_event(self, event: PerceivedEvent) -> None:
        name = event.actor
        if name is not None and name not in self.world.agents:
            return
        try:
            self.world.repeat(name, event.kind, event.detail)
        except WorldError as fault:
            if event.kind in _AT_BLOCKS and self.plan.is_unseen(_place(event.detail)):
                return
            self.contradiction = f"{name or 'somebody'} was seen to {event.kind}, but {fault}"

    def _edit(self, edit: Edit) -> None:
        """Change the world as it was changed by hand."""
        world = self.world
        box, blocks = world.box, world.terrain.draft()
        contents = {place: dict(items) for place, items in world.containers.items()}
        for place, block in edit.blocks.items():
            state = max(AIR, plain_state(block))
            blocks[box.index(place)] = self._changed_blocks[box.index(place)] = state
            if Registry.load().is_container(Registry.load().name(state)):
                contents.setdefault(place, {})
            else:
                contents.pop(place, None)
        contents |= {place: dict(items) for place, items in edit.containers.items()}
        for place in contents.keys() | world.containers.keys():
            before, after = world.containers.get(place, {}), contents.get(place, {})
            for item in before.keys() | after.keys():
                self._note_moved(place, item, after.get(item, 0) - before.get(item, 0))
        self.known |= edit.containers.keys()
        world.set_state(replace(world.snapshot(), blocks=blocks.terrain(), containers=contents))
        self.entries.append(edit)
        self._note_changes()

    # Record of what happened

    def _take(self, frame: Frame) -> None:
        self._latest = frame
        if frame.is_empty:
            return
        self.entries.append(frame)
        if not (frame.blocks or frame.containers):
            return
        box = self.world.box
        for place, block in frame.blocks.items():
            self._changed_blocks[box.index(place)] = plain_state(block)
        for event in frame.events:
            if sign := event.kind.traits.stores:
                place = _place(event.detail)
                for item, count in event.detail["items"].items():
                    self._note_moved(place, item, sign * count)
        others = {
            self.world.container_at(_place(event.detail))
            for event in frame.events
            if event.kind in AT_CONTAINERS and event.actor not in self.plan.agents
        }
        self.known |= frame.containers.keys() - others
        self._note_changes()

    def _note_moved(self, place: Position, item: str, count: int) -> None:
        self._moved[place, item] = self._moved.get((place, item), 0) + count

    def _note_changes(self) -> None:
        self._changes = WalkChanges(
            tuple(sorted(self._changed_blocks.items())),
            tuple(sorted((*key, count) for key, count in self._moved.items() if count)),
        )

    def _glimpse(self) -> Glimpse:
        world, frame = self.world, self._latest
        deeds: tuple[DeedKey, ...] = ()
        if frame is not None and frame.events:
            observed = [
                deed_of(event.kind, event.actor, event.detail)
                for event in frame.events
                if event.kind in AT_CONTAINERS and event.actor in self.plan.agents
            ]
            deeds = tuple(sorted(observed))
        is_new = frame is None or not frame.is_empty
        containers = dict(world.containers)
        return Glimpse(world.now, world.terrain, world.agents, containers, deeds, is_new)


def _moved_by(event: PerceivedEvent) -> tuple[Position, ...]:
    """Return the places of blocks that a deed moves: that of its block, and of a door's half."""
    if event.kind not in _AT_BLOCKS:
        return ()
    x, y, z = _place(event.detail)
    return (x, y, z), (x, y + 1, z)


def _place(detail: Mapping[str, Any]) -> Position:
    x, y, z = detail["position"]
    return (int(x), int(y), int(z))


def _yaw(before: Point, after: Point) -> float:
    return float(np.arctan2(before[0] - after[0], before[2] - after[2]))
