"""Page that needs no server: one file with all its data."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from beliefnest.errors import InputError
from beliefnest.files import replace_file
from beliefnest.nest.face.reader import Reader
from beliefnest.viewer.page.html import page_html
from beliefnest.viewer.page.reasons import ahead
from beliefnest.viewer.page.run import About


def check_depth(depth: int) -> None:
    """Raise InputError if a page cannot hold all beliefs to a depth: it must be from 0 to 4."""
    if not 0 <= depth <= 4:
        raise InputError(
            f"depth is {depth}; give 0 to 4, and add deeper beliefs one by one as paths"
        )


def still_page(
    runs: Iterable[tuple[Reader, About]], depth: int = 2, first: Mapping[str, Any] | None = None
) -> str:
    """Return the text of a page that shows the present state of some runs.

    Args:
        runs: Runs, such as all conditions, each with texts about it.
        depth: Depth of the beliefs that are included; those of `About.paths` are added.
        first: Initial selection: `at`, a path; `tick`.

    Raises:
        InputError: The depth is not from 0 to 4, or the page was not built with the package.
    """
    check_depth(depth)
    updates: list[dict[str, Any]] = []
    title = ""
    for reader, about in runs:
        title = title or about.title
        updates.append(ahead(reader, about, depth))
    return page_html(title, {"runs": updates, "first": dict(first or {})}, served=False)


def write_still_page(
    file: Path,
    runs: Iterable[tuple[Reader, About]],
    depth: int = 2,
    first: Mapping[str, Any] | None = None,
) -> None:
    """Write `still_page` to a file.

    Raises:
        InputError: As for `still_page`, or the file cannot be written.
    """
    text = still_page(runs, depth, first)
    try:
        replace_file(file, text)
    except OSError as error:
        raise InputError(
            f"the page {file} cannot be written ({error.strerror or error}); check the path"
        ) from None
