"""Conditions on rows."""

import pytest

from beliefnest.errors import InputError
from beliefnest.studies.row_filter import RowFilter

COLUMNS = ("order", "condition", "model", "score", "ok")
ROWS = [
    {"order": order, "condition": condition, "model": model, "score": score, "ok": order == 1}
    for order, condition, model, score in (
        (1, 1, "a", 0.5),
        (2, 3, "b", None),
        (2, 1, "b", 1.5),
        (1, 3, "a:3", 2.0),
        (None, None, "3", 3.0),
    )
]


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ('order == 2 and condition != "3"', [2]),
        ("order == 2", [1, 2]),
        ("condition == 3", [1, 3]),
        ("condition == '3' or model == 3", [1, 3, 4]),
        ("not (order == 1)", [1, 2, 4]),
        ("order in (1, 2)", [0, 1, 2, 3]),
        ("model not in ['a', 'b']", [3, 4]),
        ("1 < score <= 2", [2, 3]),
        ("order == None", [4]),
        ("condition != None and ok", [0, 3]),
        ("order != condition", [1, 2, 3]),
        ("score > -1", [0, 2, 3, 4]),
        ("model >= 'b'", [1, 2]),
    ],
)
def test_rows_that_hold_a_condition_are_kept(text, kept):
    assert RowFilter.parse(text, COLUMNS).kept(ROWS) == [ROWS[number] for number in kept]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("ordr == 2", "no column 'ordr'; did you mean 'order'"),
        ("model == offline", "no column 'offline'; .*; a text stands in quotation marks"),
        ("order = 2", "is no condition"),
        ("", "is no condition"),
        ("order", "compare it with a value"),
        ("order == 2 and", "is no condition"),
        ("model.upper() == 'A'", "neither a column nor a value"),
        ("__import__('os')", "is not understood"),
        ("(lambda: 1)() == 1", "neither a column nor a value"),
        ("order + 1 == 2", "neither a column nor a value"),
        ("order == {'a': 1}", "no text, number or list"),
        ("order is None", "use == or !="),
        ("order in 2", "no list"),
        ("order < 'a'", "neither less nor greater"),
        ("model < 3", "neither less nor greater"),
        ("order == 7", "values of order are 1, 2, None"),
        ("(" * 500 + "order == 1" + ")" * 500, "is no condition"),
    ],
)
def test_what_is_no_condition_is_refused(text, told):
    with pytest.raises(InputError, match=told.replace("(", r"\(")):
        RowFilter.parse(text, COLUMNS).kept(ROWS)
