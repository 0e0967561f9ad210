"""Unique items: everybody knows that there is only one of each (semantics, section 3)."""

from collections.abc import Iterable, Iterator, Sequence

from beliefnest.belief.grounds import InitialBelief
from beliefnest.belief.priors import merged_belief
from beliefnest.errors import InputError
from beliefnest.world.frames import Snapshot
from beliefnest.world.paths import AND_BELOW, BeliefPath, path_text
from beliefnest.world.registry import Registry
from beliefnest.world.texts import quoted
from beliefnest.world.values import Items


def unique_items(names: Iterable[str]) -> frozenset[str]:
    """Return the names of unique items without `minecraft:`.

    Raises:
        InputError: `names` is not a list of names.
        UnknownNameError: Minecraft has no such item.
    """
    listed = None if isinstance(names, str) or not isinstance(names, Iterable) else tuple(names)
    if listed is None or not all(isinstance(name, str) for name in listed):
        raise InputError(f"unique is {quoted(names)}; give a list of items, such as ['diamond']")
    for name in listed:
        Registry.load().item_stack(name)
    return frozenset(name.removeprefix("minecraft:") for name in listed)


def unique_fault(item: str, world: Snapshot, initial: Sequence[InitialBelief]) -> str | None:
    """Return how a world or initial beliefs hold a unique item twice; None: they do not."""
    present = [
        *((f"in the container at {at}", items) for at, items in world.containers.items()),
        *((f"with {name}", agent.inventory) for name, agent in world.agents.items()),
        *(
            (f"on the floor at {lying.position}", {lying.name: lying.count})
            for lying in world.items.values()
        ),
    ]
    if fault := _more_than_one(item, present):
        return f"{quoted(item)} is unique, but at the start there are {fault}; remove all but one"
    for path in dict.fromkeys(_spoken_of(initial)):
        merged = merged_belief(initial, path)
        believed = [
            *((f"in the container at {at}", items) for at, (items, _) in merged.containers.items()),
            *((f"with {name}", items) for name, items in merged.inventories.items()),
        ]
        if fault := _more_than_one(item, believed):
            return (
                f"{quoted(item)} is unique, but initial_beliefs give {quoted(path_text(path))} "
                f"{fault}; remove all but one"
            )
    return None


def _spoken_of(initial: Iterable[InitialBelief]) -> Iterator[BeliefPath]:
    """Yield paths of nodes that cover all sets of applicable initial beliefs.

    The name `**` stands for any agent that no path names.
    """
    for belief in initial:
        yield belief.path
        if belief.path[:-1] and belief.path[-1] == AND_BELOW:
            yield belief.path[:-1]


def _more_than_one(item: str, places: Iterable[tuple[str, Items]]) -> str | None:
    holders = [(place, items[item]) for place, items in places if items.get(item, 0) > 0]
    if sum(count for _, count in holders) < 2:
        return None
    return " and ".join(f"{count} {place}" for place, count in holders)
