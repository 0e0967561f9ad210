"""`beliefnest show --html` and `beliefnest serve`: the page."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from beliefnest.cli.console import stdout
from beliefnest.cli.folder import stores_in
from beliefnest.episodes.telling import told_episode
from beliefnest.errors import InputError, TickError
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.store import SqliteJournal
from beliefnest.viewer.page.run import About
from beliefnest.viewer.page.static import write_still_page
from beliefnest.world.paths import parse_path, path_text

__all__ = ["PageOptions", "about_run", "write_page"]

_ENDINGS = (".html", ".htm")


@dataclass(frozen=True, slots=True)
class PageOptions:
    """What was asked for.

    Attributes:
        run: Run folder, or a store.
        file: What to write.
        path: Belief to be in it whatever its depth.
        tick: What the page is to show at first; None: the latest.
        branch: Always None: the page holds every branch.
        depth: How deep all beliefs go.
    """

    run: Path
    file: Path
    path: str
    tick: int | None
    branch: str | None
    depth: int


def write_page(options: PageOptions) -> None:
    """Write the page of a run, with all its conditions.

    Raises:
        BeliefNestError: There is no such run, a path, tick or ending is wrong, a branch was named,
            or the file cannot be written.
    """
    if options.file.suffix.lower() not in _ENDINGS:
        raise InputError(
            f"--html writes HTML, and {options.file} does not end in {' or '.join(_ENDINGS)}"
        )
    if options.branch is not None:
        raise InputError("the page holds every branch; leave --branch out, and choose it there")
    with ExitStack() as stack:
        runs = []
        for store in stores_in(options.run):
            journal = stack.enter_context(SqliteJournal.read(store))
            stack.enter_context(journal.unchanging())
            nest = RecordedNest(journal)
            runs.append((nest.reader, about_run(journal, nest, [options.path])))
            _check_tick(options, nest, store)
        first: dict[str, object] = {"tick": options.tick}
        if options.path != "/":
            first["at"] = path_text(parse_path(options.path, nest.agents))
        write_still_page(options.file, runs, options.depth, first)
    stdout().print(f"written to {options.file}", highlight=False, soft_wrap=True)


def _check_tick(options: PageOptions, nest: RecordedNest, store: Path) -> None:
    """That a run has the tick that is to be shown at first."""
    if options.tick is None:
        return
    try:
        _ = nest.simulator(options.path, options.tick).state
    except TickError as error:
        raise TickError(f"in {store.parent.name}: {error}") from None


def about_run(journal: SqliteJournal, nest: RecordedNest, paths: Sequence[str] = ()) -> About:
    """What a run is called, and what its scenario asks about."""
    run = journal.records.run()
    scenario = Scenario(nest.setting)
    if run.text:
        condition = int(run.condition) if run.condition else None
        scenario = Scenario.kept(run.text, run.templates, condition, f"scenario of {journal.path}")
    named = [probe.path for probe in scenario.probes]
    named += [each.path for each in scenario.expectations]
    wanted = [parse_path(path, nest.agents) for path in (*paths, *named)]
    number = "" if scenario.condition is None else f"condition {scenario.condition}: "
    return About(
        title=scenario.name,
        subtitle=f"{number}{scenario.condition_description}".removesuffix(": "),
        description=scenario.description,
        labels=scenario.labels,
        paths=tuple(dict.fromkeys(path for path in wanted if path)),
        episode=lambda: told_episode(nest),
    )
