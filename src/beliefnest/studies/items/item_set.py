"""Folder of a set of items: its public and its held-out part, with what made them."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, read_regular, replace_file
from beliefnest.locking import holding
from beliefnest.plan.cells import digest
from beliefnest.studies.items.exports import card, croissant, tasks
from beliefnest.studies.items.record import DroppedQuestion, ItemRecord
from beliefnest.version import VERSION
from beliefnest.world.texts import quoted
from beliefnest.world.words import counted, listed

FORM = "beliefnest items 2"
"""Mark of folders of this version."""
FIRST_VERSION = "1.0.0"
_ITEMS = "items.jsonl"
_SET = "set.json"
_WHOLE = 16**16
_NAME = re.compile(r"[\w.-]+")
_MOST_LINES = 5
"""Greatest number of differing lines of a file that are named."""


class SetDescription(msgspec.Struct, frozen=True):
    """Part of `set.json` from which a set is made again; attributes as those of `ItemSet`.

    Attributes:
        items: Number of items of each part.
    """

    format: str
    name: str
    version: str
    changes: str
    held_out: float
    made_with: dict[str, str]
    items: dict[str, int]

    def public_only(self, folder: Path) -> bool:
        """Return True if a folder is a public copy: without the part that is held out."""
        return "held-out" in self.items and not (folder / "held-out").exists()


def read_description(folder: Path) -> SetDescription:
    """Return the description of the set in a folder.

    Raises:
        InputError: The folder holds no set that this version can read.
    """
    try:
        description = decode_json(read_regular(folder / _SET), SetDescription)
    except (FileNotFoundError, NotADirectoryError):
        raise InputError(f"there is no set of items at {folder}; make one first") from None
    except (OSError, msgspec.DecodeError) as error:
        raise InputError(f"{folder / _SET} cannot be read: {error}; make the set anew") from None
    if description.format != FORM:
        raise InputError(f"{folder} holds a set of another version; make it anew in a new folder")
    return description


def check_folder(folder: Path, held_out: float, version: str) -> None:
    """Raise InputError if a set with a held-out share and a version cannot be written there."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; name a folder")
    if not folder.is_dir() or not any(folder.iterdir()):
        return
    if not (folder / _SET).is_file():
        raise InputError(f"{folder} is not empty and holds no set of items; name another")
    there = read_description(folder)
    if there.held_out != held_out:
        raise InputError(
            f"{folder} holds a set with held_out {there.held_out:g}, and {held_out:g} would make "
            "other items public; give the same share, or name another folder"
        )
    if _numbers(version) < _numbers(there.version):
        raise InputError(
            f"{folder} holds version {there.version}, and {version} is below it; give a new "
            "--set-version above it, or name another folder"
        )


def _numbers(version: str) -> list[int]:
    """Return the numbers with which a version begins, without zeros at their end."""
    begins = re.match(r"v?([\d._-]*)", version)
    numbers = [int(each) for each in re.findall(r"\d+", begins[0] if begins else "")]
    while numbers and not numbers[-1]:
        numbers.pop()
    return numbers


