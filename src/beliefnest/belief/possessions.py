"""What witnessed acts say about an actor's possessions (semantics, section 4)."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from beliefnest.belief.entries import AgentBelief
from beliefnest.world.values import Event, EventKind, Items

__all__ = ["after_own_acts", "changed_items"]

_GAINS = frozenset(
    {
        EventKind.GET_ITEM_FROM_CHEST,
        EventKind.RECEIVE_ITEM_FROM_OTHER,
        EventKind.CRAFT_ITEM,
        EventKind.SMELT_ITEM,
    }
)
_LOSSES = frozenset({EventKind.DEPOSIT_ITEM_INTO_CHEST, EventKind.GIVE_ITEM_TO_OTHER})


def changed_items(items: Items, change: Items, sign: int) -> Mapping[str, int]:
    """Items with a change added (sign 1) or subtracted (sign -1), no count below 0."""
    result = dict(items)
    for name, count in change.items():
        result[name] = result.get(name, 0) + sign * count
    return {name: count for name, count in result.items() if count > 0}


def after_own_acts(agent: AgentBelief, acts: Iterable[Event]) -> AgentBelief:
    """The believed actor after the visible part of what it did."""
    inventory = agent.inventory
    for act in acts:
        if act.kind in _GAINS:
            inventory = changed_items(inventory, act.detail.get("items", {}), 1)
        elif act.kind in _LOSSES:
            inventory = changed_items(inventory, act.detail.get("items", {}), -1)
    return agent if inventory is agent.inventory else replace(agent, inventory=inventory)
