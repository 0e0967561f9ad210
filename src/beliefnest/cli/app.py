"""The command line: commands, their options, and exit statuses."""

import errno
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Argument, Option
from typer.core import TyperGroup

from beliefnest.cli.options import (
    CaptureOptions,
    ExportOptions,
    ItemsOptions,
    Json,
    MethodsFormat,
    ParticipantsOptions,
    PlayOptions,
    PowerOptions,
    RunOptions,
    SearchItemsOptions,
    ServeOptions,
    ShowOptions,
    StatsOptions,
    StudyOptions,
    SuiteOptions,
    with_options,
)
from beliefnest.cli.terminal_text import printable
from beliefnest.errors import BeliefNestError, InputError
from beliefnest.importing import installed, installed_entries, load
from beliefnest.version import VERSION
from beliefnest.world.shell_limits import low_limits
from beliefnest.world.texts import is_well_formed

_INTERRUPTED = 130
_LONGEST_MESSAGE = 388
"""Greatest number of characters of a message, so that its line has at most 400."""
_END = 100
"""Number of characters of the end of a longer message that are shown."""

_BAD_USAGE = 2
_NO_ROOM = 3
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
# Click's ClickException. Typer may use its own copy of click and exports only subclasses of it.
# The bases of BadParameter are UsageError and then ClickException.
_UsageFault: Any = typer.BadParameter.__mro__[2]

_PLAY = "Play"
_READ = "Read results"
_WRITE = "Write files"
_HERE = "See what is here"


_INSTALLED = "beliefnest.commands"
"""Group of entry points by name of a command: functions with the annotations of Typer."""


class _InPanels(TyperGroup):
    """Commands whose list in the help is grouped, as plain text; also those of other packages."""

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return the command of a name, or else that of an installed package."""
        own = super().get_command(ctx, cmd_name)
        entry = None if own is not None else installed(_INSTALLED, cmd_name)
        if entry is None:
            return own
        alone = typer.Typer(rich_markup_mode=None, add_completion=False)
        alone.command(cmd_name)(load(entry, "command"))
        return typer.main.get_command(alone)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write a section for each panel, in the order of its first command."""
        commands: Mapping[str, Any] = self.commands
        limit = formatter.width - 6 - max(map(len, commands))
        for panel in dict.fromkeys(each.rich_help_panel for each in commands.values()):
            with formatter.section(panel or "Other commands"):
                formatter.write_dl(
                    [
                        (name, command.get_short_help_str(limit))
                        for name, command in commands.items()
                        if command.rich_help_panel == panel
                    ]
                )
        if others := installed_entries(_INSTALLED):
            with formatter.section("Of other packages"):
                formatter.write_dl([(each.name, each.module) for each in others])


