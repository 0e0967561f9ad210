"""Looks of an agent at other agents and at blocks inside one simulator, and their results."""

import dataclasses
import math
from collections.abc import Callable

import numpy as np
from msgspec.structs import replace

from beliefnest.belief.grounds import AgentBelief
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.explain.parts import Sighting, View
from beliefnest.perception.percept import Gaze, gaze_from
from beliefnest.perception.sight import SightLines
from beliefnest.world.values import (
    AGENT_SAMPLE_HEIGHTS,
    BODY_CENTRE_HEIGHT,
    Box,
    Point,
    Position,
)

_Sees = Callable[[SightLines], bool]


def sighting_of_block(reading: NodeView, box: Box, viewer: str, place: Position) -> Sighting:
    """Return the look of an agent of known pose at a block, inside a simulator."""
    here = reading.agents[viewer]
    cells = np.array([place])

    def sees(geometry: SightLines) -> bool:
        return bool(geometry.sees_blocks(*_gaze(here), cells)[0])

    name = _block_name(reading, box, place)
    x, y, z = place
    centre = (x + 0.5, y + 0.5, z + 0.5)
    away = math.dist(_gaze(here).eye, centre)
    look = Sighting(name or "block", place, _view(reading.geometry, sees, away), away)
    # The block that is looked at does not block its own rays.
    return _with_blocker(look, reading, box, _gaze(here).eye, [centre], place)


def sighting_of_agent(reading: NodeView, box: Box, viewer: str, other: str) -> Sighting:
    """Return the look of an agent of known pose at another, inside a simulator."""
    here, seen = reading.agents[viewer], reading.agents[other]
    if seen.position is None:
        return Sighting(other, None, View.PLACE_UNKNOWN)
    feet = np.array([seen.position])

    def sees(geometry: SightLines) -> bool:
        return bool(geometry.sees_agents(*_gaze(here), feet)[0])

    x, y, z = seen.position
    centre = (x, y + BODY_CENTRE_HEIGHT, z)
    samples = [centre, *((x, y + height, z) for height in AGENT_SAMPLE_HEIGHTS)]
    away = math.dist(_gaze(here).eye, centre)
    look = Sighting(other, seen.position, _view(reading.geometry, sees, away), away)
    return _with_blocker(look, reading, box, _gaze(here).eye, samples)


def _view(geometry: SightLines, sees: _Sees, away: float) -> View:
    """Return the result of a look at something `away` blocks away.

    What is too far away is `TOO_FAR`, whatever is between. Otherwise the look is `OUTSIDE_VIEW` if
    it succeeds in all directions, and `BLOCKED` if it fails even then.
    """
    if sees(geometry):
        return View.SEEN
    far = geometry.sight.max_visible_distance
    if far is not None and away > far:
        return View.TOO_FAR
    all_round = dataclasses.replace(geometry.sight, field_of_view=360.0)
    return (
        View.OUTSIDE_VIEW if sees(dataclasses.replace(geometry, sight=all_round)) else View.BLOCKED
    )


def _with_blocker(
    look: Sighting,
    reading: NodeView,
    box: Box,
    eye: Point,
    samples: list[Point],
    target: Position | None = None,
) -> Sighting:
    if look.view is not View.BLOCKED:
        return look
    for sample in samples:
        place = reading.geometry.blocker(eye, sample, target)
        if place is not None:
            return replace(look, blocker=place, blocker_name=_block_name(reading, box, place))
    return look


def _gaze(agent: AgentBelief) -> Gaze:
    if agent.position is None:
        raise AssertionError("a look needs a viewer of known pose")
    return gaze_from(agent.position, agent.yaw, agent.pitch)


def _block_name(reading: NodeView, box: Box, place: Position) -> str | None:
    state = reading.terrain[box.index(place)]
    return None if state < 0 else reading.geometry.sight.registry.name(state)
