"""`beliefnest participants`: the page of a study for people, and the way back of their answers."""

from typing import Any

from beliefnest.cli.console import print_report, progress_on
from beliefnest.cli.options import ParticipantsOptions
from beliefnest.cli.study import write_files
from beliefnest.errors import InputError
from beliefnest.studies.study import Study
from beliefnest.world.words import counted, listed

_OF_PAGE = ("instructions", "ending", "post")


def run_participants(options: ParticipantsOptions) -> None:
    """Write the page of a study for people, or read their answers into the study's folder.

    Raises:
        BeliefNestError: The study or a file is wrong, or a script failed.
    """
    only_read = {"pseudonyms": options.pseudonyms, "exclude": options.exclude}
    for name in (name for name, value in only_read.items() if value and not options.read):
        raise InputError(f"--{name} belongs to reading answers; give their files with --read")
    summary, lines = _read(options) if options.read else _written(options)
    print_report(summary, lines, as_json=options.json)


def _written(options: ParticipantsOptions) -> tuple[dict[str, Any], list[str]]:
    with progress_on(options.study.stem) as on_progress:
        page = Study.load(options.study).participants(
            options.out,
            options.show,
            instructions=options.instructions,
            ending=options.ending,
            title=options.title,
            post=options.post,
            on_item=on_progress,
        )
        on_progress("writing the page", page.items, page.items)
    start = page.folder / "index.html"
    summary = {
        "page": str(start),
        "items": page.items,
        "questions": page.questions,
        "lists": list(page.lists),
        "left_out": list(page.notes),
    }
    lists = f", in lists of {listed([str(n) for n in page.lists])}" * (len(page.lists) > 1)
    size = f"{counted(page.items, 'item')} with {counted(page.questions, 'question')}{lists}"
    return summary, [*page.notes, f"{start}: {size}; open it with ?participant=ID"]


def _read(options: ParticipantsOptions) -> tuple[dict[str, Any], list[str]]:
    for name in _OF_PAGE:
        if getattr(options, name) is not None:
            raise InputError(f"--{name} belongs to writing a page; leave it out with --read")
    with progress_on(options.study.stem) as on_progress:
        result, notes = Study.load(options.study).read_participants(
            options.out,
            options.read or (),
            options.name,
            pseudonyms=options.pseudonyms,
            exclude=options.exclude,
            on_item=on_progress,
        )
        on_progress("writing tables", 1, 1)
        write_files(result, result.groups)
    own = [row for row in result.rows if row["model"] == options.name]
    people = {row["participant"] for row in own}
    data = {
        "study_dir": str(result.folder.path),
        "participants": len(people),
        "rows": len(own),
        "right": sum(row["ok"] is True for row in own),
        "notes": list(notes),
    }
    size = f"{counted(len(people), 'participant')} and {counted(len(own), 'row')}"
    return data, [*notes, f"{result.folder.path}: {size} of {options.name}, {data['right']} right"]
