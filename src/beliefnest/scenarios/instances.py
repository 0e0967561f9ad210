"""Random instances of a scenario: parameters whose values a seed draws by the rules of its file.

Draws are rejected until all rules hold, so that every allowed instance is equally likely. The rules
hold in the scene as written, without a condition, so that an instance is the same under all
conditions.
"""

import itertools
import math
import random
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from functools import cached_property
from typing import Any

import msgspec
import numpy as np

from beliefnest.errors import ScenarioError
from beliefnest.perception.percept import gaze_from
from beliefnest.perception.sight import Geometry, Sight
from beliefnest.scenarios.content import ScenarioContent
from beliefnest.scenarios.document import Document, YamlNode, plain
from beliefnest.scenarios.document_form import converted_at
from beliefnest.scenarios.format import InstanceEntry, ParameterEntry, TerrainEntry
from beliefnest.scenarios.loading import condition_numbers, scenario_in
from beliefnest.scenarios.parameters import broken_constraint, check_declared, choices, declared_in
from beliefnest.scenarios.terrain_entry import terrain_in
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box, Point, Position
from beliefnest.world.words import counted, nearest_or_all
from beliefnest.worlds.scripted.footpaths import Ground, InReach
from beliefnest.worlds.scripted.hand import REACH

_KEY = "instances"
_MOST_DRAWS = 2_000
"""Most draws for one instance; if none keeps the rules, that is an error."""
_NEAR = 2
"""Cells around a line of sight whose blocks may hide something on it."""


def has_instances(document: Document) -> bool:
    """Return True if a scenario has rules for random instances."""
    return _KEY in document.root.value


def drawn_instance(document: Document, seed: int, chosen: Mapping[str, object]) -> dict[str, Any]:
    """Return the values of all parameters that an instance sets.

    Args:
        document: Document of the scenario.
        seed: Number of the instance.
        chosen: Values of parameters that are not drawn.

    Raises:
        ScenarioError: The scenario or a rule is wrong, or no draw keeps all rules.
    """
    drawing = _Drawing.of(document, chosen)
    # A draw that makes no scenario is rejected; say at once what is wrong in the file. Given values
    # need not fit the defaults of parameters that are drawn.
    written, *_ = [scenario_in(document, each) for each in drawing.conditions]
    check_declared(document, drawing.declared, chosen)
    drawing.check_agents(written.setting.snapshot.agents)
    chance = random.Random(f"{written.setting.name} {seed}")
    refused: Counter[str] = Counter()
    # If all values are given, there is nothing that another draw would change.
    draws = _MOST_DRAWS if drawing.rules else 1
    for _ in range(draws):
        values = {**drawing.draw(chance), **chosen}
        fault = drawing.fault(values)
        if fault is None:
            return values
        refused[fault] += 1
    if not drawing.rules:
        raise document.fault((_KEY,), f"nothing is drawn, and the given values fail: {fault}")
    often = "; ".join(f"{rule} ({counted(n, 'time')})" for rule, n in refused.most_common(3))
    raise document.fault(
        (_KEY,), f"none of {_MOST_DRAWS} draws keeps the rules; most often broken: {often}"
    )


