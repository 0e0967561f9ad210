"""`beliefnest show` and `beliefnest prompt`: read a recorded run and its claims."""

import itertools
import json
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from msgspec.structs import replace
from rich import box
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from beliefnest.belief.context import BeliefContext
from beliefnest.belief.grounds import Basis, Source
from beliefnest.belief.node_memory import paths_with_room
from beliefnest.belief.plain import state_json
from beliefnest.belief.view import State
from beliefnest.cli.console import folded, print_table, stdout
from beliefnest.cli.folder import store_in, stores_in
from beliefnest.cli.options import ShowOptions
from beliefnest.cli.report import placed_lines
from beliefnest.cli.terminal_text import printable, say
from beliefnest.errors import BranchError, InputError, TemplateError, TickError
from beliefnest.nest.explain.made_claims import MadeClaim
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.nest.face.shown import PastSimulator
from beliefnest.pictures.animation import check_animated, save_animation
from beliefnest.pictures.figure import figure_of
from beliefnest.pictures.scene import Scene
from beliefnest.prompts.memory_filters import memory
from beliefnest.prompts.rendering import check_variables
from beliefnest.prompts.templates import (
    BUILT_IN_TEMPLATES,
    Template,
    built_in_template,
    load_template,
)
from beliefnest.scenarios.naming import container_name, place_name
from beliefnest.scenarios.records import placed_json
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.export_tables import prompt_row
from beliefnest.timeline.journal import FOLLOW
from beliefnest.timeline.run_records import ProgramRecord, PromptRecord
from beliefnest.timeline.store import Journal
from beliefnest.world.claims import Claim, ClaimKind
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.texts import on_one_line
from beliefnest.world.words import items_words, titled

_FRAMES = 120
"""Greatest number of pictures in an animation."""


def show_run(options: ShowOptions) -> None:
    """Print or draw the state of a simulator, for each condition of a run.

    Raises:
        BeliefNestError: There is no such run, simulator, branch or tick, or a file cannot be
            written.
    """
    for form, file in options.figures.items():
        if file.suffix.lower() != f".{form}":
            raise InputError(f"--{form} writes {form.upper()}: {file} must end in .{form}")
    if options.json or options.gif is not None:
        stores: tuple[Path, ...] = (store_in(options.run),)
    else:
        stores = stores_in(options.run)
        if len(stores) > 1:
            _check(options, stores)
    if options.gif is not None:
        _animate(options, stores[0])
        _tell(options, options.gif)
    if options.figures:
        figure = figure_of([scene for store in stores for scene in _scenes(options, store, stores)])
        for file in options.figures.values():
            figure.save(file)
            _tell(options, file)
    if options.json or not (options.figures or options.gif):
        for store in stores:
            if len(stores) > 1:
                stdout().print(f"[bold]{_name_in(store, options.run)}[/bold]", highlight=False)
            (_show_claims if options.claims else _show)(options, store)


def _tell(options: ShowOptions, file: Path) -> None:
    """Tell that a file was written, unless the output is one JSON object."""
    if not options.json:
        stdout().print(f"written to {file}", highlight=False, soft_wrap=True)


def _check(options: ShowOptions, stores: Sequence[Path]) -> None:
    """Raise an error if a run lacks the wanted path, branch or tick, before anything is printed."""
    for store in stores:
        with _opened(store) as (_, nest, _):
            try:
                _ = _simulator(options, nest).state
            except (BranchError, TickError) as error:
                example = _name_in(stores[0], options.run).replace(" ", "-")
                raise type(error)(
                    f"in {_name_in(store, options.run)}: {error}; "
                    f"or name the folder of one condition, as {options.run / example}"
                ) from None


def _show(options: ShowOptions, store: Path) -> None:
    with _opened(store) as (scenario, nest, _):
        simulator = _simulator(options, nest)
        state = simulator.state
        asked = [each for each in nest.prompts(options.path) if each.tick <= state.tick]
        programs = [each for each in nest.programs(options.path) if each.tick <= state.tick]
        claims = nest.at(state.tick).claims(options.path)
        if options.json:
            held_by = [simulator.path] if claims and claims[0].made_in != simulator.path else []
            place = {"path": simulator.path, "branch": options.branch or FOLLOW, "tick": state.tick}
            content = {
                **place,
                **state_json(state),
                "placed": placed_json(simulator.placed),
                "programs": [_program_json(each) for each in programs],
                "prompts": [prompt_row(each)[1] for each in asked],
                "claims": _claims_json(claims, held_by),
            }
            sys.stdout.write(json.dumps(content, indent=2) + "\n")
        else:
            _print_state(state, simulator.path, scenario)
            if claims:
                stdout().print("Claims")
                print_table(stdout(), _claims_table(claims, simulator.path, scenario))
            for line in placed_lines(simulator.placed):
                stdout().print(_foreign(line), highlight=False)
            _print_programs(programs)
            _print_prompts(asked)


