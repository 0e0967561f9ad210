"""Conversion of plain values to types, with the place of what is wrong.

msgspec says where a value is wrong only as text. Here each part of a refused value is converted by
itself, down to the smallest part that is refused.
"""

from collections.abc import Mapping, Sequence
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

import msgspec

from beliefnest.errors import InputError
from beliefnest.scenarios.document import KeyPath, key_words
from beliefnest.world.texts import quoted
from beliefnest.world.words import nearest_or_all

_T = TypeVar("_T")


class FormError(InputError):
    """Fault of the smallest part of a value that is not as its type says.

    Attributes:
        kind: Unknown or missing key, key or value of the wrong type, or value that its enumeration
            or a check of its class refuses.
        path: Place of the part; it ends with a key that is unknown.
        part: The part.
        what: What is wrong with it, in words.
        hint: End of a message: what is allowed there, if that is enumerated.
    """

    def __init__(
        self,
        kind: Literal["unknown", "missing", "key", "type", "refused"],
        path: KeyPath,
        part: object,
        what: str,
        allowed: Sequence[str] = (),
    ) -> None:
        name = path[-1] if kind == "unknown" else part
        self.hint = nearest_or_all(str(name), allowed, "allowed are") if allowed else ""
        super().__init__(f"{key_words(path)}{what}{self.hint}")
        self.kind, self.path, self.part, self.what = kind, path, part, what


def converted(value: object, form: type[_T], path: KeyPath = ()) -> _T:
    """Return a plain value as a value of a type.

    Args:
        value: Mappings, lists and scalars.
        form: The type, as for `msgspec.convert`.
        path: Place of the value.

    Raises:
        FormError: The value is not as the type says.
    """
    try:
        return msgspec.convert(value, form)
    except (msgspec.ValidationError, InputError) as error:  # Some classes check as in code.
        message = str(error).replace("`", "'")
    members = _members(form)
    structs = [m for m in members if isinstance(m, type) and issubclass(m, msgspec.Struct)]
    if isinstance(value, Mapping) and structs:
        _convert_fields(value, structs, path)
    for each in members:
        _convert_parts(value, each, path)
    words = [str(w) for each in members if get_origin(each) is Literal for w in get_args(each)]
    is_known = isinstance(value, str) if words else isinstance(value, Mapping) and bool(structs)
    if words:
        words += [f"{{{key}: ...}}" for each in structs for key in each.__struct_encode_fields__]
    what = f"{message[:1].lower()}{message[1:]}"
    raise FormError("refused" if is_known else "type", path, value, what, words)


def _convert_parts(value: object, form: Any, path: KeyPath) -> None:
    """Convert the parts of a mapping or list, in their order, if the type is one of these."""
    origin, args = get_origin(form), get_args(form)
    if isinstance(value, Mapping) and origin in (dict, Mapping):
        for key, part in value.items():
            _convert_key(key, args[0], value, path)
            converted(part, args[1], (*path, key))
    elif isinstance(value, list | tuple) and origin in (list, tuple, Sequence):
        forms = args[:1] * len(value) if origin is not tuple or Ellipsis in args else args
        if len(forms) == len(value):
            for index, part in enumerate(value):
                converted(part, forms[index], (*path, index))


def _convert_fields(value: Mapping[Any, object], structs: Sequence[Any], path: KeyPath) -> None:
    """Convert the fields of a mapping that is an object of one of some classes."""
    chosen = structs[0]
    tag_field = chosen.__struct_config__.tag_field
    if tag_field is not None and tag_field in value:
        tags = {each.__struct_config__.tag: each for each in structs}
        form: Any = Literal[tuple(tags)]
        chosen = tags[converted(value[tag_field], form, (*path, tag_field))]
    elif len(structs) > 1:
        raise FormError("missing", path, value, f"the key {quoted(tag_field)} is missing")
    fields = {each.encode_name: each for each in msgspec.structs.fields(chosen)}
    for key, part in value.items():
        _convert_key(key, str, value, path)
        if key in fields:
            converted(part, fields[key].type, (*path, key))
        elif key != tag_field and chosen.__struct_config__.forbid_unknown_fields:
            raise FormError("unknown", (*path, key), part, "unknown key", [*fields])
    for name, field in fields.items():
        if field.required and name not in value:
            raise FormError("missing", path, value, f"the key {quoted(name)} is missing")


def _convert_key(key: object, form: Any, value: object, path: KeyPath) -> None:
    """Convert a key of a mapping."""
    try:
        converted(key, form)
    except FormError as fault:
        quotes = "; put it into quotes" if form is str else ""
        raise FormError("key", path, value, f"a key in it: {fault.what}{quotes}") from None


def _members(form: Any) -> list[Any]:
    """Return the types of which a type is the union, without annotations."""
    if get_origin(form) is Annotated:
        return _members(get_args(form)[0])
    if get_origin(form) in (Union, UnionType):
        return [inner for each in get_args(form) for inner in _members(each)]
    return [form]
