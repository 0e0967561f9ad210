"""Pages for participants of a study, and the way back of their answers."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, get_args

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
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
from beliefnest.studies.participants.folder import (
    check_folder,
    check_post,
    experiment,
    page_files,
    write_folder,
)
from beliefnest.studies.participants.instructions import instruction_pages, read_instructions
from beliefnest.studies.participants.items import items_of, left_out
from beliefnest.studies.participants.joining import (
    Joined,
    check_name,
    checked_answer,
    counted_answers,
    joined,
)
from beliefnest.studies.participants.playing import OnItem, judged_items, refuse_claims, shown_items
from beliefnest.studies.plainframe import Typed, write_csv

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
    check_folder(folder)
    if post is not None:
        check_post(post)
    end = [] if ending is None else [each for page in read_instructions(ending) for each in page]
    items = items_of(cells, documents)
    pages = (
        instruction_pages(shown, items) if instructions is None else read_instructions(instructions)
    )
    content = experiment(shown_items(items, shown, on_item), shown, design.seed)
    write_folder(folder, page_files(content, title, pages, end, post))
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