def _show_claims(options: ShowOptions, store: Path) -> None:
    """Print every claim made in the world of a simulator, with the verdicts of all beliefs."""
    with _opened(store) as (scenario, nest, _):
        simulator = _simulator(options, nest)
        claims = nest.at(simulator.tick).claims(options.path)
        context = nest.reader.history.context
        paths = _paths_of_beliefs(claims, context, options.depth) if claims else []
        if options.json:
            sys.stdout.write(json.dumps(_claims_json(claims, paths), indent=2) + "\n")
        elif claims:
            _print_claims(stdout(), claims, paths, scenario)
        else:
            stdout().print(f"nothing was claimed in {simulator.path}", highlight=False)


def _simulator(options: ShowOptions, nest: RecordedNest) -> PastSimulator:
    if options.branch is not None:
        nest.select(options.path, options.branch)
    return nest.simulator(options.path, options.tick)


def _scenes(options: ShowOptions, store: Path, stores: Sequence[Path]) -> tuple[Scene, ...]:
    """Return the scenes of a simulator in one run, titled with the run's name if several."""
    with _opened(store) as (_, nest, _):
        tick = _simulator(options, nest).tick
        (scene,) = nest.scenes(options.path, tick, options.against, height=options.height)
    if len(stores) == 1:
        return (scene,)
    notes = [note for note in (scene.note, _name_in(store, options.run)) if note]
    return (replace(scene, note=", ".join(notes)),)


def _animate(options: ShowOptions, store: Path) -> None:
    """Write an animation of the simulator over its ticks with a change."""
    file = options.gif
    assert file is not None
    check_animated(file)
    with _opened(store) as (_, nest, _):
        ticks = _animated(_simulator(options, nest), options, nest)
        figures = [
            nest.figure(options.path, tick, options.against, height=options.height)
            for tick in ticks
        ]
        spans = [b - a for a, b in itertools.pairwise(ticks)]
        times = [max(40, min(1500, span * 50)) for span in spans]
        save_animation(figures, [*times, 2500], file)


def _animated(simulator: PastSimulator, options: ShowOptions, nest: RecordedNest) -> Sequence[int]:
    """Return the ticks of an animation. A belief that is compared with itself tells no others."""
    ticks = nest.ticks(options.path)
    compared = parse_path(options.against, nest.agents)
    if not compared or path_text(compared) != simulator.path:
        return chosen_ticks(ticks, simulator.tick, _FRAMES)
    percepts = simulator.changes(ticks[0])
    return chosen_ticks(percepts, percepts[-1], _FRAMES)


