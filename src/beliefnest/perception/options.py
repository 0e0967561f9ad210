"""Options of the observation function, which decides what agents perceive (semantics, 3)."""

import math
import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple, get_args

import msgspec

from beliefnest.errors import InputError
from beliefnest.world.forms import note
from beliefnest.world.limits import FARTHEST
from beliefnest.world.texts import quoted
from beliefnest.world.words import listed

ContainerMode = Literal["opaque", "transparent"]
Testimony = Literal["none", "accept", "informed"]


class Radius(msgspec.Struct, frozen=True, forbid_unknown_fields=True, rename={"blocks": "radius"}):
    """Hearing up to a distance.

    Attributes:
        blocks: Greatest distance between listener's and speaker's feet, in blocks.
    """

    blocks: Annotated[float, msgspec.Meta(gt=0, le=FARTHEST, description="In blocks.")]


Hearing = Literal["global", "sight"] | Radius

HEAR_ALL, HEAR_SEEN, HEAR_NEAR = range(3)
"""Numbers of the ways of hearing in kernels: global, sight, radius."""


class SenseLimits(NamedTuple):
    """Options of `Perception` that kernels read, as numbers.

    Attributes:
        far: Greatest visible distance, blocks, infinite if there is no limit.
        cos_half: Cosine of half the field of view; -2: in all directions.
        hearing: One of `HEAR_ALL`, `HEAR_SEEN`, `HEAR_NEAR`.
        radius: Greatest distance of hearing, blocks; infinite unless it is `HEAR_NEAR`.
        negative: True if a pose becomes unknown when its place is seen empty.
    """

    far: float
    cos_half: float
    hearing: int
    radius: float
    negative: bool


if TYPE_CHECKING:  # In code these options have further forms, which `__post_init__` makes one.
    _Hearing = Hearing | Mapping[str, float] | str
    _Names = Iterable[str]
else:  # Files have one form.
    _Hearing = Hearing
    _Names = tuple[str, ...]

_SPELLED_RADIUS = re.compile(r"radius:\s*([0-9]+(?:\.[0-9]+)?)")
"""The text form of the mapping that scenario files use."""


def _hearing(value: object) -> Hearing:
    match value:
        case "global" | "sight":
            return value
        case Radius() if value.blocks > 0:
            return value
        case {"radius": int() | float() as blocks} if blocks > 0:
            return Radius(float(blocks))
        case str() if (spelled := _SPELLED_RADIUS.fullmatch(value)) and float(spelled[1]) > 0:
            return Radius(float(spelled[1]))
        case _:
            raise InputError(
                f"hearing is {quoted(value)}; it must be 'global', 'sight' or {{'radius': BLOCKS}} "
                "with BLOCKS above 0"
            )


