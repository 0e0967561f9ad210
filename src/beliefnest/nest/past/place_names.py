"""Names of containers, signs and places of a setting: those that reality has."""

from collections.abc import Callable, Mapping

from beliefnest.nest.past.setting import Setting
from beliefnest.prompts.naming import apart, kind_name
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.registry import Registry
from beliefnest.world.signs import is_sign, plain_state
from beliefnest.world.texts import on_one_line
from beliefnest.world.values import Position


def object_names(setting: Setting) -> Mapping[Position, str]:
    """Return names of containers, signs, doors and switches, without articles, by position.

    The name is the label, else the kind of block at the start, such as `chest` or `sign`; see
    `prompts.naming.apart`. Only a narrator who tells everything has these names.
    """
    signs = sign_places(setting)
    moving = _blocks(setting, lambda name: is_door(name) or is_switch(name))
    # The upper half of a door belongs to the lower one.
    moving = {at for at in moving if (at[0], at[1] - 1, at[2]) not in moving}
    return apart(
        {
            at: _base(setting, at)
            for at in {*setting.snapshot.containers, *signs, *moving, *setting.labels}
        }
    )


def sign_places(setting: Setting) -> set[Position]:
    """Return the positions of the signs of a setting."""
    return _blocks(setting, is_sign)


def _blocks(setting: Setting, accepts: Callable[[str], bool]) -> set[Position]:
    snapshot, registry = setting.snapshot, Registry.load()
    states = [n for n in snapshot.blocks.states if n >= 0 and accepts(registry.name(n))]
    return set(snapshot.places(states))


def _base(setting: Setting, at: Position) -> str:
    label = setting.labels.get(at)
    if label is not None:
        return on_one_line(label)
    return kind_name(Registry.load().name(plain_state(setting.snapshot.block(at))))
