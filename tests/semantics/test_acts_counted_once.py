"""Items that pass through several acts are counted once in what others believe of the actor."""

from beliefnest.belief.holdings import follow_acts
from beliefnest.world.values import Event, EventKind


def test_smelted_items_are_counted_as_they_come_out_of_the_furnace() -> None:
    furnace = (2, 1, 0)
    acts = [
        Event(
            EventKind.DEPOSIT_ITEM_INTO_CHEST,
            "ann",
            {"position": furnace, "items": {"raw_iron": 3}},
        ),
        Event(
            EventKind.GET_ITEM_FROM_CHEST, "ann", {"position": furnace, "items": {"iron_ingot": 3}}
        ),
        Event(EventKind.SMELT_ITEM, "ann", {"items": {"iron_ingot": 3}}),
    ]
    assert follow_acts({"raw_iron": 3}, acts) == {"iron_ingot": 3}
