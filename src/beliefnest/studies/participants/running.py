"""Pages for participants of a study, and the way back of their answers.

A page is a folder of static files that need no server and no network, with instructions of
headings, paragraphs and lists.
"""

import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal, get_args
from urllib.parse import urlsplit

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.files import os_errors_of, read_regular_text, replace_file
from beliefnest.locking import holding
from beliefnest.plan.cells import digest, variation_id
from beliefnest.plan.scenario_cells import Cell
from beliefnest.scenarios.document import Document
from beliefnest.studies.design import Design
from beliefnest.studies.participants.answers import (
    PersonAnswer,
    answer_files,
    read_answers,
    with_pseudonyms,
)
from beliefnest.studies.participants.exclusions import excluded_words, read_exclusions
from beliefnest.studies.participants.film import SceneFilm
from beliefnest.studies.participants.items import Item, items_of, left_out
from beliefnest.studies.participants.joining import (
    Joined,
    check_name,
    checked_answer,
    counted_answers,
    joined,
)
from beliefnest.studies.participants.playing import (
    OnItem,
    ParticipantView,
    judged_items,
    refuse_claims,
    shown_items,
)
from beliefnest.studies.plainframe import Typed, write_csv
from beliefnest.viewer.page.html import inlined, packed, self_contained
from beliefnest.world.texts import on_one_line

ShownForm = Literal["film", "story", "both"]
"""Form in which participants get a scene."""


class Page(msgspec.Struct, frozen=True):
    """Page for participants that was written.

    Attributes:
        folder: Its folder.
        items: Number of items: cells without models.
        questions: Number of questions over all items.
        lists: Number of items in each list.
        notes: Probes that people are not asked, with the reasons.
    """

    folder: Path
    items: int
    questions: int
    lists: tuple[int, ...]
    notes: tuple[str, ...]


def make_page(
    design: Design,
    cells: Sequence[Cell],
    documents: Mapping[str, Document],
    folder: Path,
    shown: str,
    instructions: Path | None,
    ending: Path | None,
    title: str,
    post: str | None,
    on_item: OnItem,
) -> Page:
    """Play a study without models and write its page for participants.

    Args:
        design: Design of the study.
        cells: Its cells.
        documents: Documents of its scenarios.
        folder: Folder to write.
        shown: `film`, `story` or `both`.
        instructions: File of instructions; None: the default ones.
        ending: File of a text for the end; None: no text.
        title: Title of the browser's tab.
        post: Address to which answers are sent; None: participants save them.
        on_item: Function that receives the progress.

    Raises:
        BeliefNestError: An argument is wrong, no probe asks a question, or a script failed.
    """
    if shown not in get_args(ShownForm):
        raise InputError(f"--show is {shown!r}; give one of {', '.join(get_args(ShownForm))}")
    refuse_claims(design.setting)
    _check_folder(folder)
    if post is not None:
        _check_post(post)
    end = [] if ending is None else [each for page in read_instructions(ending) for each in page]
    items = items_of(cells, documents)
    own = None if instructions is None else read_instructions(instructions)
    pages = own or _instruction_pages(shown, items)
    content = experiment(shown_items(items, shown, on_item), shown, design.seed)
    _write_folder(folder, _page_files(content, title, pages, end, post))
    return Page(
        folder=folder,
        items=len(items),
        questions=sum(len(item.questions) for item in items),
        lists=tuple(len(each) for each in content["lists"]),
        notes=tuple(left_out(cells)),
    )


def join_answers(
    design: Design,
    cells: Sequence[Cell],
    documents: Mapping[str, Document],
    files: Sequence[Path],
    name: str,
    on_item: OnItem,
    *,
    pseudonyms: bool,
    exclude: Path | None,
) -> Joined:
    """Read answers of participants and judge them as those of models.

    Args:
        design: Design of the study.
        cells: Its cells.
        documents: Documents of its scenarios.
        files: Files of answers, or folders of such files.
        name: Name of the people in the column `model`.
        on_item: Function that receives the progress.
        pseudonyms: Replace ids of participants by `p1`, `p2` and so on.
        exclude: List of participants whose answers do not count; None: nobody.

    Raises:
        BeliefNestError: A file does not fit the study, or a script failed.
    """
    refuse_claims(design.setting)
    check_name(name, design.models)
    items = items_of(cells, documents)
    answers = [each for file in answer_files(files) for each in read_answers(file)]
    excluded = {} if exclude is None else read_exclusions(exclude, answers)
    named = with_pseudonyms(answers) if pseudonyms else answers
    # The pseudonym of a participant does not depend on whom the list excludes.
    answers = [
        shown
        for shown, answer in zip(named, answers, strict=True)
        if answer.participant not in excluded
    ]
    reasons = dict(Counter(excluded.values()))
    notes = [f"excluded: {excluded_words(reasons)}"] if reasons else []
    by_name = {item.name: item for item in items}
    real_answers = [checked_answer(each, by_name) for each in answers if not each.is_start]
    sessions = counted_answers(real_answers, notes)
    answered = {cell for own in sessions.values() for cell in own}
    wanted = [item for item in items if item.name in answered]
    pages = {each.study for each in answers if each.study}
    if len(pages) > 1:
        notes.append(
            f"the answers come from {len(pages)} different pages ({', '.join(sorted(pages))}), "
            "whose cells are all part of this study"
        )
    result = joined(sessions, judged_items(wanted, on_item), name, items, notes, answers)
    result.sessions = replace(result.sessions, excluded=reasons)
    return result


def write_answers(file: Path, answers: Sequence[tuple[PersonAnswer, bool]]) -> None:
    """Write a table of all answers: the columns of the files, and `right`."""
    names = list(dict.fromkeys(name for answer, _ in answers for name in answer.plain))
    columns = {
        name: Typed([_text(answer.plain.get(name)) for answer, _ in answers], "string")
        for name in names
        if name != "right"
    }
    write_csv({**columns, "right": Typed([right for _, right in answers], "bool")}, file)


def _text(value: object) -> str | None:
    """Return a value as the CSV file of the page has it."""
    if value is None or value == "":
        return None
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


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


def _check_post(address: str) -> None:
    """Raise InputError if answers cannot be sent to an address."""
    parts = urlsplit(address)
    if parts.scheme not in ("http", "https") or not parts.netloc:
        raise InputError(f"--post is {address!r}; give an address such as https://lab.example/data")


def _check_folder(folder: Path) -> None:
    """Raise InputError if a folder holds anything but a page for participants."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; name a folder")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / _STIMULI).is_file():
        raise InputError(f"{folder} is not empty and holds no page for participants; name another")


def _page_files(
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


def _write_folder(folder: Path, contents: Mapping[str, str]) -> None:
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


def _instruction_pages(shown: str, items: Sequence[Item]) -> list[list[dict[str, Any]]]:
    """Return the default instructions for what participants are shown.

    Args:
        shown: `film`, `story` or `both`.
        items: All items: the instructions say from whose view they are told, and how people see.
    """
    parts = ["# Instructions", _BEGINNINGS[shown], _sight(items), _viewing(items), _HOW]
    return _pages("\n\n".join(part for part in parts if part))


def _sight(items: Sequence[Item]) -> str:
    """Return a sentence about the field of view; empty if scenarios differ in it."""
    fields = {item.cell.scenario.setting.perception.field_of_view for item in items}
    if fields == {_WHOLE}:
        return _ALL_AROUND
    return "" if _WHOLE in fields else _AHEAD


def _viewing(items: Sequence[Item]) -> str:
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
