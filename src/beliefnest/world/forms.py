"""Types of the keys in scenario and task files."""

from collections.abc import Iterator
from typing import Annotated, get_type_hints

import msgspec

from beliefnest.world.limits import FARTHEST


def note(text: str, scene: str | None = None) -> msgspec.Meta:
    """Return the description of a key, for the published schema.

    Args:
        text: The description.
        scene: Kind of the value for mirrored, turned or renamed scenes, such as `block`
            (`studies.scene_changes`), in brackets for a list; None: not stated here.
    """
    return msgspec.Meta(description=text, extra=None if scene is None else {"scene": scene})


def scene_kinds(form: type[msgspec.Struct]) -> dict[str, str]:
    """Return the kinds of the values in copies of a scene, by key, for keys that have a kind."""
    return {key: meta.extra["scene"] for key, meta in _metas(form) if meta.extra is not None}


def notes(form: type[msgspec.Struct]) -> dict[str, str]:
    """Return the descriptions of the keys."""
    return {key: meta.description for key, meta in _metas(form) if meta.description is not None}


def _metas(form: type[msgspec.Struct]) -> Iterator[tuple[str, msgspec.Meta]]:
    for key, hint in get_type_hints(form, include_extras=True).items():
        for meta in getattr(hint, "__metadata__", ()):
            if isinstance(meta, msgspec.Meta):
                yield key, meta


_Whole = Annotated[int, msgspec.Meta(ge=-FARTHEST, le=FARTHEST)]
_Number = Annotated[float, msgspec.Meta(ge=-FARTHEST, le=FARTHEST)]
WrittenPosition = tuple[_Whole, _Whole, _Whole]
WrittenPoint = tuple[_Number, _Number, _Number]
Within = Annotated[float, msgspec.Meta(ge=0, le=FARTHEST)]
"""Distance in blocks; 0: exactly there."""
