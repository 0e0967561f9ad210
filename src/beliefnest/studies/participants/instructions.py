"""Instructions of participants: pages of headings, paragraphs and lists, from plain text."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from beliefnest.errors import InputError
from beliefnest.files import os_errors_of, read_regular_text
from beliefnest.studies.participants.items import Item

_SCENE = (
    "The scene is drawn from above. A circle is a person, and its tip points where the person "
    "looks. Boxes show what is in them while it can be seen; a question mark means that it cannot. "
    "The words below the picture say the same."
)
_PLAY = (
    "Press Play to start a film. You can stop it, go back, and play it again. The question appears "
    "when the film has ended."
)
_NARRATOR = "You are told everything that happened."
_PERSON = "You are one of the people: you learn only what this person saw and heard."
_EITHER = (
    "Sometimes you are told everything that happened. Sometimes you are one of the people: then "
    "you learn only what this person saw and heard."
)
_ALL_AROUND = (
    "People see all around them, whichever way they look. Only walls and other things can hide "
    "something from them."
)
_WHOLE = 360.0
"""Field of view in degrees in which nothing is behind a person."""
_AHEAD = "People see only what lies in the direction in which they look."
_HOW = (
    "Below each one is a question. Answer it by what you have learned there; scenes have nothing "
    "to do with each other. There is no time limit."
)
_BEGINNINGS = {
    "film": f"You will see short films of people in a room.\n\n{_SCENE} {_PLAY}",
    "story": "You will read short stories about people in a room.",
    "both": "You will read short stories about people in a room. A film below each story shows "
    f"the same.\n\n{_SCENE} {_PLAY}",
}
"""First paragraphs by what participants are shown."""


def instruction_pages(shown: str, items: Sequence[Item]) -> list[list[dict[str, Any]]]:
    """Return the default instructions for what participants are shown.

    Args:
        shown: `film`, `story` or `both`.
        items: All items: the instructions say from whose view they are told, and how people see.
    """
    parts = ["# Instructions", _BEGINNINGS[shown], _sight(items), _view(items), _HOW]
    return _pages("\n\n".join(part for part in parts if part))


def _sight(items: Sequence[Item]) -> str:
    """Return a sentence about the field of view; empty if scenarios differ in it."""
    fields = {item.cell.scenario.setting.perception.field_of_view for item in items}
    if fields == {_WHOLE}:
        return _ALL_AROUND
    return "" if _WHOLE in fields else _AHEAD


def _view(items: Sequence[Item]) -> str:
    narrated = {path == "/" for item in items for path in item.paths}
    if len(narrated) > 1:
        return _EITHER
    return _NARRATOR if narrated == {True} else _PERSON


def read_instructions(file: Path) -> list[list[dict[str, Any]]]:
    """Return the pages of a text file.

    A line `---` begins a new page, `# ` a heading, `- ` an item of a list. An empty line ends a
    paragraph. Other marks stay as they are written.

    Raises:
        InputError: The file cannot be read, or has no text.
    """
    try:
        with os_errors_of(file, "read"):
            text = read_regular_text(file)
    except UnicodeDecodeError:
        raise InputError(f"{file} is not UTF-8; save it as UTF-8") from None
    pages = _pages(text)
    if not pages:
        raise InputError(f"{file} has no text; write one, or leave the option out")
    return pages


def _pages(text: str) -> list[list[dict[str, Any]]]:
    pages: list[list[str]] = [[]]
    for line in text.splitlines():
        if line.strip() == "---":
            pages.append([])
        else:
            pages[-1].append(line.strip())
    return [blocks for page in pages if (blocks := _blocks(page))]


def _blocks(lines: list[str]) -> list[dict[str, Any]]:
    blocks: list[dict[str, Any]] = []
    ended = True
    for line in lines:
        kind, text = _kind(line)
        last = blocks[-1] if blocks and not ended else None
        if kind == "item":
            if last is None or last["kind"] != "list":
                blocks.append({"kind": "list", "items": []})
            blocks[-1]["items"].append(text)
        elif kind == "heading":
            blocks.append({"kind": "heading", "text": text})
        elif text and last is not None and last["kind"] == "paragraph":
            last["text"] += f" {text}"
        elif text and last is not None and last["kind"] == "list":
            last["items"][-1] += f" {text}"
        elif text:
            blocks.append({"kind": "paragraph", "text": text})
        ended = not line or kind == "heading"
    return blocks


def _kind(line: str) -> tuple[str, str]:
    if line.startswith("#"):
        return "heading", line.lstrip("#").strip()
    if line.startswith(("- ", "* ")):
        return "item", line[2:].strip()
    return "text", line
