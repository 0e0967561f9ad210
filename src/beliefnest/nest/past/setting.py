"""What a nest starts from: the world at tick 0, the rules of perception, priors, a script."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from beliefnest.belief.entries import InitialBelief
from beliefnest.errors import InputError, PathError
from beliefnest.nest.past.unique import unique_fault
from beliefnest.perception.options import Perception
from beliefnest.timeline.records import Senses
from beliefnest.world.claims import claims_from_plain
from beliefnest.world.frames import Snapshot
from beliefnest.world.limits import (
    agent_name_fault,
    container_slots,
    items_fault,
    point_fault,
    snapshot_fault,
)
from beliefnest.world.paths import parse_path, parse_pattern, path_text
from beliefnest.world.registry import Registry
from beliefnest.world.signs import plain_state
from beliefnest.world.texts import escaped, is_well_formed
from beliefnest.world.values import Box, Position

__all__ = ["MAIN", "Senses", "Setting", "Step"]

MAIN = "main"
"""Name of the real world's first branch."""


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a script: programs that run together in the real world.

    Attributes:
        programs: Agent name to the text of its program.
        label: What the step is, for progress and messages ("sally puts the diamond away").
        where: Where the step is written, for messages ("sally_anne.yaml:41").
        timeout_ticks: Ticks after which the step has failed.
        senses: What its programs read: the whole `world`, or their agents' `percepts` alone.
    """

    programs: Mapping[str, str]
    label: str = ""
    where: str = ""
    timeout_ticks: int = 1200
    senses: Senses = "world"


@dataclass(frozen=True, slots=True)
class Setting:
    """Everything a nest needs to open; a scenario with one condition chosen gives one.

    Attributes:
        name: Name of the scenario.
        snapshot: The real world at its first tick.
        perception: What agents can perceive.
        static_blocks: Names and positions of blocks that everybody knows from the start.
        initial_beliefs: Further priors, at any depth.
        script: What happens in the real world, in order.
        absent: Agents who are not in the world at its first tick and may come later.
        people: Agents who are people with a Minecraft client, for whom no program acts.
        labels: What people call containers.
        places: What people call other places.
        prompt_labels: What containers are called and look as if they held, for prompts.
        unique: Items of which everybody knows that there is one (semantics, section 3).
    """

    name: str
    snapshot: Snapshot
    perception: Perception = field(default_factory=Perception)
    static_blocks: frozenset[str | Position] = frozenset()
    initial_beliefs: tuple[InitialBelief, ...] = ()
    script: tuple[Step, ...] = ()
    absent: frozenset[str] = frozenset()
    people: frozenset[str] = frozenset()
    labels: Mapping[Position, str] = field(default_factory=dict)
    places: Mapping[str, Position] = field(default_factory=dict)
    prompt_labels: Mapping[Position, str] = field(default_factory=dict)
    unique: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        agents = self.snapshot.agents.keys() | self.absent
        for place in self.static_blocks:
            if not isinstance(place, str) and place not in self.snapshot.box:
                raise InputError(f"static_blocks names {place}, which lies outside the box")
        registry = Registry.load()
        fault = snapshot_fault(self.snapshot, registry)
        for name in self.absent:
            fault = fault or agent_name_fault(name)
        for belief in self.initial_beliefs:
            fault = fault or _belief_fault(belief, self.snapshot.box, registry)
        fault = fault or self._claims_fault() or self._unique_fault()
        fault = fault or self._people_fault() or self._text_fault()
        if fault:
            raise InputError(f"setting {self.name!r}: {fault}")
        seen: set[tuple[str, ...]] = set()
        for belief in self.initial_beliefs:
            text = path_text(belief.path)
            if parse_pattern(text, agents) != belief.path:
                raise PathError(f"initial belief {text!r} names an agent twice in a row")
            if not belief.path:
                raise InputError("an initial belief of '/' would be the real world; give agents")
            if belief.path in seen:
                raise InputError(f"there are two initial beliefs of {text!r}; put them into one")
            seen.add(belief.path)
            for name in belief.agents:
                parse_path(path_text((name,)), agents)

    def _claims_fault(self) -> str | None:
        agents = self.snapshot.agents.keys() | self.absent
        for place, claims in self.snapshot.sign_claims.items():
            if place not in self.snapshot.signs:
                return f"nothing is written at {place} that could claim anything; give it a text"
            for claim in claims_from_plain(claims):
                claim.check(self.snapshot.box, agents)
        return None

    def _unique_fault(self) -> str | None:
        for item in sorted(self.unique):
            Registry.load().item_stack(item)
            if fault := unique_fault(item, self.snapshot, self.initial_beliefs):
                return fault
        return None

    def _people_fault(self) -> str | None:
        for name in sorted(self.people):
            if name not in self.snapshot.agents:
                return f"{name} is to be a person and is not in the world at its first tick"
            label = next((step.label for step in self.script if name in step.programs), None)
            if label is not None:
                return f"{name} is a person; no program can act for them, as one does in {label!r}"
        return None

    def _text_fault(self) -> str | None:
        texts = [self.name, *self.labels.values(), *self.places, *self.prompt_labels.values()]
        for step in self.script:
            texts += [step.label, step.where, *step.programs.values()]
        bad = next((text for text in texts if not is_well_formed(text)), None)
        return None if bad is None else f"half a character is in {escaped(bad[:100])!r}; remove it"


def _belief_fault(belief: InitialBelief, box: Box, registry: Registry) -> str | None:
    """What is wrong with the places and contents of an initial belief."""
    whose = f"the initial belief {path_text(belief.path)!r}"
    outside = [place for place in (*belief.containers, *belief.blocks) if place not in box]
    if outside:
        return f"{whose} is of {outside[0]}, which lies outside the box"
    for place, block in belief.blocks.items():
        state = plain_state(block)
        if not -1 <= state < registry.states:
            return f"{whose} has block state {state} at {place}; states go to {registry.states - 1}"
    for place, (items, _) in belief.containers.items():
        holder = f"the chest at {place} in {whose}"
        if fault := items_fault(items, registry, container_slots("chest"), holder):
            return fault
    for name, position in belief.agents.items():
        if fault := point_fault(position):
            return f"{name} in {whose}: {fault}"
    return None
