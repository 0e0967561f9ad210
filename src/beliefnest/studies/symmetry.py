"""Symmetries of scenes: moved blocks and points, turned gazes and block states."""

import math
from collections.abc import Mapping

import msgspec

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.world.registry import Registry, parse_state
from beliefnest.world.terrain import BlockStates, Terrain
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box

_COMPASS = ("north", "east", "south", "west")
_SIDED = frozenset(("hinge", "type", "shape"))
"""Properties whose values are left or right; `type` belongs to chests."""
_SIGN_STEPS = 16
"""Number of directions of a standing sign or head, clockwise from south."""


class Symmetry(msgspec.Struct, frozen=True):
    """Symmetry of a scene, seen from above: first a mirroring of east and west, then a turn.

    Attributes:
        mirrored: True if east and west change places.
        turns: Number of clockwise quarter turns, 0 to 3.
    """

    mirrored: bool = False
    turns: int = 0

    @property
    def name(self) -> str:
        """Return its name in studies, such as `mirrored-90`; `as-written` for the identity."""
        parts = ["mirrored"] if self.mirrored else []
        parts += [str(90 * self.turns)] if self.turns else []
        if parts and not self.mirrored:
            parts.insert(0, "turned")
        return "-".join(parts) or "as-written"

    def direction(self, name: str) -> str:
        """Return the image of a compass direction."""
        number = _COMPASS.index(name)
        if self.mirrored:
            number = -number
        return _COMPASS[(number + self.turns) % 4]

    def vector(self, x: float, z: float) -> tuple[float, float]:
        """Return the image of a direction; x grows to the east, z to the south."""
        x = -x if self.mirrored else x
        for _ in range(self.turns):
            x, z = -z, x
        return x, z

    def yaw(self, yaw: float) -> float:
        """Return the image of a yaw, in radians: 0 is north, pi/2 is west."""
        turned = (-yaw if self.mirrored else yaw) - self.turns * math.pi / 2
        return math.remainder(turned, 2 * math.pi)

    def block_state(self, text: str, registry: Registry) -> str:
        """Return a block state with its facing, connections, hinges and rotation changed.

        Raises:
            UnknownNameError: The block does not exist.
            InputError: The changed block state does not exist.
        """
        state = registry.state_id(text)
        name, old = registry.name(state), registry.properties(state)
        if not old or self == Symmetry():
            return text
        new = {self._key(key): self._value(name, key, value) for key, value in old.items()}
        changed = f"{name}[{','.join(f'{key}={value}' for key, value in sorted(new.items()))}]"
        if set(new) == set(old):
            for candidate in self._spellings(name, new):
                if _is_state(candidate, registry):
                    return candidate
        raise InputError(f"{quoted(text)} cannot be {self.name}: there is no {quoted(changed)}")

    def wanted_state(self, text: str, registry: Registry) -> str:
        """Return a changed partial block state, in which only the named properties count.

        Raises:
            UnknownNameError: The block does not exist.
        """
        registry.state_id(text)
        name, stated = parse_state(text)
        new = [f"{self._key(key)}={self._value(name, key, v)}" for key, v in stated.items()]
        return f"{name}[{','.join(new)}]" if new else text

    def _key(self, key: str) -> str:
        return self.direction(key) if key in _COMPASS else key

    def _value(self, block: str, key: str, value: str) -> str:
        if key == "axis" and self.turns % 2:
            return {"x": "z", "z": "x"}.get(value, value)
        if key == "rotation":
            steps = -int(value) if self.mirrored else int(value)
            return str((steps + self.turns * _SIGN_STEPS // 4) % _SIGN_STEPS)
        words = [self.direction(word) if word in _COMPASS else word for word in value.split("_")]
        sided = key in _SIDED and (key != "type" or block.endswith("chest"))
        if self.mirrored and sided:
            words = [{"left": "right", "right": "left"}.get(word, word) for word in words]
        return "_".join(words)

    def _spellings(self, name: str, properties: Mapping[str, str]) -> list[str]:
        """Return the spellings of a state: a rail's two directions may be in either order."""
        other = {**properties}
        if "shape" in other:
            other["shape"] = "_".join(reversed(other["shape"].split("_")))
        return [
            f"{name}[{','.join(f'{key}={each[key]}' for key in sorted(each))}]"
            for each in (properties, other)
        ]


def _is_state(text: str, registry: Registry) -> bool:
    try:
        registry.state_id(text)
    except BeliefNestError:
        return False
    return True


SYMMETRIES = tuple(Symmetry(mirrored, turns) for mirrored in (False, True) for turns in range(4))
"""All eight symmetries, `as-written` first."""


def symmetry_named(name: object) -> Symmetry:
    """Return the symmetry of a name.

    Raises:
        InputError: The name is unknown.
    """
    for symmetry in SYMMETRIES:
        if symmetry.name == name:
            return symmetry
    names = ", ".join(symmetry.name for symmetry in SYMMETRIES)
    raise InputError(f"there is no symmetry {quoted(name)}; there are {names}")


class Placing(msgspec.Struct, frozen=True):
    """Map of positions in a box under a symmetry; the new box has the same lowest corner.

    Attributes:
        symmetry: The symmetry.
        box: The box as written.
    """

    symmetry: Symmetry
    box: Box

    def block(self, position: tuple[int, int, int]) -> tuple[int, int, int]:
        """Return the new position of a block."""
        x, y, z = position
        # Map the middle of the block: its lowest corner does not map to a lowest corner.
        new_x, _, new_z = self.point((x + 0.5, y, z + 0.5))
        return math.floor(new_x), y, math.floor(new_z)

    def terrain(self, terrain: Terrain) -> Terrain:
        """Return the new blocks of the box, each with its old state."""
        return Terrain.of(_Moved(self.symmetry, terrain))

    def point(self, point: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return the new position of a point."""
        x, y, z = point
        low, high = self.box.low, self.box.high
        width, depth = high[0] + 1 - low[0], high[2] + 1 - low[2]
        i, k = x - low[0], z - low[2]
        if self.symmetry.mirrored:
            i = width - i
        for _ in range(self.symmetry.turns):
            i, k = depth - k, i
            width, depth = depth, width
        return i + low[0], y, k + low[2]


class _Moved(msgspec.Struct, frozen=True):
    """Blocks of a terrain at their new positions, computed in slabs."""

    symmetry: Symmetry
    terrain: Terrain

    @property
    def shape(self) -> tuple[int, int, int]:
        x, y, z = self.terrain.shape
        return (z, y, x) if self.symmetry.turns % 2 else (x, y, z)

    def __getitem__(self, layers: slice, /) -> BlockStates:
        first, last, _ = layers.indices(self.shape[0])
        mirrored, turns = self.symmetry.mirrored, self.symmetry.turns
        # A quarter turn clockwise leads from (x, z) to (depth - z, x).
        x_is_reversed = mirrored != (turns in (2, 3))
        z_is_reversed = turns in (1, 2)
        x, y, z = self.terrain.shape
        low, high = [0, 0, 0], [x, y, z]
        axis, is_reversed = (2, z_is_reversed) if turns % 2 else (0, x_is_reversed)
        side = high[axis]
        low[axis], high[axis] = (side - last, side - first) if is_reversed else (first, last)
        cells = self.terrain.cut((low[0], low[1], low[2]), (high[0], high[1], high[2]))
        cells = cells[:: -1 if x_is_reversed else 1, :, :: -1 if z_is_reversed else 1]
        return cells.transpose(2, 1, 0) if turns % 2 else cells
