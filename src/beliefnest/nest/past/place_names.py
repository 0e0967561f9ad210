"""Names of containers, signs and places of a setting, for prose and for right answers."""

from collections.abc import Callable, Mapping, Sequence
from typing import Final

from beliefnest.nest.past.setting import Setting
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.registry import Registry
from beliefnest.world.signs import is_sign, plain_state
from beliefnest.world.texts import on_one_line
from beliefnest.world.values import Position

__all__ = ["object_names", "place_names", "sign_places"]

_SIDES: Final = (("western", "eastern"), ("northern", "southern"), ("lower", "upper"))
"""Words for two objects that differ in x, else z, else y."""
_AXES: Final = (0, 2, 1)
_ORDINALS: Final = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth")


def object_names(setting: Setting) -> Mapping[Position, str]:
    """Return names of containers, signs, doors and switches, without articles, by position.

    The name is the label, else the kind of block, such as `chest` or `sign`. Two objects of one
    name get a compass direction (`western chest`), more of them get numbers, counted from the
    west (`first chest`).
    """
    snapshot, registry = setting.snapshot, Registry.load()
    signs = sign_places(setting)
    moving = _blocks(setting, lambda name: is_door(name) or is_switch(name))
    # The upper half of a door belongs to the lower one.
    moving = {at for at in moving if (at[0], at[1] - 1, at[2]) not in moving}
    groups: dict[str, list[Position]] = {}
    for at in {*snapshot.containers, *signs, *moving, *setting.labels}:
        groups.setdefault(_base(setting, registry, at, sign=at in signs), []).append(at)
    named = {at: name for base, group in groups.items() for at, name in _apart(base, group).items()}
    return dict(sorted(named.items()))


def place_names(setting: Setting) -> Mapping[Position, str]:
    """Return the names of objects and of named places, by position; named places come last."""
    return {**object_names(setting), **{at: name for name, at in setting.places.items()}}


def sign_places(setting: Setting) -> set[Position]:
    """Return the positions of the signs of a setting."""
    return _blocks(setting, is_sign)


def _blocks(setting: Setting, accepts: Callable[[str], bool]) -> set[Position]:
    snapshot, registry = setting.snapshot, Registry.load()
    states = [n for n in snapshot.blocks.states if n >= 0 and accepts(registry.name(n))]
    return set(snapshot.places(states))


def _base(setting: Setting, registry: Registry, at: Position, *, sign: bool) -> str:
    label = setting.labels.get(at)
    if label is not None:
        return on_one_line(label)
    state = plain_state(setting.snapshot.block(at))
    return "sign" if sign else registry.name(state).replace("_", " ")


def _apart(base: str, group: Sequence[Position]) -> dict[Position, str]:
    """Return names that distinguish the positions of one group."""
    if len(group) == 1:
        return {group[0]: base}
    axis = next(axis for axis in _AXES if len({at[axis] for at in group}) > 1)
    ordered = sorted(group, key=lambda at: (at[axis], at))
    words: Sequence[str] = _SIDES[_AXES.index(axis)]
    if len(group) > 2:  # a pair has two sides
        words = [*_ORDINALS, *(f"{n}th" for n in range(len(_ORDINALS) + 1, len(group) + 1))]
    return {at: f"{word} {base}" for at, word in zip(ordered, words, strict=False)}
