"""Types of the keys in scenario and task files."""

from typing import Annotated

import msgspec

from beliefnest.world.limits import FARTHEST

__all__ = ["Point", "Position", "Within", "note"]


def note(text: str) -> msgspec.Meta:
    """Return the description of a key, for the published schema."""
    return msgspec.Meta(description=text)


_Whole = Annotated[int, msgspec.Meta(ge=-FARTHEST, le=FARTHEST)]
_Number = Annotated[float, msgspec.Meta(ge=-FARTHEST, le=FARTHEST)]
Position = tuple[_Whole, _Whole, _Whole]
Point = tuple[_Number, _Number, _Number]
Within = Annotated[float, msgspec.Meta(gt=0, le=FARTHEST)]
"""Distance in blocks."""
