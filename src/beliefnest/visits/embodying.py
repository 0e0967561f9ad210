"""Simulators that stand in Minecraft for people to visit, kept equal to the simulators' states.

This is process F-2 of the paper, "reflecting state in the simulator environment".
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from beliefnest.belief.node_view import NodeView
from beliefnest.errors import InputError
from beliefnest.nest.acting.placement import BodySpace
from beliefnest.nest.past.embodiable import with_chests
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import TimelineKey
from beliefnest.visits.layout import Layout, Standing
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.registry import AIR
from beliefnest.world.values import AgentState, Position, block_at
from beliefnest.worlds.minecraft.exhibits import Exhibit, Plot, Shown, display_names, origin_of
from beliefnest.worlds.servers.realtime import RealtimeWorld

_REALITY: BeliefPath = ()
_RADII = (8, 32, 64)
"""Distances in blocks within which a place to stand is searched, one after the other."""


@dataclass
class _Embodied:
    """Simulator that stands in Minecraft.

    Attributes:
        plot: Its plot.
        names: Names of its agents in Minecraft, by agent.
        unknown: Block state that stands for unknown blocks.
        exhibit: The exhibit in the world; None: it does not stand yet.
        when: Timeline and entry up to which the exhibit was brought last.
    """

    plot: Plot
    names: Mapping[str, str]
    unknown: int
    exhibit: Exhibit | None = None
    when: tuple[TimelineKey, int] | None = None


class Embodying:
    """Beliefs of a nest that stand in Minecraft."""

    def __init__(self, recording: Recording, world: RealtimeWorld) -> None:
        self._recording = recording
        self._world = world
        self._standing: dict[BeliefPath, _Embodied] = {}

    @property
    def follows(self) -> bool:
        """True if any simulator stands in Minecraft."""
        return bool(self._standing)

    def begin(self, path: BeliefPath, unknown: str) -> None:
        """Show a simulator in Minecraft; see `Simulator.embody`."""
        state = self._recording.context.registry.state_id(unknown)
        if path == _REALITY:
            raise InputError(
                "the real world stands in Minecraft already, so it cannot be embodied; "
                "nest.layout() says where it stands"
            )
        self._show(path, state)
        if not self._world.shows_reality:
            self._show(_REALITY, AIR)

    def end(self, path: BeliefPath) -> None:
        """Remove a simulator from Minecraft."""
        self._close(path)
        if self._standing.keys() == {_REALITY}:
            self._close(_REALITY)

    def keep_up(self) -> None:
        """Bring all embodied simulators up to what is recorded by now."""
        for path, standing in self._standing.items():
            info = self._recording.info(path)
            when = (info.key, info.entries)
            exhibit = standing.exhibit
            if exhibit is None or exhibit.lost:
                shown, _ = self._shown(path, standing)
                standing.exhibit = self._world.open_exhibit(path_text(path), standing.plot, shown)
            elif when != standing.when:
                exhibit.show(*self._shown(path, standing))
            standing.when = when

    def look_again(self) -> None:
        """Compare all embodied simulators again, because entries were taken back."""
        for standing in self._standing.values():
            standing.when = None

    def layout(self) -> Layout:
        """Return the places of the real world and of all embodied simulators in Minecraft."""
        plots = {path: each.plot for path, each in self._standing.items()}
        reality = plots.pop(_REALITY, None) or self._plot(_REALITY, 0)
        lags = self._world.lags() if self._standing else {}
        return Layout(
            Standing(
                path_text(path),
                *plot.corners,
                plot.origin,
                "/tp {} {} {}".format(*plot.stand),
                lags.get(path_text(path), 0),
            )
            for path, plot in {_REALITY: reality, **plots}.items()
        )

    def _show(self, path: BeliefPath, unknown: int) -> None:
        before = self._standing.get(path)
        if before is not None:
            before.unknown, before.when = unknown, None
        else:
            number = 0 if path == _REALITY else self._free_number()
            self._standing[path] = self._planned(path, number, unknown)
        try:
            self.keep_up()
        except BaseException:
            if before is None:
                del self._standing[path]
            raise

    def _planned(self, path: BeliefPath, number: int, unknown: int) -> _Embodied:
        agents = self._recording.agents
        names: Mapping[str, str] = {name: name for name in agents}
        if number:
            others = [name for each in self._standing.values() for name in each.names.values()]
            names = display_names(agents, number, {*agents, *others, *self._world.players})
        return _Embodied(self._plot(path, number), names, unknown)

    def _free_number(self) -> int:
        taken = {standing.plot.origin for standing in self._standing.values()}
        box, number = self._recording.box, 1
        while origin_of(number, box, self._world.origin) in taken:
            number += 1
        return number

    def _plot(self, path: BeliefPath, number: int) -> Plot:
        box = self._recording.box
        x, z = origin = origin_of(number, box, self._world.origin)
        stand = self._stand(self._recording.state(path))
        return Plot(box, origin, (stand[0] + x, stand[1], stand[2] + z))

    def _stand(self, reading: NodeView) -> Position:
        """Return the free position nearest to the middle of the agents.

        If no agent's position is known, it is the one nearest to the middle of the box; if there
        is none near, the middle itself.
        """
        box = self._recording.box
        space = BodySpace(self._recording.context.registry, box, reading.terrain)
        places = [each.position for each in reading.agents.values() if each.position is not None]
        taken = {block_at(place) for place in places}
        middle = np.array(places or [box.low, box.high], dtype=float).mean(axis=0)
        # Nobody stands within a full cube.
        cubes = [s for s in reading.terrain.states if s >= 0 and space.registry.is_full(s)]
        for radius in _RADII:
            # All cells within the radius are in the part.
            low = np.maximum(np.floor(middle - radius).astype(int), box.low)
            high = np.minimum(np.floor(middle + radius).astype(int), box.high)
            (a, b, c), (d, e, f) = low - box.low, np.maximum(high + 1, low) - box.low
            part = reading.terrain.cut((a, b, c), (d, e, f))
            cells = np.argwhere(~np.isin(part, cubes)) + low
            (i, j, k), (u, v, w) = low.tolist(), np.maximum(high, low).tolist()
            ground = space.ground((i, j, k), (u, v, w))
            distances = np.linalg.norm(cells + 0.5 - middle, axis=1)
            for number in distances.argsort(kind="stable"):
                if distances[number] > radius:
                    break
                x, y, z = map(int, cells[number])
                is_free = (x, y, z) not in taken and ground.stands((x, y, z))
                if is_free and space.has_floor(ground.feet((x, y, z))):
                    return x, y, z
        return block_at(middle)

    def _shown(self, path: BeliefPath, standing: _Embodied) -> tuple[Shown, int]:
        """Return the contents of a simulator's exhibit, and the tick of its latest change."""
        reading, registry = self._recording.state(path), self._recording.context.registry
        contents = {place: store.items for place, store in reading.containers.items()}
        blocks = with_chests(registry, self._recording.box, reading.terrain, contents)
        agents = {
            standing.names[name]: AgentState(
                position=agent.position,
                yaw=agent.yaw,
                pitch=agent.pitch,
                on_ground=agent.on_ground,
                equipment=dict(agent.equipment or {}),
            )
            for name, agent in reading.agents.items()
            if agent.position is not None
        }
        shown = Shown(
            blocks.mapped(lambda part: np.where(part < 0, np.int32(standing.unknown), part)),
            {p: (dict(store.items), store.complete) for p, store in reading.containers.items()},
            {place: text for place, text in reading.texts.items() if place not in contents},
            agents,
        )
        return shown, reading.tick

    def _close(self, path: BeliefPath) -> None:
        standing = self._standing.pop(path, None)
        if standing is not None and standing.exhibit is not None:
            standing.exhibit.close()
