"""Cells of a plan: what is played once, with a unique name and a seed."""

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

import msgspec
from msgspec.structs import replace

if TYPE_CHECKING:
    from beliefnest.plan.terms import PlayStage

SEEDS = 2**32
"""Number of possible seeds of cells."""


@dataclass(frozen=True, slots=True)
class Key(ABC):
    """Identity of a cell; subclasses add its parts as fields."""

    @property
    def name(self) -> str:
        """Sixteen letters and digits, the same for the same cell on every machine."""
        return digest(self.content_json())[:16]

    @property
    @abstractmethod
    def seed(self) -> int:
        """Return the seed of all random numbers of the cell."""

    def content_json(self) -> dict[str, Any]:
        """Return all of it as plain values."""
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        return {n: dict(v) if isinstance(v, Mapping) else v for n, v in values.items()}


class Keyed(Protocol):
    """Cell of any kind of plan: it says how it is played, and the plan knows no kinds."""

    @property
    def key(self) -> Key:
        """Return the identity of the cell."""

    @property
    def world(self) -> str:
        """Name of the world that a worker starts for it ahead; empty: none."""

    @property
    def is_quick(self) -> bool:
        """True if it is played in a fraction of a second: it asks nobody far away."""

    def plain(self) -> dict[str, Any]:
        """Return the cell as plain values for the study's plan."""

    def play(self, stage: "PlayStage") -> dict[str, Any]:
        """Play the cell, and return its result as plain values, with None as `error`.

        Raises:
            BeliefNestError: The cell has no result.
        """


C = TypeVar("C", bound=Keyed)


def digest(value: object) -> str:
    """Return a hash of plain values, the same on every machine."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


def cell_seed(*parts: object) -> int:
    """Derive the seed of a cell from plain values, the same on every machine."""
    return int(digest(list(parts)), 16) % SEEDS


def variation_id(*parts: object) -> str:
    """Return a name for an independent variation, from the plain values that identify it.

    The name is the same on every machine and in every shard. It begins with a letter, so that no
    reader of tables parses it as a number.
    """
    return f"v{digest(list(parts))[:10]}"


def alike(key: Key, seeds: Collection[str]) -> str:
    """Return a hash that is the same for cells that differ only by their seed.

    Args:
        key: Identity of a cell.
        seeds: Keys of `content_json` that affect nothing but the seed.
    """
    return digest({k: v for k, v in key.content_json().items() if k not in seeds})[:16]


class Invalid(msgspec.Struct, frozen=True):
    """Combination that makes no valid scenario or episode.

    Attributes:
        scenario: Name, or path, of the scenario.
        condition: Number of the condition; None: the scenario has no conditions.
        variation: Values of parameters and of further changes.
        why: Reason.
    """

    scenario: str
    condition: int | None
    variation: Mapping[str, Any]
    why: str


class Plan(msgspec.Struct, Generic[C], frozen=True):
    """Cells of a study in the order of its table, and its invalid combinations."""

    cells: tuple[C, ...]
    invalid: tuple[Invalid, ...]

    def shard(self, number: int, count: int) -> "Plan[C]":
        """Return one of several disjoint parts of the plan; each cell is always in the same part.

        Args:
            number: Number of the part, from 1.
            count: Number of parts.
        """
        own = [cell for cell in self.cells if int(cell.key.name, 16) % count == number - 1]
        return replace(self, cells=tuple(own))
