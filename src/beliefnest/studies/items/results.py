"""File of the results of a set, to which anybody can append those of further models."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, read_regular
from beliefnest.llm.messages import Answer, Finish
from beliefnest.studies.allocation import PARTICIPANT
from beliefnest.studies.items.asking import judged_answer
from beliefnest.studies.items.cells import AnsweredItem
from beliefnest.studies.items.exports import sha256, stated_digest
from beliefnest.studies.items.item_set import read_description
from beliefnest.studies.items.record import ItemRecord
from beliefnest.world.texts import quoted
from beliefnest.world.words import counted

_MEND = "restore the set, or see what differs: `beliefnest items STUDY -o SET --verify`"


class ItemResult(msgspec.Struct, frozen=True):
    """Line of a file of results; further fields are notes.

    Attributes:
        set: Name of the set.
        version: Its version.
        digest: SHA-256 of its `items.jsonl`.
        id: Id of the item.
        model: Name of the model.
        answered: Option that the model named; None: none, or several.
        ok: True if that is the right one.
        outcome: `ok`, `wrong`, or why there is no answer.
        finish: Reason for the end of the answer; empty: no answer came.
        text: The whole answer.
    """

    set: str
    version: str
    digest: str
    id: str
    model: str
    answered: str | None
    ok: bool
    outcome: str
    finish: Finish | Literal[""]
    text: str


class PublishedSet(msgspec.Struct, frozen=True):
    """Public part of a set in a folder.

    Attributes:
        name: Its name.
        version: Its version.
        digest: SHA-256 of its `items.jsonl`.
        items: The items.
        held_out: Ids of the items that are held out, as far as the folder has them.
    """

    name: str
    version: str
    digest: str
    items: tuple[ItemRecord, ...]
    held_out: frozenset[str]

    @staticmethod
    def read(folder: Path) -> "PublishedSet":
        """Read the set of a folder.

        Raises:
            InputError: The folder holds no whole set, or its items are not those that were written.
        """
        description, file = read_description(folder), folder / "items.jsonl"
        try:
            content = read_regular(file)
            items = tuple(_items(content, file))
            hidden = folder / "held-out" / "items.jsonl"
            kept = _items(read_regular(hidden), hidden) if hidden.exists() else ()
            held_out = frozenset(each.id for each in kept)
            stated = stated_digest(folder)
        except OSError as error:
            raise InputError(f"{error.filename}: {error.strerror}; {_MEND}") from None
        wanted, own = description.items.get("public", 0), sha256(content)
        if len(items) != wanted:
            there = counted(len(items), "item")
            raise InputError(f"{file} has {there}, and set.json says {wanted}; {_MEND}")
        if not items:
            raise InputError(f"{file} has no items; make the set anew")
        if stated not in {None, own}:
            raise InputError(f"{file} is not as it was written: its digest is another; {_MEND}")
        return PublishedSet(description.name, description.version, own, items, held_out)

    @property
    def choices(self) -> tuple[ItemRecord, ...]:
        """Return the items with options, which alone can be judged without their nests."""
        return tuple(each for each in self.items if each.options)


def _items(content: bytes, file: Path) -> Iterator[ItemRecord]:
    for number, line in enumerate(content.splitlines(), 1):
        try:
            yield decode_json(line, ItemRecord)
        except msgspec.MsgspecError as error:
            raise InputError(f"{file}:{number} cannot be read: {error}; {_MEND}") from None


def results_of(items: PublishedSet, rows: Iterable[Mapping[str, Any]]) -> bytes:
    """Return the file of results of models, without those of failed cells."""
    of_models = (row for row in rows if row.get(PARTICIPANT) is None)
    played = (row for row in of_models if row["finish"] is not None)
    answers = (msgspec.convert(row, AnsweredItem) for row in played)
    of_set = {"set": items.name, "version": items.version, "digest": items.digest}
    kept = ("id", "model", "answered", "ok", "outcome", "finish", "text")
    lines = ({**of_set, **{name: getattr(each, name) for name in kept}} for each in answers)
    return b"".join(msgspec.json.encode(each) + b"\n" for each in lines)


def with_others(results: bytes, before: bytes) -> bytes:
    """Return results, followed by all lines of a file that they do not replace, as they are.

    A result replaces those of the same set, item and model.
    """
    own = {_replaced(line) for line in results.splitlines()}
    others = (line for line in before.split(b"\n") if line.strip())
    return results + b"".join(line + b"\n" for line in others if _replaced(line) not in own)


def _replaced(line: bytes) -> tuple[str, str, str] | bytes:
    """Return what a line is the result of; if it is no result, the line."""
    try:
        result = decode_json(line, ItemResult)
    except msgspec.MsgspecError:
        return line
    return result.digest, result.id, result.model


class CheckedResults(msgspec.Struct, frozen=True):
    """Result of checking a file of results.

    Attributes:
        rows: Sound results, as rows for `count_rows`.
        missing: Number of items without a result, by model.
        faults: What is wrong, each with its line.
    """

    rows: Sequence[Mapping[str, Any]]
    missing: Mapping[str, int]
    faults: Sequence[str]


def check_results(items: PublishedSet, file: Path) -> CheckedResults:
    """Check results against their set: each answer is read from its text again, and judged.

    Args:
        items: The set.
        file: File of results.

    Raises:
        InputError: The file cannot be read, or has no results.
    """
    if not file.is_file():
        raise InputError(f"there is no file of results at {file}")
    faults: list[str] = []
    results: dict[int, ItemResult] = {}
    for number, line in enumerate(read_regular(file).split(b"\n"), 1):
        try:
            results |= {number: decode_json(line, ItemResult)} if line.strip() else {}
        except msgspec.MsgspecError as error:
            faults.append(f"{file}:{number}: is no result: {error}")
    if not results:
        raise InputError(f"{file} has no results")
    by_id = {each.id: each for each in items.choices}
    sound: dict[str, dict[str, ItemResult]] = {each.model: {} for each in results.values()}
    for number, each in results.items():
        own = [*_faults(items, by_id, each)]
        if each.id in sound[each.model]:
            own.append(f"{each.model} has a result of {each.id} before")
        faults += [f"{file}:{number}: {fault}" for fault in own]
        if not own:
            sound[each.model][each.id] = each
    rows = [
        _row(model, item, own.get(item.id))
        for model, own in sound.items()
        for item in items.choices
    ]
    missing = {
        model: len(by_id) - len(own) for model, own in sound.items() if len(own) < len(by_id)
    }
    return CheckedResults(rows, missing, faults)


def _row(model: str, item: ItemRecord, result: ItemResult | None) -> Mapping[str, Any]:
    """Return the row of an item; without a sound result it is not right."""
    return {
        "model": model,
        "order": item.order,
        "family": item.family,
        "variation": item.skeleton,
        "chance": item.chance,
        "ok": result is not None and result.ok,
        "outcome": "no_answer" if result is None else result.outcome,
    }


def _faults(
    items: PublishedSet, by_id: Mapping[str, ItemRecord], result: ItemResult
) -> Iterator[str]:
    """Yield what is wrong with a result."""
    for name, own, theirs in (
        ("set", items.name, result.set),
        ("version", items.version, result.version),
        ("digest", items.digest, result.digest),
    ):
        if own != theirs:
            yield f"{name} is {quoted(theirs)}, and this set has {quoted(own)}"
            return
    if not result.model.strip():
        yield "model is empty; give its name"
    item = by_id.get(result.id)
    if item is None:
        yield f"the set has no item {quoted(result.id)} with options"
        return
    if not result.finish:
        read: Mapping[str, Any] = {"answered": None, "ok": False, "outcome": "no_answer"}
    else:
        answer = Answer(result.text, finish=result.finish)
        read = msgspec.structs.asdict(judged_answer(item, result.model, answer))
    for name in ("answered", "ok", "outcome"):
        stated = getattr(result, name)
        if stated != read[name]:
            yield f"{name} is {quoted(stated)}; the text of the answer gives {quoted(read[name])}"
