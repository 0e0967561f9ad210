"""Codec of settings, as run files store them."""

from typing import Literal

import msgspec

from beliefnest.belief.grounds import InitialBelief
from beliefnest.errors import StoreError
from beliefnest.nest.past.setting import Setting, Step
from beliefnest.perception.options import ContainerMode, Perception, Radius, Testimony
from beliefnest.timeline import codec
from beliefnest.world.values import Position

__all__ = ["decode_start", "encode_start"]

_FORM = 1


class _Form(msgspec.Struct):
    form: int


class _Perception(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    max_visible_distance: float | None
    field_of_view: float
    hearing: Literal["global", "sight"] | float
    containers: ContainerMode
    transparent_blocks: tuple[str, ...]
    negative_evidence: bool
    testimony: Testimony = "none"
    grace: int = 100
    sincere: bool = True
    speech_ticks: int = 0


class _Start(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    form: int
    world: str
    name: str
    snapshot: bytes
    perception: _Perception
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
            form=_FORM,
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
    if form != _FORM:
        raise StoreError(
            f"the run stores its setting in form {form}, and this version of beliefnest reads form "
            f"{_FORM}; use the version that recorded it"
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


def _perception_to(options: Perception) -> _Perception:
    fields = {name: getattr(options, name) for name in _Perception.__struct_fields__}
    if isinstance(options.hearing, Radius):
        fields["hearing"] = options.hearing.blocks
    return _Perception(**fields)


def _perception_from(stored: _Perception) -> Perception:
    fields = msgspec.structs.asdict(stored)
    if not isinstance(stored.hearing, str):
        fields["hearing"] = Radius(stored.hearing)
    return Perception(**fields)
