"""`beliefnest branches`: the tree of branches of recorded runs."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.text import Text
from rich.tree import Tree

from beliefnest.cli.console import stdout
from beliefnest.cli.folder import stores_in
from beliefnest.timeline.journal import TimelineInfo, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.paths import path_text


def show_branches(run: Path, *, as_json: bool) -> None:
    """Print every branch of a run below the branch it was forked from.

    Raises:
        BeliefNestError: There is no such run.
    """
    runs = []
    for store in stores_in(run):
        with Journal.read(store) as journal:
            infos, selected = journal.timelines(), set(journal.records.selected().items())
        if as_json:
            runs.append({"run": str(store), "timelines": [_told(i, selected) for i in infos]})
        else:
            stdout().print(_tree(str(store), infos, selected))
    if as_json:
        sys.stdout.write(json.dumps(runs, indent=2) + "\n")


def _told(info: TimelineInfo, selected: set[tuple[tuple[str, ...], str]]) -> dict[str, Any]:
    base = info.base
    return {
        "path": path_text(info.key.path),
        "branch": info.key.branch,
        "base": None
        if base is None
        else {
            "path": path_text(base.timeline.path),
            "branch": base.timeline.branch,
            "tick": base.tick,
        },
        "start": info.start,
        "head": info.head,
        "selected": (info.key.path, info.key.branch) in selected,
        "description": info.description,
    }


def _tree(
    title: str, infos: Sequence[TimelineInfo], selected: set[tuple[tuple[str, ...], str]]
) -> Tree:
    root = Tree(title, highlight=False)
    drawn: dict[TimelineKey, Tree] = {}
    for info in infos:
        above = root if info.base is None else drawn[info.base.timeline]
        line = Text(f"{path_text(info.key.path)}  ")
        line.append(info.key.branch, style="bold")
        line.append(f"  ticks {info.start} to {info.head}")
        if (info.key.path, info.key.branch) in selected:
            line.append("  (selected)")
        if info.description:
            line.append(f"  {info.description}", style="italic")
        drawn[info.key] = above.add(line)
    return root
