"""Unique items (semantics, section 3), written from the text alone.

Where the text leaves something open, the choice made here is:

* Acts with the item come before what is seen at the end of their tick.
* What remains in a container rests on what it rested on; an emptied one on the perception
  elsewhere.
* Whether contents are known to be all does not change.
* If several are perceived in one tick, each is where it is perceived.
"""

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from beliefnest.belief.grounds import Basis, Source
from beliefnest.world.values import Position

if TYPE_CHECKING:
    from tests.semantics.reference_rules import Node

Whereabouts = tuple[str, Any]
"""`("container", position)` or `("agent", name)`."""


def see_moved(after: "Node", item: str) -> None:
    """Remove it everywhere but where perceived acts bring it, which are not followed yet."""
    acts = [event for event in after.news if item in event.detail.get("items", {})]
    if acts:
        remove(after, item, Basis(after.tick, Source.WITNESSED, acts[-1].kind), set())
        after.ear.find_elsewhere(item, set())


def see_alone(
    after: "Node",
    around: "Node",
    me: str,
    agents: Collection[str],
    item: str,
) -> None:
    """Remove it everywhere but where it is perceived, if it is."""
    places: dict[Whereabouts, Basis] = {}
    for place in sorted(after.looked_into):
        if item in after.containers[place].items:
            places["container", place] = after.containers[place].basis
    for name in sorted(agents):
        if item in (around.agents[name].equipment or {}).values():
            basis = around.agents[name].basis
            assert basis is not None
            places["agent", name] = Basis(basis.observed_at, Source.SEEN)
    if item in around.agents[me].inventory:
        places["agent", me] = Basis(after.tick, Source.SEEN)
    if not places and any(item in event.detail.get("items", {}) for event in after.news):
        after.found_now = frozenset(places_of(after, me, item))
    if places:
        *_, last = places.values()
        after.found_now = frozenset(places)
        remove(after, item, last, set(places))
        after.ear.find_elsewhere(item, {at for kind, at in places if kind == "container"})


def places_of(node: "Node", me: str, item: str) -> list[Whereabouts]:
    """Return its believed place, other than with the holder."""
    held = [("container", place) for place, c in node.containers.items() if item in c.items]
    agents = node.agents.items()
    return [*held, *(("agent", n) for n, a in agents if n != me and item in a.inventory)]


def is_perceived_elsewhere(after: "Node", me: str, item: str, place: "Position") -> bool:
    """Return True if it is perceived in this tick, and not in a container of a claim."""
    return item in after.agents[me].inventory or bool(after.found_now - {("container", place)})


def remove(node: "Node", item: str, basis: Basis, kept: set[Whereabouts]) -> None:
    """Believe it to be nowhere but in some places."""
    for place, content in node.containers.items():
        if item in content.items and ("container", place) not in kept:
            left = {name: count for name, count in content.items.items() if name != item}
            node.containers[place] = replace(content, items=left)
            if not left:
                node.containers[place] = replace(content, items={}, basis=basis, current=False)
    for name, agent in node.agents.items():
        if ("agent", name) not in kept:
            has = {thing: count for thing, count in agent.inventory.items() if thing != item}
            worn = agent.equipment
            if worn is not None:
                worn = {slot: thing for slot, thing in worn.items() if thing != item}
            node.agents[name] = replace(agent, inventory=has, equipment=worn)
