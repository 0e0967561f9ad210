"""Pure rules of what nodes hold."""

import pytest

from beliefnest.belief.holdings import changed_items


@pytest.mark.parametrize(
    ("change", "sign", "after"),
    [
        ({"apple": 1}, 1, {"apple": 3, "book": 1}),
        ({"apple": 1}, -1, {"apple": 1, "book": 1}),
        ({"apple": 2}, -1, {"book": 1}),
        ({"apple": 5, "ring": 1}, -1, {"book": 1}),
    ],
)
def test_nothing_of_an_item_is_no_entry(change, sign, after):
    assert changed_items({"apple": 2, "book": 1}, change, sign) == after
