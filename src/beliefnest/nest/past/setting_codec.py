"""Codec of settings, as run files store them."""

from typing import Any

import msgspec
from msgspec.structs import asdict

from beliefnest.belief.grounds import InitialBelief
from beliefnest.errors import InputError, StoreError
from beliefnest.nest.past.setting import Setting, Step
from beliefnest.perception.options import Perception, Radius
from beliefnest.timeline import codec
from beliefnest.world.values import Position

_FORM, _CUT_FORM = 1, 2
"""Forms of stored settings: of a box of one chunk, and of a box of several (see `world.terrain`).

Versions that cannot read boxes in chunks refuse the second form. They read the first, in which they
also stored large boxes.
"""


class _Form(msgspec.Struct):
    form: int


_ALWAYS_STORED = Perception.__struct_fields__[:6]
"""Options that every run file has; others came later, and are stored unless they are default."""


class _Start(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    form: int
    world: str
    name: str
    snapshot: bytes
    perception: dict[str, Any]
    static_blocks: tuple[str | Position, ...]
    initial_beliefs: tuple[InitialBelief, ...]
    script: tuple[Step, ...]
    absent: tuple[str, ...]
    labels: tuple[tuple[Position, str], ...] = ()
    places: tuple[tuple[str, Position], ...] = ()
    prompt_labels: tuple[tuple[Position, str], ...] = ()
    people: tuple[str, ...] = ()
    unique: tuple[str, ...] = ()


def _names_first(static: str | Position) -> tuple[bool, str | Position]:
    return not isinstance(static, str), static


def encode_start(setting: Setting, world: str) -> bytes:
    """Return the bytes of a setting and of the name of the world in which it was opened.

    Raises:
        StoreError: The setting contains a value that cannot be stored.
    """
    return codec.encode(
        _Start(
            form=_FORM if setting.snapshot.blocks.is_dense else _CUT_FORM,
            world=world,
            name=setting.name,
            snapshot=codec.encode_snapshot(setting.snapshot),
            perception=_perception_to(setting.perception),
            static_blocks=tuple(sorted(setting.static_blocks, key=_names_first)),
            initial_beliefs=setting.initial_beliefs,
            script=setting.script,
            absent=tuple(sorted(setting.absent)),
            labels=tuple(sorted(setting.labels.items())),
            places=tuple(sorted(setting.places.items())),
            prompt_labels=tuple(sorted(setting.prompt_labels.items())),
            people=tuple(sorted(setting.people)),
            unique=tuple(sorted(setting.unique)),
        )
    )


def decode_start(data: bytes) -> tuple[Setting, str]:
    """Return the setting and the name of the world from the bytes of `encode_start`.

    Raises:
        StoreError: The bytes are not those of a setting, or have the form of another version.
    """
    form = codec.decode(data, _Form).form
    if form not in (_FORM, _CUT_FORM):
        raise StoreError(
            f"the run stores its setting in form {form}, and this version of beliefnest reads "
            f"forms {_FORM} and {_CUT_FORM}; use the version that recorded it"
        )
    start = codec.decode(data, _Start)
    setting = Setting(
        name=start.name,
        snapshot=codec.decode_snapshot(start.snapshot),
        perception=_perception_from(start.perception),
        static_blocks=frozenset(start.static_blocks),
        initial_beliefs=start.initial_beliefs,
        script=start.script,
        absent=frozenset(start.absent),
        labels=dict(start.labels),
        places=dict(start.places),
        prompt_labels=dict(start.prompt_labels),
        people=frozenset(start.people),
        unique=frozenset(start.unique),
    )
    return setting, start.world


def _perception_to(options: Perception) -> dict[str, Any]:
    default, values = asdict(Perception()), asdict(options)
    if isinstance(options.hearing, Radius):
        values["hearing"] = options.hearing.blocks
    return {
        name: value
        for name, value in values.items()
        if name in _ALWAYS_STORED or value != default[name]
    }


def _perception_from(stored: dict[str, Any]) -> Perception:
    hearing = stored.get("hearing")
    values = {**stored, "hearing": hearing if isinstance(hearing, str) else {"radius": hearing}}
    try:
        return msgspec.convert(values, Perception)
    except (msgspec.ValidationError, InputError) as error:
        raise StoreError(f"the run file stores invalid options of perception: {error}") from None
