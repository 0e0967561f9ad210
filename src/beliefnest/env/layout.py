"""Layouts of instances: all things of a setting, for the user of an environment."""

from collections.abc import Sequence

from beliefnest.env.bounds import Phrases, ThingsLayout
from beliefnest.env.order import placed_in
from beliefnest.nest.past.setting import Setting
from beliefnest.world.registry import Registry


def layout_of(setting: Setting, phrases: Phrases, items: Sequence[str] = ()) -> ThingsLayout:
    """Return the layout of the start of a scenario.

    Args:
        setting: Setting of the scenario.
        phrases: Utterances with their claims.
        items: Names of further items, which no agent or container has at the start.

    Raises:
        UnknownNameError: There is no such item.
        InputError: A claim is about a place outside the box or about an unknown agent.
    """
    snapshot = setting.snapshot
    registry = Registry.load()
    for name in items:
        registry.item_stack(name)
    agents = tuple(sorted(snapshot.agents.keys() | setting.absent))
    for claims in phrases.values():
        for claim in claims:
            claim.check(snapshot.box, agents)
    contents = [agent.inventory for agent in snapshot.agents.values()]
    contents += list(snapshot.containers.values())
    worn = {name for agent in snapshot.agents.values() for name in agent.equipment.values()}
    placed = {k: tuple(at) for k, at in placed_in(snapshot.box, snapshot.blocks).items()}
    return ThingsLayout(
        agents=agents,
        items=tuple(sorted({*items, *worn, *(name for each in contents for name in each)})),
        **placed,
        box=snapshot.box,
        phrases=tuple(phrases),
        places=tuple(place for _, place in sorted(setting.places.items())),
    )
