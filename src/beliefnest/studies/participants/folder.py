"""Folder of a page for participants: static files that need no server and no network."""

import json
from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from beliefnest.errors import InputError
from beliefnest.files import os_errors_of, replace_file
from beliefnest.locking import holding
from beliefnest.plan.cells import digest, variation_id
from beliefnest.studies.participants.film import SceneFilm
from beliefnest.studies.participants.items import Item
from beliefnest.studies.participants.playing import ParticipantView
from beliefnest.viewer.page.html import inlined, packed, self_contained
from beliefnest.world.texts import on_one_line

_WEB = files("beliefnest.studies.participants") / "web"
_STIMULI = "stimuli.js"


def experiment(
    shown_items: Iterable[tuple[Item, Sequence[ParticipantView]]], shown: str, seed: int
) -> dict[str, Any]:
    """Return what participants see, as plain values without any right answer.

    Options are sorted, so that their order in the scenario tells nothing.

    Args:
        shown_items: Items with their views.
        shown: `film`, `story` or `both`.
        seed: Seed of the study, from which the orders of participants are derived.

    Returns:
        `study` (a hash of all else), `seed`, `shown`, `lists` (indices of items) and `items`.
    """
    items: list[dict[str, Any]] = []
    lists: dict[int, list[int]] = {}
    for item, views in shown_items:
        lists.setdefault(item.cell.list_number or 1, []).append(len(items))
        items.append(_item(item, views))
    content = {
        "seed": seed,
        "shown": shown,
        "lists": [lists[number] for number in sorted(lists)],
        "items": items,
    }
    return {"study": digest(content)[:16], **content}


def _item(item: Item, views: Sequence[ParticipantView]) -> dict[str, Any]:
    key = item.cell.key
    return {
        "cell": item.name,
        "scenario": key.scenario,
        "condition": key.condition,
        "variation": variation_id(key.scenario, dict(key.variation)),
        "views": [_view(item, view) for view in views],
    }


def _view(item: Item, view: ParticipantView) -> dict[str, Any]:
    owner = view.owner
    return {
        "owner": None if owner is None else f"{owner[:1].upper()}{owner[1:]}",
        "story": list(view.story),
        "film": None if view.film is None else _film(view.film),
        "questions": [
            {
                "id": each.id,
                "text": each.asked.question,
                "options": sorted(each.asked.options, key=lambda text: (text.casefold(), text)),
                "reason": each.asked.reason,
            }
            for each in item.at(view.path)
        ],
    }


def _film(film: SceneFilm) -> dict[str, Any]:
    return {
        "pictures": list(film.pictures),
        "frames": [[each.picture, each.ms, each.caption] for each in film.frames],
    }


def check_post(address: str) -> None:
    """Raise InputError if answers cannot be sent to an address."""
    parts = urlsplit(address)
    if parts.scheme not in ("http", "https") or not parts.netloc:
        raise InputError(f"--post is {address!r}; give an address such as https://lab.example/data")


def check_folder(folder: Path) -> None:
    """Raise InputError if a folder holds anything but a page for participants."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; name a folder")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / _STIMULI).is_file():
        raise InputError(f"{folder} is not empty and holds no page for participants; name another")


def page_files(
    content: Mapping[str, Any],
    title: str,
    pages: Sequence[Any],
    ending: Sequence[Any],
    post: str | None,
) -> dict[str, str]:
    """Return the files of the folder, by name.

    Args:
        content: Result of `experiment`.
        title: Title of the browser's tab.
        pages: Pages of instructions.
        ending: Blocks of text below the thanks at the end.
        post: Address to which `index.html` sends the answers; None: participants save them.
    """
    texts = {
        "title": on_one_line(title),
        "pages": list(pages),
        "ending": list(ending),
        "post": post,
    }
    data = packed({**content, **texts})
    plugin, session, style = (_web(name) for name in ("plugin.js", "session.js", "style.css"))
    program = inlined("\n".join([plugin, session, _web("runner.js")]))
    example = _web("example.js")
    return {
        "index.html": self_contained(
            title,
            style,
            program,
            data,
            connect=_address(post),
            pictures="data:",
            body_class="bn-body",
        ),
        "jspsych.html": _web("jspsych.html"),
        "plugin-beliefnest-question.js": plugin,
        "session.js": session,
        "example.js": example,
        "style.css": style,
        _STIMULI: f"globalThis.beliefnestStudy = {json.dumps(data)}\n",
    }


def write_folder(folder: Path, contents: Mapping[str, str]) -> None:
    """Write the files; raise InputError if they cannot be written."""
    with (
        os_errors_of(f"the folder {folder}", "written"),
        holding(folder, "name another folder with -o"),
    ):
        for name, text in contents.items():
            replace_file(folder / name, text)


def _web(name: str) -> str:
    return (_WEB / name).read_text(encoding="utf-8")


def _address(post: str | None) -> str:
    """Return the only address that the page may talk to, as in a content security policy."""
    parts = urlsplit(post or "")
    return f"{parts.scheme}://{parts.netloc}" if post else "'none'"
