"""Folder of a set of items: its public and its held-out part, with what made them."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import read_regular, replace_file
from beliefnest.locking import holding
from beliefnest.plan.cells import digest
from beliefnest.studies.items.exports import card, croissant, tasks
from beliefnest.studies.items.record import DroppedQuestion, ItemRecord
from beliefnest.version import VERSION

FORM = "beliefnest items 1"
"""Mark of folders of this version."""
_ITEMS = "items.jsonl"
_SET = "set.json"
_WHOLE = 16**16


@dataclass(frozen=True, slots=True)
class ItemSet:
    """Items of a study, and its questions that make none.

    Attributes:
        name: Name of the set.
        items: The items, in the order of the study.
        dropped: Questions that were dropped, with the reasons.
        held_out: Share of seeds whose items are held out, from 0 to 1.
        version: Version of the set.
        changes: What changed in this version.
    """

    name: str
    items: tuple[ItemRecord, ...]
    dropped: tuple[DroppedQuestion, ...]
    held_out: float = 0.0
    version: str = "1.0.0"
    changes: str = ""

    @property
    def canary(self) -> str:
        """Return a text by which a model can be asked if it was trained on the set."""
        return f"canary {self.name} {digest([each.id for each in self.items])[:32]}"

    @property
    def parts(self) -> dict[str, tuple[ItemRecord, ...]]:
        """Return the public items and, if there are any, those that are held out.

        All items of a seed are in the same part, so that no text of one is in the other.
        """
        hidden = {
            seed
            for seed in {each.seed for each in self.items}
            if int(digest(["held out", seed])[:16], 16) < self.held_out * _WHOLE
        }
        public = tuple(each for each in self.items if each.seed not in hidden)
        kept = tuple(each for each in self.items if each.seed in hidden)
        return {"public": public} | ({"held-out": kept} if kept else {})

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
            "beliefnest": VERSION,
        }
        public = files[_ITEMS]
        return {
            **files,
            _SET: f"{json.dumps(described, indent=2)}\n".encode(),
            "README.md": card(described),
            "croissant.json": croissant(described, public),
            **tasks(self.name, self.version),
        }

    def write(self, folder: Path) -> None:
        """Write the set into a folder; raise InputError if it holds something else."""
        if folder.exists() and not folder.is_dir():
            raise InputError(f"{folder} is a file; name a folder")
        if folder.is_dir() and any(folder.iterdir()) and not (folder / _SET).is_file():
            raise InputError(f"{folder} is not empty and holds no set of items; name another")
        folder.mkdir(parents=True, exist_ok=True)
        with holding(folder):
            for name, content in self.files().items():
                (folder / name).parent.mkdir(exist_ok=True)
                replace_file(folder / name, content)

    def differences(self, folder: Path) -> list[str]:
        """Return a line for each file of a folder that differs from this set.

        Raises:
            InputError: The folder holds no set, or a file cannot be read.
        """
        if not (folder / _SET).is_file():
            raise InputError(f"there is no set of items at {folder}; make one without --verify")
        return [
            line
            for name, content in self.files().items()
            for line in _compared(folder, name, content)
        ]


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
    ours, theirs = content.splitlines(), old.splitlines()
    pairs = zip(ours, theirs, strict=False)
    line = next((n for n, (a, b) in enumerate(pairs, 1) if a != b), min(len(ours), len(theirs)) + 1)
    return [f"{name}: line {line} differs"]