class _Drawing(msgspec.Struct, frozen=True):
    """Rules of a document for its instances.

    Attributes:
        document: The document.
        conditions: Numbers of its conditions, and None for the scenario as written.
        rules: Rules of the drawn parameters, in the order of the file.
        declared: Declarations of all parameters.
        cells: All cells of each parameter that is a position.
    """

    document: Document
    conditions: tuple[int | None, ...]
    rules: Mapping[str, InstanceEntry]
    declared: Mapping[str, ParameterEntry]
    cells: Mapping[str, list[Position]]

    @classmethod
    def of(cls, document: Document, chosen: Mapping[str, object]) -> "_Drawing":
        """Return the rules of a document.

        Raises:
            ScenarioError: A rule is wrong.
        """
        written = document.root.value[_KEY]
        if not isinstance(written.value, dict) or not written.value:
            raise document.fault((_KEY,), "is empty; name parameters, each with its rules")
        declared = declared_in(document)
        rules = {
            name: _rule(document, name, node, declared) for name, node in written.value.items()
        }
        drawn = {name: rule for name, rule in rules.items() if name not in chosen}
        cells = {
            name: _cells_of(rule.within) for name, rule in drawn.items() if rule.within is not None
        }
        conditions = tuple(dict.fromkeys((None, *condition_numbers(document))))
        return cls(document, conditions, drawn, declared, cells)

    def check_agents(self, agents: Collection[str]) -> None:
        """Refuse rules that name unknown agents."""
        for name, rule in self.rules.items():
            for key in ("seen_by", "hidden_from", "reached_by"):
                for agent in getattr(rule, key):
                    if agent not in agents:
                        why = f"there is no agent {quoted(agent)}; agents are {', '.join(agents)}"
                        raise self.document.fault((_KEY, name, key), why)

    def draw(self, chance: random.Random) -> dict[str, Any]:
        """Return values of all drawn parameters, which may break rules."""
        values: dict[str, Any] = {}
        for name, rule in self.rules.items():
            if name in self.cells:
                values[name] = list(chance.choice(self.cells[name]))
                continue
            listed = choices(self.declared[name])
            if listed is None:
                low, high = self.declared[name].range or (0, 0)
                values[name] = chance.uniform(low, high)
            else:
                taken = [values[other] for other in rule.differs_from if other in values]
                left = [value for value in listed if value not in taken]
                values[name] = chance.choice(left or list(listed))
        return values

    def fault(self, values: Mapping[str, Any]) -> str | None:
        """Return the first rule that values break; None: they keep all rules."""
        for name, rule in self.rules.items():
            for other in rule.differs_from:
                if values.get(name) == values.get(other):
                    return f"{name}: differs_from {other}"
            for other in self.cells if name in self.cells else ():
                if other != name and math.dist(values[name], values[other]) < rule.apart:
                    return f"{name}: apart {rule.apart:g}"
        for condition in self.conditions:
            broken = broken_constraint(self.document, self._all(values, condition), condition)
            if broken is not None:
                return f"constraint {broken}"
        try:
            scenes = [scenario_in(self.document, each, values) for each in self.conditions]
        except ScenarioError as error:
            return str(error)
        return next(self._faults_in(_Scene(scenes[0]), values), None)

    def _all(self, values: Mapping[str, Any], condition: int | None) -> dict[str, Any]:
        declared = declared_in(self.document, condition)
        return {name: values.get(name, each.default) for name, each in declared.items()}

    def _faults_in(self, scene: "_Scene", values: Mapping[str, Any]) -> Iterator[str]:
        """Yield the rules that a built scene breaks."""
        for name in self.cells:
            rule, (x, y, z) = self.rules[name], values[name]
            cell = (x, y, z)
            if rule.free and not scene.is_free(cell):
                yield f"{name}: free"
            for agent in rule.seen_by:
                if not scene.sees(agent, cell):
                    yield f"{name}: seen_by {agent}"
            for agent in rule.hidden_from:
                if scene.sees(agent, cell):
                    yield f"{name}: hidden_from {agent}"
            for agent in rule.reached_by:
                if not scene.reaches(agent, cell):
                    yield f"{name}: reached_by {agent}"


