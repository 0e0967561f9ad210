"""Items that tests invent."""

from typing import Any

from beliefnest.studies.items.record import ItemRecord

_ANY = ItemRecord(
    id="i0",
    text="plain",
    question="Where is it?",
    options=("bag", "box"),
    right="box",
    kind="item",
    order=1,
    path="/x",
    told_by="/",
    chain=("x",),
    chance=0.5,
    family="f",
    scenario="s",
    condition=None,
    variation="v",
    factors={},
    probe="p",
    seed=0,
    tick=0,
    skeleton="0",
    checked="follows",
    shortcuts={},
)


def invented(**values: Any) -> ItemRecord:
    """Return an item with some values, and any others."""
    return ItemRecord(**{name: getattr(_ANY, name) for name in _ANY.__struct_fields__} | values)
