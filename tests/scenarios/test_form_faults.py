"""The smallest part of a value that is not as its type says is named, with what is allowed."""

from collections.abc import Mapping
from typing import Annotated, Literal

import msgspec
import pytest

from beliefnest.errors import InputError
from beliefnest.scenarios.form_faults import FormError, converted

_Small = Annotated[int, msgspec.Meta(ge=0)]


class Walk(msgspec.Struct, forbid_unknown_fields=True, tag="walk", tag_field="act"):
    """Act with a place."""

    to: tuple[_Small, _Small]


class Say(msgspec.Struct, forbid_unknown_fields=True, tag="say", tag_field="act", rename="upper"):
    """Act with words."""

    words: list[str] = []
    tone: Literal["low", "loud"] | None = None

    def __post_init__(self) -> None:
        if self.words == ["no"]:
            raise InputError("it says `no`")


_Acts = Mapping[str, list[Walk | Say]]


@pytest.mark.parametrize(
    ("value", "kind", "message"),
    [
        (3, "type", "expected 'object', got 'int'"),
        ({1: []}, "key", "a key in it: expected 'str', got 'int'; put it into quotes"),
        ({"a": {}}, "type", "a: expected 'array', got 'object'"),
        ({"a.b": [3]}, "type", "a.b[0]: expected 'object', got 'int'"),
        ({"a": [{"act": "sai"}]}, "refused", "a[0].act: .*'sai'; did you mean 'say'"),
        ({"a": [{"act": [1]}]}, "type", r"a\[0\]\.act: expected 'str', got 'array'; allowed are"),
        ({"a": [{}]}, "missing", "a[0]: the key 'act' is missing"),
        ({"a": [{"act": "walk"}]}, "missing", "a[0]: the key 'to' is missing"),
        ({"a": [{"act": "walk", "to": [1, 2, 3]}]}, "type", "a[0].to: .*of length 2, got 3"),
        ({"a": [{"act": "walk", "to": [1, -2]}]}, "type", "a[0].to[1]: expected 'int' >= 0"),
        ({"a": [{"act": "say", "wrods": []}]}, "unknown", "a[0].wrods: unknown key"),
        ({"a": [{"act": "say", "TON": 1}]}, "unknown", ".*unknown key; did you mean 'TONE'"),
        ({"a": [{"act": "say", "TONE": "lo"}]}, "refused", ".*TONE: .*did you mean 'low'"),
        ({"a": [{"act": "say", "WORDS": ["no"]}]}, "refused", "a[0]: it says 'no'"),
        ({"a": [{"act": "say", None: 1}]}, "key", r"a\[0\]: a key in it: expected 'str', got 'nu"),
    ],
)
def test_the_smallest_wrong_part_is_named(value, kind, message) -> None:
    pattern = message if "\\" in message else message.replace("[", r"\[")
    with pytest.raises(FormError, match=f"^{pattern}") as raised:
        converted(value, _Acts)
    assert raised.value.kind == kind


def test_what_is_right_is_converted() -> None:
    assert converted({"a": [{"act": "walk", "to": [1, 2]}]}, _Acts) == {"a": [Walk((1, 2))]}
