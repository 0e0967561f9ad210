"""Unique items: items of which everybody knows that there is one (semantics, section 3)."""

from collections.abc import Iterable, Iterator, Sequence

from beliefnest.belief.entries import InitialBelief
from beliefnest.belief.priors import merged_belief
from beliefnest.errors import InputError
from beliefnest.world.frames import Snapshot
from beliefnest.world.paths import AND_BELOW, BeliefPath, path_text
from beliefnest.world.registry import Registry
from beliefnest.world.values import Items

__all__ = ["unique_fault", "unique_items"]


def unique_items(names: Iterable[str]) -> frozenset[str]:
    """Return the names of unique items without `minecraft:`.

    Raises:
        InputError: They are no list of names.
        UnknownNameError: There is no such item.
    """
    given = None if isinstance(names, str) or not isinstance(names, Iterable) else tuple(names)
    if given is None or not all(isinstance(name, str) for name in given):
        raise InputError(f"unique is {names!r}; give a list of items such as ['diamond']")
    for name in given:
        Registry.load().item_stack(name)
    return frozenset(name.removeprefix("minecraft:") for name in given)


def unique_fault(item: str, world: Snapshot, initial: Sequence[InitialBelief]) -> str | None:
    """Say how a world or initial beliefs contradict that there is one item; None: they do not."""
    present = [
        *((f"in the container at {at}", items) for at, items in world.containers.items()),
        *((f"with {name}", agent.inventory) for name, agent in world.agents.items()),
        *(
            (f"on the floor at {lying.position}", {lying.name: lying.count})
            for lying in world.items.values()
        ),
    ]
    if fault := _more_than_one(item, present):
        return f"{item!r} is unique, and at the start there are {fault}; leave one of them"
    for path in dict.fromkeys(_spoken_of(initial)):
        believed = [
            (f"in the container at {at}", items)
            for at, (items, _) in merged_belief(initial, path).containers.items()
        ]
        if fault := _more_than_one(item, believed):
            return (
                f"{item!r} is unique, and initial_beliefs give {path_text(path)!r} {fault}; "
                "leave one of them"
            )
    return None


def _spoken_of(initial: Iterable[InitialBelief]) -> Iterator[BeliefPath]:
    """Nodes that differ in what initial beliefs say of them; `**` stands for any other name."""
    for belief in initial:
        yield belief.path
        if belief.path[:-1] and belief.path[-1] == AND_BELOW:
            yield belief.path[:-1]


def _more_than_one(item: str, places: Iterable[tuple[str, Items]]) -> str | None:
    found = [(place, items[item]) for place, items in places if items.get(item, 0) > 0]
    if sum(count for _, count in found) < 2:
        return None
    return " and ".join(f"{count} {place}" for place, count in found)