class Perception(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Perception of agents; the same for all agents, at every depth.

    Attributes:
        max_visible_distance: Greatest distance from an eye to the centre of a visible
            block, in blocks; None: no limit.
        field_of_view: Full angle of the cone of sight around yaw and pitch, in degrees;
            360: in all directions.
        hearing: `global` (everyone hears everything), `sight` (an agent hears whom it
            sees), or `Radius(r)`, also written `{"radius": r}` or `radius: r`.
        containers: `opaque`: agents learn contents by opening a container or by witnessing
            transfers. `transparent`: agents perceive contents whenever they see the block.
        transparent_blocks: Names of further blocks that do not block sight.
        negative_evidence: If True, a believed pose becomes unknown when the agent's place is
            seen to be empty.
        testimony: Effect of claims on hearers (semantics, section 8). `none`: hearers know the
            text only. `accept`: hearers believe every claim. `informed`: a hearer believes a
            claim if it could not look itself and the speaker had a chance to learn the fact.
        grace: Under `informed`, the number of ticks that a speaker must be out of the hearer's
            sight before the hearer assumes that the speaker may have learnt something.
        sincere: Under `informed`, True if hearers assume that speakers believe what they say.
            If False, a hearer that rejects a claim does not attribute it to the speaker either.
        speech_ticks: Ticks that an agent needs to say or whisper something in a program. Others
            hear it at the end. 0: they hear it in the next tick.

    Raises:
        InputError: An option is out of range or of the wrong kind.
    """

    max_visible_distance: Annotated[float | None, note("In blocks; null: no limit.")] = 20.0
    field_of_view: Annotated[float, note("Full angle of sight in degrees, up to 360.")] = 360.0
    hearing: Annotated[_Hearing, note("Speakers that an agent hears.")] = "global"
    containers: Annotated[ContainerMode, note("Visibility of contents from outside.")] = "opaque"
    transparent_blocks: Annotated[_Names, note("Further blocks that do not block sight.")] = ()
    negative_evidence: Annotated[
        bool, note("True if seeing an empty place makes a pose believed there unknown.")
    ] = False
    testimony: Annotated[
        Testimony,
        note("Claims that hearers believe: none, all, or those of speakers who may know better."),
    ] = "none"
    grace: Annotated[
        int,
        msgspec.Meta(ge=0, description="Ticks out of sight after which a speaker may know better."),
    ] = 100
    sincere: Annotated[
        bool, note("True if hearers assume that speakers believe what they say.")
    ] = True
    speech_ticks: Annotated[
        int, msgspec.Meta(ge=0, le=1200, description="Ticks needed to say something.")
    ] = 0

    def __post_init__(self) -> None:
        distance = self.max_visible_distance
        if distance is not None and not distance > 0:
            raise InputError(
                f"max_visible_distance is {quoted(distance)}; it must be above 0, or null "
                "(None in Python) for no limit"
            )
        if not 0 < self.field_of_view <= 360:
            raise InputError(
                f"field_of_view is {quoted(self.field_of_view)} degrees; it must be above 0 and "
                "up to 360"
            )
        for name, kind in (("containers", ContainerMode), ("testimony", Testimony)):
            value, choices = getattr(self, name), get_args(kind)
            if value not in choices:
                words = listed([repr(choice) for choice in choices], "or")
                raise InputError(f"{name} is {quoted(value)}; it must be {words}")
        if not isinstance(self.grace, int) or isinstance(self.grace, bool) or self.grace < 0:
            raise InputError(
                f"grace is {quoted(self.grace)}; it must be a whole number of ticks from 0"
            )
        speech = self.speech_ticks
        if not isinstance(speech, int) or isinstance(speech, bool) or speech < 0:
            raise InputError(f"speech_ticks is {quoted(speech)}; it must be a whole number from 0")
        if not isinstance(self.sincere, bool):
            raise InputError(f"sincere is {quoted(self.sincere)}; it must be True or False")
        msgspec.structs.force_setattr(self, "hearing", _hearing(self.hearing))
        msgspec.structs.force_setattr(
            self, "transparent_blocks", tuple(sorted(set(self.transparent_blocks)))
        )

    @property
    def limits(self) -> SenseLimits:
        """The options that kernels read."""
        hearing = self.hearing
        far, cos_half = sight_limits(self.max_visible_distance, self.field_of_view)
        return SenseLimits(
            far,
            cos_half,
            {"global": HEAR_ALL, "sight": HEAR_SEEN}.get(str(hearing), HEAR_NEAR),
            hearing.blocks if isinstance(hearing, Radius) else math.inf,
            self.negative_evidence,
        )


def sight_limits(max_visible_distance: float | None, field_of_view: float) -> tuple[float, float]:
    """Return the greatest visible distance and the cosine of half the field of view.

    These are the first two `SenseLimits`; the arguments are those of `Perception`.
    """
    cos_half = -2.0 if field_of_view >= 360 else math.cos(math.radians(field_of_view) / 2)
    return math.inf if max_visible_distance is None else float(max_visible_distance), cos_half