def chosen_ticks(changes: Sequence[int], end: int, most: int) -> list[int]:
    """Return at most `most` ticks, evenly chosen from `changes` up to the end, and the end."""
    changed = sorted({tick for tick in changes if tick < end})
    step = max(1, -(-len(changed) // max(1, most - 1)))
    return [*changed[::step], end]


def _name_in(store: Path, run: Path) -> str:
    """Return the name of a condition's folder in a run."""
    return str(store.parent.relative_to(run)).replace("-", " ")


def print_prompt(run: Path, path: str, template: Path | None, variables: list[str]) -> None:
    """Print a prompt rendered from a belief at the end of a run.

    Args:
        run: Run folder or run file.
        path: Belief path.
        template: Template file, or the name of a template of the run or a built-in one; None: the
            paper's template.
        variables: Variables of the template, each as `key=value`.

    Raises:
        BeliefNestError: There is no such run or simulator, or the template is wrong.
    """
    values = {}
    for text in variables:
        key, sign, value = text.partition("=")
        if not sign or not key.isidentifier():
            raise InputError(f"{text!r} is no variable; give --var key=value")
        values[key] = value
    with _opened(store_in(run)) as (_, nest, journal):
        source = _template(template, journal.records.run().templates)
        try:
            check_variables(source, tuple(values))
        except TemplateError as fault:
            raise TemplateError(f"{fault}; give it with --var NAME=TEXT") from None
        say(nest.simulator(path).render(source, **values) + "\n")


def _template(wanted: Path | None, kept: Mapping[str, str]) -> Template:
    if wanted is None:
        return built_in_template("paper")
    if not wanted.exists():
        if str(wanted) in kept:
            return Template(str(wanted), kept[str(wanted)])
        if str(wanted) in BUILT_IN_TEMPLATES:
            return built_in_template(str(wanted))
    return load_template(wanted)


@contextmanager
def _opened(store: Path) -> Iterator[tuple[Scenario, RecordedNest, Journal]]:
    with Journal.read(store) as journal, journal.unchanging():
        nest = RecordedNest(journal)
        yield _scenario(journal, nest), nest, journal


def _scenario(journal: Journal, nest: RecordedNest) -> Scenario:
    """Return the scenario of a run; for a run made in code, a scenario with its setting only."""
    run = journal.records.run()
    if not run.text:
        return Scenario(nest.setting)
    condition = run.condition_number
    return Scenario.kept(run.text, run.templates, condition, f"scenario of {journal.path}")


def _print_state(state: State, path: str, scenario: Scenario) -> None:
    console = stdout()
    console.print(f"{path} at tick {state.tick}", highlight=False)
    containers = Table("container", "known items", "all of them", box=box.SIMPLE_HEAVY)
    agents = Table("agent", "position", "seen now", "holds", box=box.SIMPLE_HEAVY)
    if path != "/":
        containers.add_column("how that is known")
        agents.add_column("how that is known")
    for place, content in sorted(state.containers.items()):
        items = items_words(content.items, ids=True)
        name = container_name(place, scenario.setting)
        is_all = "yes" if content.complete else "not known"
        unseen = not (content.items or content.complete) and content.basis.source is Source.SEEN
        basis = None if unseen else content.basis
        grounds = _how_known(state, basis, current=content.current)
        containers.add_row(_foreign(name), items or "-", is_all, *grounds)
    for name, agent in state.agents.items():
        where = "unknown"
        if agent.position is not None:
            where = f"at {place_name(agent.position, scenario.setting)}"
        holds = (agent.equipment or {}).get("main_hand", "-")
        seen = "yes" if agent.current else "no"
        grounds = _how_known(state, agent.basis, current=agent.current)
        agents.add_row(titled(name), _foreign(where), seen, holds, *grounds)
    print_table(console, containers)
    print_table(console, agents)
    for (tick, speaker, text), to in zip(state.chat, state.addressees, strict=True):
        said = speaker if to is None else f"{speaker} whispers to {to}"
        console.print(_foreign(f"tick {tick}, {said}: {text}"), highlight=False)


def _how_known(state: State, basis: Basis | None, *, current: bool) -> list[str]:
    """Return a table cell with the basis and age of a belief; nothing in the real world."""
    if state.owner is None:
        return []
    return ["" if basis is None else memory(state, basis, current=current)]


def _print_programs(programs: Sequence[ProgramRecord]) -> None:
    console = stdout()
    for program in programs:
        failed = on_one_line(f"failed: {program.error}")
        ended = "ended well" if program.error is None else failed
        span = f"ticks {program.tick} to {program.tick + program.ticks}"
        ran = f"{span}: program of {program.agent}: {ended}"
        console.print(_foreign(ran), highlight=False)
        for line in (*program.log, *(f"stopped at its end: {each}" for each in program.unfinished)):
            console.print(_foreign(f"    {line}"), highlight=False)


def _program_json(program: ProgramRecord) -> dict[str, object]:
    return {
        "agent": program.agent,
        "tick": program.tick,
        "ticks": program.ticks,
        "ok": program.ok,
        "error": program.error,
        "lines": list(program.lines),
        "log": list(program.log),
        "unfinished": list(program.unfinished),
        "code": program.code,
        "senses": program.senses,
    }


def _print_prompts(prompts: Sequence[PromptRecord]) -> None:
    if not prompts:
        return
    table = Table("asked at", "model", "attempt", "for", "answer", box=box.SIMPLE_HEAVY)
    for prompt in prompts:
        answer = f"no answer: {prompt.error}" if prompt.answer is None else prompt.answer
        cells = (
            str(prompt.tick),
            prompt.model,
            str(prompt.attempt),
            prompt.detail.get("task", ""),
            answer.strip(),
        )
        table.add_row(*map(_foreign, cells))
    print_table(stdout(), table)


def _foreign(text: str) -> Text:
    """Return a text from outside without markup: square brackets in it stay as they are."""
    return Text(printable(text))


def _claims_json(claims: Sequence[MadeClaim], paths: Collection[str]) -> list[dict[str, object]]:
    """Return claims as plain data.

    Args:
        claims: The claims.
        paths: Beliefs; the result says for each if and why it took up each claim.
    """
    return [
        {
            "tick": claim.tick,
            "speaker": claim.speaker,
            "addressee": claim.addressee,
            "text": claim.text,
            "claim": claim.claim.plain(),
            "claims_from": claim.claims_from,
            "hearers": list(claim.hearers),
            "false": claim.false,
            "lie": claim.lie,
            "beliefs": {
                path: {"taken_up": claim.taken_up(path), "why": claim.why(path)} for path in paths
            },
        }
        for claim in claims
    ]


def _claims_table(claims: Sequence[MadeClaim], path: str, scenario: Scenario) -> Table:
    """Return a table of claims, their hearers, and the verdict of one belief.

    Args:
        claims: The claims; not empty.
        path: Path of the simulator that is shown.
        scenario: Scenario with the names of containers and places.
    """
    table = _begun()
    table.add_column("heard by")
    # The world in which a claim is made is no belief, and has no verdict on it.
    is_belief = claims[0].made_in != path
    if is_belief:
        table.add_column(f"in {path}")
    for claim in claims:
        hearers = printable(", ".join(claim.hearers))
        why = [claim.why(path)] if is_belief else []
        table.add_row(*map(Text, (*_cells(claim, scenario), hearers, *why)))
    return table


def _print_claims(
    console: Console, claims: Sequence[MadeClaim], paths: Sequence[str], scenario: Scenario
) -> None:
    """Print every claim, and if and why each of the given beliefs took it up.

    The table has a column for each belief. If the console is too narrow for it, each claim is
    printed on a line, followed by a line for each verdict with the beliefs that reached it.
    """
    table = _begun()
    for path in paths:
        table.add_column(path)
    for made in claims:
        table.add_row(
            *map(Text, (*_cells(made, scenario), *(_verdict(made, path) for path in paths)))
        )
    # Rich limits the measured width to `max_width`.
    least = Measurement.get(console, console.options.update(max_width=10_000), table).minimum
    if least <= console.width:
        console.print(table)
        return
    for made in claims:
        tick, speaker, claim, kind = _cells(made, scenario)
        suffix = f" ({kind})" if kind else ""
        console.print(Text(f"tick {tick}, {speaker}: {claim}{suffix}"))
        console.print(folded(_by_verdict(made, paths)))


def _by_verdict(claim: MadeClaim, paths: Sequence[str]) -> Table:
    """Return a table with a row for each verdict on a claim and the beliefs that reached it."""
    paths_by_verdict: dict[str, list[str]] = {}
    for path in paths:
        taken = _verdict(claim, path).replace("yes", "taken up").replace("no (", "not taken up (")
        paths_by_verdict.setdefault(taken, []).append(path)
    table = Table(box=None, show_header=False, padding=(0, 0, 0, 2))
    for verdict in sorted(paths_by_verdict):
        table.add_row(verdict, Text(", ".join(paths_by_verdict[verdict])))
    return table


def _paths_of_beliefs(claims: Sequence[MadeClaim], context: BeliefContext, depth: int) -> list[str]:
    """Return the paths of all beliefs below the world in which claims were made.

    Args:
        claims: The claims; not empty.
        context: The part that all simulators share.
        depth: Greatest number of names in a path below that world.

    Returns:
        The paths, shallow ones first.

    Raises:
        InputError: The depth is so great that memory has no room for the beliefs.
    """
    world = parse_path(claims[0].made_in, context.agents)
    return [path_text(path) for path in paths_with_room(context, world, depth)[1:]]


def _begun() -> Table:
    return Table("tick", "speaker", "claim", "", box=box.SIMPLE, title_justify="left")


def _cells(claim: MadeClaim, scenario: Scenario) -> list[str]:
    to = "" if claim.addressee is None else f" to {claim.addressee}"
    kind = "a lie" if claim.lie else "false" if claim.false else ""
    row = (str(claim.tick), f"{claim.speaker or 'a sign'}{to}", _words(claim.about, scenario), kind)
    return [printable(cell) for cell in row]


def _words(claim: Claim, scenario: Scenario) -> str:
    """Return a claim in words, with the scenario's names of containers and places."""
    if claim.kind is ClaimKind.POSITION:
        x, y, z = claim.place
        return claim.about(place_name((x, y, z), scenario.setting))
    return claim.about(container_name(claim.cell, scenario.setting))


def _verdict(claim: MadeClaim, path: str) -> str:
    condition = claim.condition(path)
    why = "" if condition is None else f" ({condition})"
    if claim.taken_up(path):
        return f"yes{why}"
    return f"no{why}" if why or claim.is_heard(path) else "not heard"
