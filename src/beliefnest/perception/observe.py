"""The observation function `O_i` of the paper: what one agent perceives of one simulator.

Pure functions. What there is to perceive is a `Scene`; nothing outside it is consulted
(semantics, sections 3 and 5).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from beliefnest.perception.options import Perception, Radius
from beliefnest.perception.terrain import Terrain
from beliefnest.world.values import EYE_HEIGHT, DroppedItem, Event, EventKind, Point

__all__ = ["ITEM_HEIGHT", "Percept", "Pose", "Scene", "eye_of", "observe"]

ITEM_HEIGHT = 0.125
"""Height of a dropped item's middle above its position, in blocks."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Where an agent stands and looks.

    Attributes:
        position: Middle of the feet, blocks.
        yaw: Radians, Mineflayer's convention.
        pitch: Radians, positive upwards.
    """

    position: Point
    yaw: float
    pitch: float


def eye_of(pose: Pose) -> Point:
    """Position of the eye, 1.62 blocks above the feet."""
    x, y, z = pose.position
    return (x, y + EYE_HEIGHT, z)


@dataclass(frozen=True, slots=True)
class Scene:
    """What there is to perceive in one simulator at one tick.

    Attributes:
        terrain: Its blocks; unknown ones hide nothing.
        poses: Agents whose pose is known there.
        present: Those of them whose pose is current there (semantics, 5.1).
        items: Dropped items known there.
        events: What happened there in this tick, as far as its holder perceived it.
    """

    terrain: Terrain
    poses: Mapping[str, Pose]
    present: frozenset[str]
    items: Mapping[int, DroppedItem]
    events: tuple[Event, ...]


@dataclass(frozen=True, slots=True)
class Percept:
    """What one agent perceives in one tick.

    Attributes:
        agent: The perceiver.
        pose: Its own pose; None if it is not present, then it sees nothing.
        visible: bool, shape of the box: the blocks it sees; None if it is not present.
        agents: The agents it sees, itself included.
        items: The dropped items it sees.
        events: The events it perceives, its own included.
    """

    agent: str
    pose: Pose | None
    visible: npt.NDArray[np.bool_] | None
    agents: frozenset[str]
    items: frozenset[int]
    events: tuple[Event, ...]


def observe(scene: Scene, agent: str, options: Perception) -> Percept:
    """What `agent` perceives of a scene.

    An agent that is not present is credited with nothing but what is common ground:
    speech under global hearing (semantics, 5.2 and 5.5).
    """
    if agent not in scene.present:
        heard = tuple(e for e in scene.events if _is_common_ground(e, options))
        return Percept(agent, None, None, frozenset(), frozenset(), heard)
    pose = scene.poses[agent]
    seen = _seen_agents(scene, agent, pose)
    visible = scene.terrain.visible(eye_of(pose), pose.yaw, pose.pitch)
    events = tuple(e for e in scene.events if _perceives(scene, agent, visible, seen, e, options))
    return Percept(agent, pose, visible, seen, _seen_items(scene, pose), events)


def _is_common_ground(event: Event, options: Perception) -> bool:
    return event.kind is EventKind.CHAT and options.hearing == "global"


def _seen_agents(scene: Scene, agent: str, pose: Pose) -> frozenset[str]:
    others = [name for name in scene.poses if name != agent]
    if not others:
        return frozenset({agent})
    feet = [scene.poses[name].position for name in others]
    flags = scene.terrain.geometry.sees_agents(eye_of(pose), pose.yaw, pose.pitch, feet)
    seen = [name for name, flag in zip(others, flags.tolist(), strict=True) if flag]
    return frozenset([agent, *seen])


def _seen_items(scene: Scene, pose: Pose) -> frozenset[int]:
    if not scene.items:
        return frozenset()
    points = [(x, y + ITEM_HEIGHT, z) for x, y, z in (i.position for i in scene.items.values())]
    flags = scene.terrain.geometry.sees_points(eye_of(pose), pose.yaw, pose.pitch, points)
    return frozenset(n for n, flag in zip(scene.items, flags.tolist(), strict=True) if flag)


def _perceives(
    scene: Scene,
    agent: str,
    visible: npt.NDArray[np.bool_],
    seen: frozenset[str],
    event: Event,
    options: Perception,
) -> bool:
    """Whether a present agent perceives an event."""
    if event.actor == agent:
        return True
    match event.kind:
        case EventKind.THINK:
            return False
        case EventKind.CHAT:
            return _hears(scene, agent, seen, event.actor, options)
        case EventKind.BLOCK_UPDATE:
            return bool(visible[scene.terrain.box.index(event.detail["position"])])
        case _:
            return event.actor in seen


def _hears(
    scene: Scene, agent: str, seen: frozenset[str], speaker: str | None, options: Perception
) -> bool:
    match options.hearing:
        case "global":
            return True
        case Radius(blocks):
            there = scene.poses.get(speaker) if speaker is not None else None
            if there is None:
                return False
            return math.dist(scene.poses[agent].position, there.position) <= blocks
        case _:
            return speaker in seen