class _Scene:
    """Scene of an instance at its first tick.

    Args:
        content: Scenario of the instance.
    """

    def __init__(self, content: ScenarioContent) -> None:
        self._written = content.written
        self._place = content.setting.snapshot
        self._options = content.setting.perception
        self._registry = Registry.load()

    def is_free(self, cell: Position) -> bool:
        """Return True if the blocks of the file leave a cell free, above a block."""
        if cell not in self._place.box:
            return False
        x, y, z = cell
        below = (x, y - 1, z)
        under = self._registry.air
        if below in self._place.box:
            under = int(self._place.blocks[self._place.box.index(below)])
        return under != self._registry.air and not self._is_built_over(cell)

    def _is_built_over(self, cell: Position) -> bool:
        """Return True if an entry of `blocks` for more than this cell fills it."""
        is_filled = self._captured[self._place.box.index(cell)] != self._registry.air
        for entry in self._written.get("blocks", ()):
            part = _part_of(entry)
            if part is not None and cell in part and not _is_inside_walls(entry, part, cell):
                is_filled = self._registry.name(self._registry.state_id(entry["block"])) != "air"
        return is_filled

    def sees(self, agent: str, cell: Position) -> bool:
        """Return True if an agent sees a cell."""
        state = self._place.agents[agent]
        gaze = gaze_from(state.position, state.yaw, state.pitch)
        return bool(self._geometry(gaze.eye, cell).sees_blocks(*gaze, np.array([cell]))[0])

    def reaches(self, agent: str, cell: Position) -> bool:
        """Return True if an agent can walk to where its hand reaches a cell, opening doors."""
        start = self._ground.cell_of(self._place.agents[agent].position)
        return self._ground.way(start, InReach(cell, REACH)) is not None

    def _geometry(self, eye: Point, cell: Position) -> Geometry:
        """Return the blocks that may hide a cell from an eye, prepared for looks."""
        box, blocks = self._place.box, self._place.blocks
        if blocks.is_dense:
            return self._whole
        # Outside of the box nothing hides anything. Shapes reach into the next cell at most.
        low, high = (
            tuple(
                min(max(end(math.floor(a), b) + far, first), last)
                for a, b, first, last in zip(eye, cell, box.low, box.high, strict=True)
            )
            for end, far in ((min, -_NEAR), (max, _NEAR))
        )
        first, last = (box.index((x, y, z)) for x, y, z in (low, high))
        part = blocks.cut(first, (last[0] + 1, last[1] + 1, last[2] + 1))
        return self._sight.geometry(part, (low[0], low[1], low[2]))

    @cached_property
    def _captured(self) -> Terrain:
        """The blocks of the key `terrain`; air without it."""
        written, shape = self._written.get("terrain"), self._place.box.shape
        if written is None:
            return Terrain.full(shape, self._registry.air)
        return terrain_in(msgspec.convert(written, TerrainEntry), shape, self._registry)

    @cached_property
    def _whole(self) -> Geometry:
        return self._sight.geometry(self._place.blocks.dense(), self._place.box.low)

    @cached_property
    def _sight(self) -> Sight:
        options = self._options
        return Sight(
            self._registry,
            options.max_visible_distance,
            options.field_of_view,
            options.transparent_blocks,
        )

    @cached_property
    def _ground(self) -> Ground:
        return Ground(self._registry, self._place.box, self._place.blocks).with_doors_opened


def _part_of(entry: Mapping[str, Any]) -> Box | None:
    """Return the box of a `fill` or of `walls`; None: the entry is a single block."""
    corners = entry.get("fill") or entry.get("walls")
    return None if corners is None else Box.between(*(tuple(corner) for corner in corners))


def _is_inside_walls(entry: Mapping[str, Any], part: Box, cell: Position) -> bool:
    """Return True if a cell is inside four walls, and so not part of them."""
    (x, _, z), low, high = cell, part.low, part.high
    return bool(entry.get("walls")) and low[0] < x < high[0] and low[2] < z < high[2]


def _rule(
    document: Document, name: object, node: YamlNode, declared: Mapping[str, ParameterEntry]
) -> InstanceEntry:
    """Return the rules of a parameter.

    Raises:
        ScenarioError: They are wrong.
    """
    path = (_KEY, str(name))
    if name not in declared:
        hint = nearest_or_all(str(name), [*declared], "declared are")
        raise document.fault(path, f"is no parameter{hint}")
    rule = converted_at(document, path, plain(node) or {}, InstanceEntry)
    for other in rule.differs_from:
        if other not in declared:
            raise document.fault((*path, "differs_from"), f"{quoted(other)} is no parameter")
    if rule.within is None:
        for key in ("seen_by", "hidden_from", "reached_by"):
            if getattr(rule, key):
                raise document.fault((*path, key), "is a rule for places; give `within`, too")
        entry = declared[str(name)]
        if not entry.values and entry.range is None:
            raise document.fault(
                path, "has nothing to draw from; give `within`, or `values` of the parameter"
            )
    return rule


def _cells_of(corners: tuple[Position, Position]) -> list[Position]:
    low, high = Box.between(*corners).low, Box.between(*corners).high
    spans = (range(a, b + 1) for a, b in zip(low, high, strict=True))
    return [(x, y, z) for x, y, z in itertools.product(*spans)]
