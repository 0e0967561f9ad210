"""`beliefnest play --baselines`: the table of tasks and policies, and its page."""

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from rich import box
from rich.table import Table

from beliefnest.cli.console import folded, progress_on, stdout
from beliefnest.episodes.baselines import BASELINES, Baseline, Cell, play_cells, summary
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.task import Task
from beliefnest.episodes.tasks import parameters_of, source_of
from beliefnest.errors import InputError

__all__ = ["BaselineOptions", "page_of", "run_baselines"]

_REPORTS = 20
"""Lines of progress where there is no terminal."""

_COLUMNS = ("task", "order", "policy", "success", "95 %", "ticks", "messages")


@dataclass(frozen=True, slots=True)
class BaselineOptions:
    """What was asked for on the command line.

    Attributes:
        task: The only task; None: all.
        seeds: How many instances of each.
        jobs: Episodes at the same time.
        page: Markdown file to write, with pictures in `img` beside it; None: none.
        as_json: Whether to print one JSON object instead of a table.
    """

    task: str | None
    seeds: int
    jobs: int
    page: Path | None
    as_json: bool


def run_baselines(options: BaselineOptions) -> int:
    """Play, print, and write the page; the status is 1 if a task is not what it claims to be.

    It is, if `search` of its order reaches the goal in all episodes and of one less in none.

    Raises:
        BeliefNestError: The input is wrong.
    """
    if options.seeds < 1:
        raise InputError(f"--seeds is {options.seeds}; give at least 1")
    names = Task.names() if options.task is None else (options.task,)
    cells = [
        Cell(Task.load(name).name, policy, seed)
        for name in names
        for policy in BASELINES
        for seed in range(options.seeds)
    ]
    with progress_on("baselines") as on_progress:
        step = max(1, len(cells) // _REPORTS)

        def told(done: int) -> None:
            if done % step == 0 or done == len(cells):
                on_progress("playing", done, len(cells))

        measures = play_cells(cells, options.jobs, told)
    found = summary(cells, measures)
    if options.page is not None:
        _draw(names, options.page.parent / "img")
        options.page.write_text(page_of(names, found, options.seeds), encoding="utf-8")
    if options.as_json:
        content = {"seeds": options.seeds, "baselines": [asdict(each) for each in found]}
        sys.stdout.write(json.dumps(content, indent=2) + "\n")
    else:
        _print(found)
    return 0 if all(_is_as_claimed(each) for each in found) else 1


def page_of(names: Sequence[str], found: Sequence[Baseline], seeds: int) -> str:
    """The page of tasks, as Markdown."""
    lines = [
        "# Tasks",
        "",
        "Eight built-in tasks for agents that act round after round ([episodes](episodes.md)).",
        "Each instance comes from a seed; `search` of the order that a task needs solves it, and",
        "of one order less does not: tests hold that. This page is written by",
        f"`beliefnest play --baselines --seeds {seeds} --page docs/tasks.md`;",
        "`make baselines` takes 50 seeds.",
        "",
        f"Players by policy, over {seeds} seeds, in the scripted world; who is no player acts",
        "as the task says. Success with its 95 % interval of Wilson; mean ticks of those that",
        "succeeded; mean utterances of players.",
        "",
        f"| {' | '.join(_COLUMNS)} |",
        "|" + "---|" * len(_COLUMNS),
        *(f"| {' | '.join(_cells(each))} |" for each in found),
    ]
    for name in names:
        first, _, rest = source_of(name).partition("\n\n")
        sizes = ", ".join(
            f"`{key}` {low} to {high} ({default})"
            for key, (default, low, high) in parameters_of(name).items()
        )
        lines += ["", f"## {name}", "", f"**{first}**", "", rest, ""]
        lines += [f"Order {Task.load(name).order}. Sizes: {sizes}.", ""]
        lines += [f"`beliefnest play {name}`", "", f"![An instance of {name}](img/task-{name}.png)"]
    return "\n".join(lines) + "\n"


def _draw(names: Sequence[str], folder: Path) -> None:
    folder.mkdir(exist_ok=True)
    for name in names:
        with Episode(Task.load(name)) as episode:
            episode.nest.figure(["/"]).save(str(folder / f"task-{name}.png"))


def _cells(found: Baseline) -> tuple[str, ...]:
    rate = f"{found.successes}/{found.episodes}"
    ticks = "" if found.ticks is None else f"{found.ticks:.0f}"
    interval = f"{found.low:.2f} to {found.high:.2f}"
    messages = f"{found.messages:.1f}"
    return (found.task, str(found.order), found.policy, rate, interval, ticks, messages)


def _is_as_claimed(found: Baseline) -> bool:
    if found.policy == f"search:{found.order}":
        return found.successes == found.episodes
    return found.policy != f"search:{found.order - 1}" or found.successes == 0


def _print(found: Sequence[Baseline]) -> None:
    table = Table(title="baselines", title_justify="left", box=box.SIMPLE_HEAVY)
    for column in _COLUMNS:
        table.add_column(column)
    for each in found:
        table.add_row(*_cells(each))
    stdout().print(folded(table))
