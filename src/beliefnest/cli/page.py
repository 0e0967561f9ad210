"""The HTML page of a run, for `beliefnest show --html` and `beliefnest serve`."""

from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from beliefnest.cli.console import stdout
from beliefnest.cli.folder import stores_in
from beliefnest.cli.options import ShowOptions
from beliefnest.episodes.telling import told_episode
from beliefnest.errors import InputError, ScenarioError, TickError
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.store import Journal
from beliefnest.viewer.page.posteriors import told_inference
from beliefnest.viewer.page.run import About
from beliefnest.viewer.page.static import write_still_page
from beliefnest.world.paths import parse_path, path_text

_STEPS = 5
"""Actions after which posteriors predict places."""

_ENDINGS = (".html", ".htm")


def write_page(options: ShowOptions, file: Path) -> None:
    """Write the page of a run, with all its conditions.

    Args:
        options: Run, and the belief and tick that the page shows first.
        file: HTML file to write.

    Raises:
        BeliefNestError: There is no such run, a path, tick or file ending is wrong, a branch was
            named, or the file cannot be written.
    """
    if file.suffix.lower() not in _ENDINGS:
        raise InputError(f"--html writes HTML: {file} must end in {' or '.join(_ENDINGS)}")
    if options.branch is not None:
        raise InputError(
            "the page holds every branch; leave --branch out, and choose the branch on the page"
        )
    with ExitStack() as stack:
        runs = []
        for store in stores_in(options.run):
            journal = stack.enter_context(Journal.read(store))
            stack.enter_context(journal.unchanging())
            nest = RecordedNest(journal)
            runs.append((nest.reader, about_run(journal, nest, [options.path])))
            _check_tick(options, nest, store)
        first: dict[str, object] = {"tick": options.tick}
        if options.path != "/":
            first["at"] = path_text(parse_path(options.path, nest.agents))
        write_still_page(file, runs, options.depth, first)
    stdout().print(f"written to {file}", highlight=False, soft_wrap=True)


def _check_tick(options: ShowOptions, nest: RecordedNest, store: Path) -> None:
    """Raise TickError if a run does not have the tick that the page shows first."""
    if options.tick is None:
        return
    try:
        _ = nest.simulator(options.path, options.tick).state
    except TickError as error:
        raise TickError(f"in {store.parent.name}: {error}") from None


def about_run(journal: Journal, nest: RecordedNest, paths: Sequence[str] = ()) -> About:
    """Return the name of a run and the beliefs that its scenario asks about."""
    run = journal.records.run()
    scenario = Scenario(nest.setting)
    if run.text:
        condition = run.condition_number
        scenario = Scenario.kept(run.text, run.templates, condition, f"scenario of {journal.path}")
    named = [probe.path for probe in scenario.probes]
    named += [each.simulator for each in scenario.expectations]
    wanted = [parse_path(path, nest.agents) for path in (*paths, *named)]
    number = "" if scenario.condition is None else f"condition {scenario.condition}"
    return About(
        title=scenario.name,
        subtitle=": ".join(filter(None, (number, scenario.condition_description))),
        description=scenario.description,
        labels=scenario.labels,
        paths=tuple(dict.fromkeys(path for path in wanted if path)),
        episode=lambda: told_episode(nest),
        inferences=lambda: _inferences(nest, scenario),
    )


def _inferences(nest: RecordedNest, scenario: Scenario) -> list[dict[str, Any]]:
    """Return the posteriors of the probes that infer; without those that do not fit the run."""
    inferences = []
    for number, probe in enumerate(scenario.probes, start=1):
        # A run that was interrupted, or that still goes on, may lack the ticks to infer from.
        with suppress(ScenarioError):
            if probe.infer is not None:
                inference = probe.infer.inference(nest[probe.path])
                title = f"{probe.label or f'probe {number}'}, by {probe.path}"
                inferences.append({**told_inference(inference, _STEPS), "title": title})
    return inferences
