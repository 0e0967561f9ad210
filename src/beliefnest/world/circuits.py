"""Facts about redstone power: what each block state does with it.

The build of the package writes them from the embedded world's own rules
(`worlds/minecraft/node/circuits.js`).
"""

import functools
from collections.abc import Mapping
from typing import Literal

import msgspec

from beliefnest.world.bundled import Bundled, read_bundled

_FORMAT = 1


class CircuitFacts(msgspec.Struct, frozen=True, rename="camel", forbid_unknown_fields=True):
    """Ticks and lengths of the rules.

    Attributes:
        range: Power of a source; a wire has one less for each block of its way.
        dims: Ticks after which a lamp without power goes dark.
        plate_looks: Ticks between two looks of a pressed plate at who stands on it.
        plate_inset: Distance between the edge of a plate's block and the part that is touched.
        plate_height: Height of the part of a plate that is touched.
    """

    range: int
    dims: int
    plate_looks: int
    plate_inset: float
    plate_height: float


class _File(Bundled, frozen=True, forbid_unknown_fields=True):
    facts: CircuitFacts
    conductors: list[int]
    connecting: list[int]
    sources: list[tuple[int, int]]
    powered: list[tuple[int, int]]
    unpowered: list[tuple[int, int]]
    halves: list[tuple[int, int]]
    plates: list[tuple[int, Literal["all", "living"]]]


class Circuits(msgspec.Struct, frozen=True, eq=False):
    """Facts about the block states of one Minecraft version.

    Attributes:
        facts: Ticks and lengths.
        conductors: States that carry power from a source that is attached to them.
        connecting: States to which wires beside them connect.
        sources: Sources that are on, each with the index in `FACES` of the block that it powers
            strongly; -1: none.
        powered: States that change when they get power, with the states that they get.
        unpowered: States that change when they have no power, with the states that they get.
        halves: Halves of doors, with the step in y to the other half.
        plates: Pressure plates, with what presses them.
    """

    facts: CircuitFacts
    conductors: frozenset[int]
    connecting: frozenset[int]
    sources: Mapping[int, int]
    powered: Mapping[int, int]
    unpowered: Mapping[int, int]
    halves: Mapping[int, int]
    plates: Mapping[int, Literal["all", "living"]]

    @staticmethod
    def load(version: str = "1.20.4") -> "Circuits":
        """Return the facts of a Minecraft version; each is read once per process.

        Raises:
            BodyError: The package was not built, or the file of the facts is damaged.
        """
        return _load(version)


@functools.lru_cache(maxsize=4)
def _load(version: str) -> Circuits:
    file = read_bundled("circuits", version, _File, _FORMAT)
    return Circuits(
        file.facts,
        frozenset(file.conductors),
        frozenset(file.connecting),
        dict(file.sources),
        dict(file.powered),
        dict(file.unpowered),
        dict(file.halves),
        dict(file.plates),
    )