app = typer.Typer(
    name="beliefnest",
    cls=_InPanels,
    help="Nested belief simulators for embodied agents, in a Minecraft world.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def run_command_line(arguments: Sequence[str]) -> int:
    """Run a command and return its exit status.

    Errors, and warnings of this package, are printed as one line each on stderr.
    """
    try:
        status = _run_command(arguments)
        sys.stdout.flush()
    except (KeyboardInterrupt, typer.Abort):
        status = _INTERRUPTED
    except (_UsageFault, BeliefNestError, OSError, MemoryError, RuntimeError) as error:
        failure = _told(error)
        if failure is None:
            raise
        return _fail(*failure)
    if status == _INTERRUPTED:
        # Newer versions of typer turn the interrupt into this status without a message. A library
        # of NumPy interrupts the process if it cannot start its threads.
        limits = low_limits()
        return _fail("interrupted", _INTERRUPTED) if limits is None else _fail(limits, _NO_ROOM)
    return status if isinstance(status, int) else 0


def _told(error: Exception) -> tuple[str, int] | None:
    """Return message and exit status for an error; None: it is a fault of this program."""
    match error:
        case BeliefNestError():
            return str(error), error.exit_status
        case OSError():
            return _system_fault(error), _BAD_USAGE
        case MemoryError() | RuntimeError():
            limits = low_limits()
            what = str(error) or type(error).__name__
            return None if limits is None else (f"{limits} ({what})", _NO_ROOM)
    context = getattr(error, "ctx", None)
    asked = "beliefnest" if context is None else context.command_path
    return f"{error.format_message()} (see {asked} --help)", _BAD_USAGE  # type: ignore[attr-defined] # a usage fault


def _run_command(arguments: Sequence[str]) -> Any:
    for argument in arguments:
        if "\0" in argument or not is_well_formed(argument):
            raise InputError(
                f"the argument {argument!a} is no text; leave out NUL and half characters"
            )
    return _all_commands().main(
        list(arguments) or ["--help"], prog_name="beliefnest", standalone_mode=False
    )


@cache
def _all_commands() -> Any:
    """Return the command that holds all others; reading their signatures takes 15 ms."""
    return typer.main.get_command(app)


def _system_fault(error: OSError) -> str:
    """Return a message for an error of the operating system, with what to do."""
    where = "" if error.filename is None else f"{error.filename}: "
    what = error.strerror or str(error) or type(error).__name__
    if error.errno in _FULL:
        return (
            f"{where}{what}; free some space or give another folder, and run the same command "
            "again: it continues with what is already there"
        )
    return f"{where}{what}; check the path and its permissions"


def _print_version(asked: bool) -> None:
    if asked:
        print(f"beliefnest {VERSION}")  # noqa: T201
        raise typer.Exit


def _fail(message: str, status: int) -> int:
    line = printable(" ".join(message.split()))
    if len(line) > _LONGEST_MESSAGE:
        # What to do stands at the end.
        begin = line[: _LONGEST_MESSAGE - _END - 5].rpartition(" ")[0]
        line = f"{begin} ... {line[-_END:].partition(' ')[2]}"
    print(f"beliefnest: {line}", file=sys.stderr)  # noqa: T201
    return status


@app.callback()
def common(
    version: Annotated[
        bool, Option("--version", help="Print the version.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """Read the options that belong to no command."""


@app.command(rich_help_panel=_PLAY)
@with_options(RunOptions)
def run(options: RunOptions) -> int:
    """Play a scenario, track the beliefs, ask the model, and judge the results."""
    from contextlib import nullcontext

    from beliefnest.world.seeds import checked_seed
    from beliefnest.worlds.minecraft import launching

    checked_seed(options.seed, "--seed")
    # A folder may have all results already; then no world is needed.
    begun = options.out is not None and options.out.exists()
    with nullcontext() if begun else launching.ahead(options.full_world, options.seed) as launch:
        from beliefnest.cli.run import run_scenarios

        return run_scenarios(options, launch)


@app.command(rich_help_panel=_READ)
@with_options(ShowOptions)
def show(options: ShowOptions) -> None:
    """Show the state of a simulator in a recorded run."""
    if options.html is not None:
        from beliefnest.cli.page import write_page

        write_page(options, options.html)
    if options.html is None or options.figures or options.gif or options.json:
        from beliefnest.cli.show import show_run

        show_run(options)


@app.command(rich_help_panel=_READ)
@with_options(ServeOptions)
def serve(options: ServeOptions) -> None:
    """Show a run in the browser, live while it is being recorded."""
    from beliefnest.cli.serve import serve

    serve(options)


@app.command(rich_help_panel=_READ)
def branches(
    run: Annotated[Path, Argument(help="Run folder or run file.")], json: Json = False
) -> None:
    """Show the branches of a recorded run, each below the branch it was forked from."""
    from beliefnest.cli.branches import show_branches

    show_branches(run, as_json=json)


@app.command(rich_help_panel=_READ)
def prompt(
    run: Annotated[Path, Argument(help="Run folder, or the folder of one condition in it.")],
    path: Annotated[str, Option(help="Belief path to render.")],
    template: Annotated[
        Path | None,
        Option(help="File, or name of a template of the run or a built-in one; default: paper."),
    ] = None,
    var: Annotated[
        list[str] | None, Option(help="Variable as NAME=TEXT, such as task=TEXT; repeatable.")
    ] = None,
) -> None:
    """Render a prompt template from a belief of a recorded run."""
    from beliefnest.cli.show import print_prompt

    print_prompt(run, path, template, var or [])


@app.command(rich_help_panel=_WRITE)
def template(
    name: Annotated[
        str | None, Argument(help="Built-in template; without it, the names of all.")
    ] = None,
) -> None:
    """Print a built-in prompt template, to copy and change it."""
    from beliefnest.cli.listing import print_template

    print_template(name)


@app.command(rich_help_panel=_WRITE)
def new(name: Annotated[str, Argument(help="Name of the scenario and of its file.")]) -> None:
    """Write a commented scenario to start from."""
    from beliefnest.cli.new import write_starter

    write_starter(name)


@app.command(rich_help_panel=_WRITE)
@with_options(CaptureOptions)
def capture(options: CaptureOptions) -> None:
    """Write a place on a server, or in a file, as a scenario."""
    from beliefnest.cli.capture import write_capture

    write_capture(options)


@app.command(rich_help_panel=_PLAY)
def replay(
    run: Annotated[Path, Argument(help="Folder of a run or a study, or a run file.")],
    json: Json = False,
) -> int:
    """Run the recorded programs again; print the first tick and field that differ, if any."""
    from beliefnest.cli.replay import replay_runs

    return replay_runs(run, as_json=json)


@app.command(rich_help_panel=_WRITE)
@with_options(ExportOptions)
def export(options: ExportOptions) -> None:
    """Write a run as tables that other programs can read."""
    from beliefnest.cli.exchange import export_run

    export_run(options)


@app.command("import", rich_help_panel=_WRITE)
def import_(
    trace: Annotated[Path, Argument(help="JSONL trace of another program.")],
    out: Annotated[Path, Option(help="Run file to write; it must not exist.")],
) -> None:
    """Make a run file from a trace, so that you can read beliefs from it."""
    from beliefnest.cli.exchange import import_run

    import_run(trace, out)


@app.command("list", rich_help_panel=_HERE)
def list_installed(json: Json = False) -> None:
    """List scenarios, tasks, suites, templates, worlds and models."""
    from beliefnest.cli.listing import print_installed

    group = _all_commands()
    assert isinstance(group, typer.core.TyperGroup)
    print_installed([*group.commands], as_json=json)


@app.command(rich_help_panel=_PLAY)
@with_options(SuiteOptions)
def suite(options: SuiteOptions) -> int:
    """Answer a file of questions from nests; compare with its answers, or with people."""
    from beliefnest.suites import AUDIT

    if options.name == AUDIT:
        from beliefnest.cli.audit import run_audit

        return run_audit(options)
    from beliefnest.cli.suite import run_suite

    return run_suite(options)


@app.command(rich_help_panel=_PLAY)
@with_options(StudyOptions)
def study(options: StudyOptions) -> int:
    """Play many variations of scenarios with several models; print accuracies with intervals."""
    from beliefnest.cli.study import run_study

    return run_study(options)


@app.command(rich_help_panel=_PLAY)
@with_options(ItemsOptions)
def items(options: ItemsOptions) -> int:
    """Write the questions of a study as items of a benchmark; report how balanced they are."""
    from beliefnest.cli.items import run_items

    return run_items(options)


@app.command("search-items", rich_help_panel=_PLAY)
@with_options(SearchItemsOptions)
def search_items(options: SearchItemsOptions) -> None:
    """Search variations of a study that a model fails, and test what makes them hard."""
    from beliefnest.cli.search_items import run_search

    run_search(options)


@app.command(rich_help_panel=_PLAY)
@with_options(ParticipantsOptions)
def participants(options: ParticipantsOptions) -> None:
    """Write a page on which people answer a study's questions; read their answers back."""
    from beliefnest.cli.participants import run_participants

    run_participants(options)


@app.command(rich_help_panel=_READ)
@with_options(StatsOptions)
def stats(options: StatsOptions) -> int:
    """Print accuracies, paired differences and regressions of a study, clustered by variation."""
    from beliefnest.cli.stats import run_stats

    return run_stats(options)


@app.command(rich_help_panel=_READ)
@with_options(PowerOptions)
def power(options: PowerOptions) -> int:
    """Simulate how wide intervals are, and which differences are found, with more variations."""
    from beliefnest.cli.stats import run_power

    return run_power(options)


@app.command(rich_help_panel=_PLAY)
@with_options(PlayOptions)
def play(options: PlayOptions) -> int:
    """Let agents act on their own beliefs, round after round; say if they reach the goal."""
    if options.baselines:
        from beliefnest.cli.baselines import run_baselines

        return run_baselines(options)
    from beliefnest.cli.play import play_task

    return play_task(options)


@app.command(rich_help_panel=_WRITE)
def bundle(
    results: Annotated[Path, Argument(help="Folder of a study or a run.")],
    out: Annotated[
        Path | None, Option("--out", "-o", help="ZIP file to write; default: the folder's name.")
    ] = None,
    runs: Annotated[
        bool, Option("--runs", help="Include recorded run files, which are large.")
    ] = False,
) -> None:
    """Write a supplement: everything to read a study or run, and to reproduce it without models."""
    from beliefnest.cli.bundle import write_bundle

    write_bundle(results, out, runs=runs)


@app.command(rich_help_panel=_READ)
def methods(
    results: Annotated[Path, Argument(help="Folder of a study or a run.")],
    form: MethodsFormat = "markdown",
) -> None:
    """Print the paragraph for a methods section, from recorded facts."""
    from beliefnest.cli.bundle import print_methods

    print_methods(results, form)


@app.command(rich_help_panel=_PLAY)
def reproduce(
    supplement: Annotated[
        Path | None,
        Argument(
            help="Supplement (ZIP file or folder), or folder of a study or run, to play again "
            "without any model; default: the paper's experiments."
        ),
    ] = None,
    copies: Annotated[
        int | None,
        Option(help="Mirrored, turned and renamed copies of each experiment; default: 4.", min=0),
    ] = None,
    jobs: Annotated[int, Option(help="Cells to play in parallel.", min=1)] = 1,
    page: Annotated[Path | None, Option(help="Write the table to this Markdown file.")] = None,
    trust: Annotated[
        bool,
        Option(
            "--trust",
            help="Run the Python code of a supplement's policies and judging functions. Without "
            "it the command lists this code and stops.",
        ),
    ] = False,
    json: Json = False,
) -> int:
    """Play a supplement again and compare all rows; or the paper's experiments and its claims."""
    if supplement is not None:
        if copies is not None or page is not None:
            raise InputError("--copies and --page are for the paper's experiments; leave them out")
        from beliefnest.cli.supplement import reproduce_supplement

        return reproduce_supplement(supplement, jobs, trust=trust, as_json=json)
    from beliefnest.cli.reproduce import run_reproduction

    return run_reproduction(4 if copies is None else copies, jobs, page, as_json=json)


@app.command(rich_help_panel=_HERE)
def doctor(
    server: Annotated[
        str | None, Argument(help="Server to check as well, as minecraft://HOST:PORT.")
    ] = None,
    warm: Annotated[
        bool, Option("--warm", help="Compile all kernels now, so that the first run is fast.")
    ] = False,
    json: Json = False,
) -> int:
    """Check Node, the bundle, a world and a model; say what to do if a check fails."""
    from beliefnest.cli.doctor import examine

    return examine(server, as_json=json, warm=warm)


@app.command(rich_help_panel=_HERE)
def bench(
    names: Annotated[
        list[str] | None, Argument(help="Names of benches; default: all except minecraft.")
    ] = None,
    curves: Annotated[
        Path | None,
        Option(
            help="With growth: measure curves over the box, agents, depth, ticks and branches "
            "instead; write them into this folder as SVG and CSV."
        ),
    ] = None,
    json: Json = False,
) -> int:
    """Run benchmarks; print medians and ratios beside their targets."""
    from beliefnest_benchmarks.command import draw_curves, run_benches

    if curves is not None:
        return draw_curves(tuple(names or ()), curves, as_json=json)
    return run_benches(tuple(names or ()), as_json=json)