@dataclass(frozen=True, slots=True)
class ItemSet:
    """Items of a study, and its questions that make none.

    Attributes:
        name: Name of the set.
        items: The items, in the order of the study.
        dropped: Questions that were dropped, with the reasons.
        held_out: Probability with which the items of a seed are held out, from 0 to 1. The number
            of the seed decides, so that a larger set publishes nothing that a smaller one held out.
        version: Version of the set.
        changes: What changed in this version.
        made_with: Versions of the packages that decide about its content, by name.

    Raises:
        InputError: The name or version is no word, or all items would be in one part.
    """

    name: str
    items: tuple[ItemRecord, ...]
    dropped: tuple[DroppedQuestion, ...]
    held_out: float = 0.0
    version: str = FIRST_VERSION
    changes: str = ""
    made_with: Mapping[str, str] = field(default_factory=lambda: {"beliefnest": VERSION})

    def __post_init__(self) -> None:
        for what, text in (("name", self.name), ("version", self.version)):
            if not isinstance(text, str) or not _NAME.fullmatch(text):
                raise InputError(
                    f"the {what} of the set is {quoted(text)}; give letters, digits, '_', '.', '-'"
                )
        if self.held_out and self.items and len(self.parts) < 2:
            kept = "none" if self.parts["public"] else "all"
            seeds = counted(len({each.seed for each in self.items}), "seed")
            raise InputError(
                f"held_out {self.held_out:g} holds back {kept} of {seeds}, where items that differ "
                "in names only stay together; give another share, or more variations"
            )

    @property
    def canary(self) -> str:
        """Return a text by which a model can be asked if it was trained on the set."""
        return f"canary {self.name} {digest([each.id for each in self.items])[:32]}"

    @property
    def parts(self) -> dict[str, tuple[ItemRecord, ...]]:
        """Return the public items and, if there are any, those that are held out.

        All items of a seed are in the same part, so that no text of one is in the other; so are
        all of a skeleton, so that no item that is held out is a public one with other names.
        """
        skeletons: dict[int, set[str]] = {}
        for each in self.items:
            skeletons.setdefault(each.seed, set()).add(each.skeleton)
        fresh = {
            seed
            for seed in skeletons
            if int(digest(["held out", seed])[:16], 16) < self.held_out * _WHOLE
        }
        hidden: set[int] = set()
        while fresh:
            hidden |= fresh
            shared = {skeleton for seed in fresh for skeleton in skeletons[seed]}
            fresh = {seed for seed in skeletons.keys() - hidden if shared & skeletons[seed]}
        public = tuple(each for each in self.items if each.seed not in hidden)
        kept = tuple(each for each in self.items if each.seed in hidden)
        return {"public": public} | ({"held-out": kept} if kept and public else {})

    def files(self) -> dict[str, bytes]:
        """Return the files of the folder by path; the same set gives the same bytes."""
        files: dict[str, bytes] = {}
        for part, items in self.parts.items():
            folder = "" if part == "public" else f"{part}/"
            files[f"{folder}{_ITEMS}"] = _lines(items)
        files["dropped.jsonl"] = _lines(self.dropped)
        described = {
            "format": FORM,
            "name": self.name,
            "version": self.version,
            "changes": self.changes,
            "canary": self.canary,
            "held_out": self.held_out,
            "items": {part: len(items) for part, items in self.parts.items()},
            "dropped": len(self.dropped),
            "made_with": dict(self.made_with),
        }
        public = files[_ITEMS]
        return {
            **files,
            _SET: f"{json.dumps(described, indent=2)}\n".encode(),
            "README.md": card(described),
            "croissant.json": croissant(described, public),
            **tasks(self.name, self.version),
        }

    def write(self, folder: str | Path) -> None:
        """Write the set into a folder.

        Raises:
            InputError: The folder holds something else, a set with another held-out share, a later
                version, or other items of the same version.
        """
        place, files = Path(folder), self.files()
        check_folder(place, self.held_out, self.version)
        if (place / _SET).is_file() and read_description(place).version == self.version:
            names = [name for name in files if name.endswith(_ITEMS) and (place / name).exists()]
            for line in (line for name in names for line in _compared(place, name, files[name])):
                raise InputError(
                    f"{place} holds version {self.version} with other items ({line}); give a new "
                    "--set-version and say its --changes, or name another folder"
                )
        with holding(place):
            for name, content in files.items():
                (place / name).parent.mkdir(exist_ok=True)
                replace_file(place / name, content)

    def differences(self, folder: str | Path) -> list[str]:
        """Return a line for each file of a folder that differs from this set, or is not of it.

        Of a public copy, without the part that is held out, the rest is compared.

        Raises:
            InputError: The folder holds no set, or a file cannot be read.
        """
        place, files = Path(folder), self.files()
        if read_description(place).public_only(place):
            files = {name: files[name] for name in files if not name.startswith("held-out/")}
        differing = [line for name in files for line in _compared(place, name, files[name])]
        # Parquet is compared by its content, see `parquet_differences`.
        every = (each for each in sorted(place.rglob("*")) if each.is_file())
        there = (each for each in every if each.name != "items.parquet")
        names = (each.relative_to(place).as_posix() for each in there)
        return [*differing, *(f"{name}: is not of the set" for name in names if name not in files)]


def _lines(records: Iterable[ItemRecord | DroppedQuestion]) -> bytes:
    return b"".join(msgspec.json.encode(each) + b"\n" for each in records)


def _compared(folder: Path, name: str, content: bytes) -> Sequence[str]:
    try:
        old = read_regular(folder / name)
    except FileNotFoundError:
        return [f"{name}: is missing"]
    except OSError as error:
        raise InputError(f"cannot read {folder / name}: {error.strerror}") from error
    if old == content:
        return []
    pairs = zip_longest(content.splitlines(), old.splitlines())
    lines = [str(number) for number, (ours, theirs) in enumerate(pairs, 1) if ours != theirs]
    if not lines:
        return [f"{name}: differs in its line ends"]
    more = len(lines) - _MOST_LINES
    shown = [*lines[:_MOST_LINES], *([f"{more} more"] if more > 0 else [])]
    return [
        f"{name}: line {lines[0]} differs"
        if len(lines) == 1
        else f"{name}: lines {listed(shown)} differ"
    ]
