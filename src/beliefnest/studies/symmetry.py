"""Mirrored and turned scenes: where blocks, points and gazes are, and how blocks face."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.world.registry import Registry, parse_state
from beliefnest.world.values import Box

__all__ = ["SYMMETRIES", "Placing", "Symmetry", "symmetry_named"]

_COMPASS = ("north", "east", "south", "west")
_SIDED = frozenset(("hinge", "type", "shape"))
"""Properties whose values say left or right; `type` is that of chests."""
_SIGN_STEPS = 16
"""Directions that a standing sign or head may have, clockwise from south."""


@dataclass(frozen=True, slots=True)
class Symmetry:
    """A change of a whole scene, seen from above: mirrored first, east to west, then turned.

    Attributes:
        mirrored: Whether east and west change places.
        turns: Quarter turns, clockwise, 0 to 3.
    """

    mirrored: bool = False
    turns: int = 0

    @property
    def name(self) -> str:
        """What it is called in studies, such as `mirrored-90`; `as-written` for none."""
        parts = ["mirrored"] if self.mirrored else []
        parts += [str(90 * self.turns)] if self.turns else []
        if parts and not self.mirrored:
            parts.insert(0, "turned")
        return "-".join(parts) or "as-written"

    def direction(self, name: str) -> str:
        """Where a compass direction goes to."""
        number = _COMPASS.index(name)
        if self.mirrored:
            number = -number
        return _COMPASS[(number + self.turns) % 4]

    def vector(self, x: float, z: float) -> tuple[float, float]:
        """Where a direction goes to; x grows to the east, z to the south."""
        x = -x if self.mirrored else x
        for _ in range(self.turns):
            x, z = -z, x
        return x, z

    def yaw(self, yaw: float) -> float:
        """Where a gaze goes to: radians, 0 north, pi/2 west."""
        turned = (-yaw if self.mirrored else yaw) - self.turns * math.pi / 2
        return math.remainder(turned, 2 * math.pi)

    def block_state(self, text: str, registry: Registry) -> str:
        """Return a block that faces, connects and hinges accordingly.

        Raises:
            UnknownNameError: There is no such block.
            InputError: No block state is the mirrored one.
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
        raise InputError(f"{text!r} cannot be {self.name}: there is no {changed!r}")

    def wanted_state(self, text: str, registry: Registry) -> str:
        """Return the same, of a text in which only the properties that it names count.

        Raises:
            UnknownNameError: There is no such block.
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
        """A state's text, and that with a rail's two directions named the other way round."""
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
"""All eight, `as-written` first."""


def symmetry_named(name: object) -> Symmetry:
    """Return the symmetry of a name.

    Raises:
        InputError: There is none of that name.
    """
    for symmetry in SYMMETRIES:
        if symmetry.name == name:
            return symmetry
    known = ", ".join(symmetry.name for symmetry in SYMMETRIES)
    raise InputError(f"there is no symmetry {name!r}; there are {known}")


@dataclass(frozen=True, slots=True)
class Placing:
    """Where a symmetry puts what is in a box; the new box begins where the old one does.

    Attributes:
        symmetry: The symmetry.
        box: The box as written.
    """

    symmetry: Symmetry
    box: Box

    def block(self, position: tuple[int, int, int]) -> tuple[int, int, int]:
        """Where a block goes to."""
        x, y, z = position
        # By its middle, which is what a symmetry keeps.
        new_x, _, new_z = self.point((x + 0.5, y, z + 0.5))
        return math.floor(new_x), y, math.floor(new_z)

    def point(self, point: tuple[float, float, float]) -> tuple[float, float, float]:
        """Where a point goes to."""
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
