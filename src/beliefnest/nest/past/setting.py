"""Setting of a nest: its world at the first tick, options of perception, priors and script."""

from collections.abc import Mapping
from dataclasses import dataclass

import msgspec

from beliefnest.belief.grounds import InitialBelief
from beliefnest.errors import InputError, PathError
from beliefnest.nest.past.unique import unique_fault
from beliefnest.perception.options import Perception
from beliefnest.timeline.run_records import Senses
from beliefnest.world.claims import claims_from_plain
from beliefnest.world.frames import Snapshot
from beliefnest.world.limits import (
    AGENT_SLOTS,
    WORN_SLOTS,
    agent_name_fault,
    container_slots,
    items_fault,
    point_fault,
    snapshot_fault,
)
from beliefnest.world.paths import parse_path, parse_pattern, path_text
from beliefnest.world.registry import Registry
from beliefnest.world.signs import plain_state
from beliefnest.world.texts import escaped, is_well_formed, quoted
from beliefnest.world.values import Box, Position

MAIN = "main"
"""Name of the real world's first branch."""


@dataclass(frozen=True, slots=True)
class Step:
    """Step of a script: programs that run together in the real world.

    Attributes:
        programs: Text of the program by agent name.
        label: Description for progress and messages ("sally puts the diamond away").
        where: File and line of the step, for messages ("sally_anne.yaml:41").
        timeout_ticks: Number of ticks after which the step fails.
        senses: `world`: programs read the whole world; `percepts`: only what their agents perceive
            or remember.
    """

    programs: Mapping[str, str]
    label: str = ""
    where: str = ""
    timeout_ticks: int = 1200
    senses: Senses = "world"


class Setting(msgspec.Struct, frozen=True):
    """Setting of a nest, as a scenario with one chosen condition gives it.

    Attributes:
        name: Name of the scenario.
        snapshot: The real world at its first tick.
        perception: Options of perception.
        static_blocks: Names and positions of blocks that everybody knows from the start.
        initial_beliefs: Further priors, at any depth.
        script: Steps in the real world, in order.
        absent: Agents that are not in the world at its first tick and may come later.
        people: Agents that people play with a Minecraft client. Programs cannot act for them.
        labels: Names of containers for people, by position.
        places: Names of other places for people.
        prompt_labels: Labels of containers in prompts, by position, with the contents that each
            seems to have.
        unique: Items of which everybody knows that there is only one (semantics, section 3).
    """

    name: str
    snapshot: Snapshot
    perception: Perception = msgspec.field(default_factory=Perception)
    static_blocks: frozenset[str | Position] = frozenset()
    initial_beliefs: tuple[InitialBelief, ...] = ()
    script: tuple[Step, ...] = ()
    absent: frozenset[str] = frozenset()
    people: frozenset[str] = frozenset()
    labels: Mapping[Position, str] = msgspec.field(default_factory=dict)
    places: Mapping[str, Position] = msgspec.field(default_factory=dict)
    prompt_labels: Mapping[Position, str] = msgspec.field(default_factory=dict)
    unique: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        agents = self.snapshot.agents.keys() | self.absent
        for place in self.static_blocks:
            if not isinstance(place, str) and place not in self.snapshot.box:
                raise InputError(
                    f"static_blocks names {place}, which lies outside the box; remove it"
                )
        registry = Registry.load()
        fault = snapshot_fault(self.snapshot, registry)
        for name in self.absent:
            fault = fault or agent_name_fault(name)
        for belief in self.initial_beliefs:
            fault = fault or _belief_fault(belief, self.snapshot.box, registry)
        fault = fault or self._claims_fault() or self._unique_fault()
        fault = fault or self._people_fault() or self._text_fault()
        if fault:
            raise InputError(f"setting {quoted(self.name)}: {fault}")
        seen: set[tuple[str, ...]] = set()
        for belief in self.initial_beliefs:
            text = path_text(belief.path)
            if parse_pattern(text, agents) != belief.path:
                raise PathError(
                    f"initial belief {quoted(text)} names an agent twice in a row; name it once"
                )
            if not belief.path:
                raise InputError(
                    "an initial belief has the path '/', which is the real world; name an agent, "
                    "as in '/sally'"
                )
            if belief.path in seen:
                raise InputError(
                    f"initial_beliefs has the path {quoted(text)} twice; put the two into one"
                )
            seen.add(belief.path)
            for name in (*belief.agents, *belief.inventories):
                parse_path(path_text((name,)), agents)

    def _claims_fault(self) -> str | None:
        agents = self.snapshot.agents.keys() | self.absent
        for place, claims in self.snapshot.sign_claims.items():
            if place not in self.snapshot.signs:
                return f"the sign at {place} has claims but no text; give it a text"
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
                return (
                    f"{name} is played by a person but is not in the world at its first tick; "
                    "give it a position"
                )
            label = next((step.label for step in self.script if name in step.programs), None)
            if label is not None:
                return (
                    f"{name} is played by a person but has a program in step {quoted(label)}; "
                    "remove the program"
                )
        return None

    def _text_fault(self) -> str | None:
        texts = [self.name, *self.labels.values(), *self.places, *self.prompt_labels.values()]
        for step in self.script:
            texts += [step.label, step.where, *step.programs.values()]
        bad = next((text for text in texts if not is_well_formed(text)), None)
        return (
            None
            if bad is None
            else f"{quoted(escaped(bad[:100]))} has half a character in it; remove it"
        )


def _belief_fault(belief: InitialBelief, box: Box, registry: Registry) -> str | None:
    """Return what is wrong with the positions and contents of an initial belief; None: nothing."""
    whose = f"the initial belief {quoted(path_text(belief.path))}"
    outside = [place for place in (*belief.containers, *belief.blocks) if place not in box]
    if outside:
        return f"{whose} names {outside[0]}, which lies outside the box"
    for place, block in belief.blocks.items():
        state = plain_state(block)
        if not -1 <= state < registry.states:
            last = registry.states - 1
            return f"{whose} has block state {state} at {place}; the highest state is {last}"
    for place, (items, _) in belief.containers.items():
        holder = f"the chest at {place} in {whose}"
        if fault := items_fault(items, registry, container_slots("chest"), holder):
            return fault
    for name, items in belief.inventories.items():
        if fault := items_fault(items, registry, AGENT_SLOTS + WORN_SLOTS, f"{name} in {whose}"):
            return fault
    for name, position in belief.agents.items():
        if fault := point_fault(position):
            return f"{name} in {whose}: {fault}"
    return None
