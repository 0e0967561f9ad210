"""The command line: commands, their options, and exit statuses."""

import errno
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from beliefnest.cli.terminal_text import printable
from beliefnest.errors import BeliefNestError, InputError
from beliefnest.version import VERSION
from beliefnest.world.texts import is_well_formed

__all__ = ["app", "run_command_line"]

_INTERRUPTED = 130
_BAD_USAGE = 2
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
# Click's ClickException. Typer may use its own copy of click and exports only subclasses of it.
# The bases of BadParameter are UsageError and then ClickException.
_UsageFault: Any = typer.BadParameter.__mro__[2]

app = typer.Typer(
    name="beliefnest",
    help="Nested belief simulators for embodied agents, in a Minecraft world.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Cache = Literal["read", "write", "off"]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]


def run_command_line(arguments: Sequence[str]) -> int:
    """Run a command and return its exit status; print every error as one line on stderr."""
    try:
        status = _run_command(arguments)
    except _UsageFault as error:
        context = getattr(error, "ctx", None)
        asked = "beliefnest" if context is None else context.command_path
        return _fail(f"{error.format_message()} (see {asked} --help)", _BAD_USAGE)
    except BeliefNestError as error:
        return _fail(str(error), error.exit_status)
    except BrokenPipeError:
        # The reader of our output has closed the pipe: nobody reads a message.
        sys.stderr.close()
        return 0
    except OSError as error:
        return _fail(_system_fault(error), _BAD_USAGE)
    except (KeyboardInterrupt, typer.Abort):
        status = _INTERRUPTED
    if status == _INTERRUPTED:
        # Newer versions of typer turn the interrupt into this status without a message.
        return _fail("interrupted", _INTERRUPTED)
    return status if isinstance(status, int) else 0


def _run_command(arguments: Sequence[str]) -> Any:
    for argument in arguments:
        if "\0" in argument or not is_well_formed(argument):
            raise InputError(
                f"the argument {argument!a} is no text; leave out NUL and half characters"
            )
    return typer.main.get_command(app).main(
        list(arguments) or ["--help"], prog_name="beliefnest", standalone_mode=False
    )


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
    print(f"beliefnest: {line}", file=sys.stderr)  # noqa: T201
    return status


@app.callback()
def common(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    """Read the options that belong to no command."""


@app.command()
def run(
    scenario: Annotated[str, typer.Argument(help="A built-in name, or a scenario file.")],
    condition: Annotated[
        list[int] | None, typer.Option(help="Run only this condition; can be repeated.")
    ] = None,
    world: Annotated[
        str, typer.Option(help="World: embedded, scripted, or minecraft://HOST:PORT.")
    ] = "embedded",
    overwrite: Annotated[
        bool,
        typer.Option(
            "--overwrite", help="Replace what stands in the box on the server for the run."
        ),
    ] = False,
    realtime: Annotated[
        bool, typer.Option("--realtime", help="Play in real time, so that people can join.")
    ] = False,
    listen: Annotated[
        str | None,
        typer.Option(help="Address for people to join: PORT or HOST:PORT; default: 25565."),
    ] = None,
    embody: Annotated[
        list[str] | None,
        typer.Option(help="Let people visit this belief until you press Enter; can be repeated."),
    ] = None,
    model: Annotated[
        str, typer.Option(help="Model: offline, PROVIDER:MODEL, replay:FILE or scripted:FILE.")
    ] = "offline",
    models: Annotated[
        str | None, typer.Option(help="Several models, separated by commas, instead of --model.")
    ] = None,
    repeat: Annotated[int, typer.Option(help="Runs of each condition with each model.")] = 1,
    out: Annotated[
        Path | None,
        typer.Option(help="Run folder to write; an interrupted run continues in it."),
    ] = None,
    seed: Annotated[
        int, typer.Option(help="Seed of all random numbers; each further repeat adds 1.")
    ] = 0,
    cache: Annotated[
        Cache, typer.Option(help="Cached answers: use and store them, only store them, or neither.")
    ] = "read",
    answers: Annotated[
        Path | None, typer.Option(help="Folder of cached answers; default OUT/answers.")
    ] = None,
    max_tokens: Annotated[
        int,
        typer.Option(
            help="Token limit of the whole run; the default does not count free models.",
            min=1,
        ),
    ] = 1_000_000,
    max_cost: Annotated[
        float, typer.Option(help="Cost limit of the whole run in US dollars.", min=0)
    ] = 5.0,
    temperature: Annotated[
        float, typer.Option(help="Sampling temperature; 0: the likeliest answer.")
    ] = 0.0,
    attempts: Annotated[
        int,
        typer.Option(
            help="Most answers for one probe; a failed program is sent back to the model."
        ),
    ] = 3,
    claims_from: Annotated[
        str | None,
        typer.Option(help="Model that extracts claims from utterances; default: none."),
    ] = None,
    json: Json = False,
) -> int:
    """Play a scenario, track the beliefs, ask the model, and judge the results."""
    from contextlib import nullcontext

    from beliefnest.cli.ahead import ahead
    from beliefnest.worlds.names import world_name
    from beliefnest.worlds.servers.address import overwriting

    named = world_name(world, realtime=realtime, listen=_listening(listen))
    # A folder may have all results already; then no world is needed.
    begun = out is not None and out.exists()
    with nullcontext() if begun else ahead(named, seed) as launch:
        from beliefnest.cli.run import ModelOptions, RunOptions, run_scenarios
        from beliefnest.llm.budget import RunLimits

        limits = RunLimits(max_tokens, max_cost)
        return run_scenarios(
            RunOptions(
                scenario=scenario,
                conditions=tuple(condition or ()),
                world=overwriting(named) if overwrite else named,
                models=tuple(models.split(",")) if models is not None else (model,),
                repeat=repeat,
                out=out,
                seed=seed,
                as_json=json,
                asking=ModelOptions(cache, answers, limits, attempts, temperature),
                claims_from=claims_from,
                embody=tuple(embody or ()),
            ),
            launch,
        )


@app.command()
def show(
    run: Annotated[Path, typer.Argument(help="Run folder, or the folder of one condition in it.")],
    path: Annotated[str, typer.Option(help="Belief path; / is the real world.")] = "/",
    tick: Annotated[int | None, typer.Option(help="Tick; default: the latest.")] = None,
    branch: Annotated[str | None, typer.Option(help="Branch of the simulator.")] = None,
    png: Annotated[Path | None, typer.Option(help="Draw the state to a PNG file.")] = None,
    svg: Annotated[Path | None, typer.Option(help="Draw the state to an SVG file.")] = None,
    pdf: Annotated[Path | None, typer.Option(help="Draw the state to a PDF file.")] = None,
    gif: Annotated[
        Path | None, typer.Option(help="Draw all states up to the tick to a GIF or WebP animation.")
    ] = None,
    against: Annotated[
        str, typer.Option(help="Belief path to compare with; differences are drawn as false.")
    ] = "/",
    height: Annotated[
        int | None, typer.Option(help="Storey to draw: height y of things on its floor.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option(help="Write the whole run as one page that needs no network.")
    ] = None,
    claims: Annotated[
        bool, typer.Option("--claims", help="Show only claims, and the beliefs that took them up.")
    ] = False,
    depth: Annotated[
        int, typer.Option(help="Depth of the beliefs on the page of --html or in --claims.")
    ] = 2,
    json: Json = False,
) -> None:
    """Show the state of a simulator in a recorded run."""
    from beliefnest.cli.page import PageOptions, write_page
    from beliefnest.cli.show import ShowOptions, show_run

    forms = {"png": png, "svg": svg, "pdf": pdf}
    figures = {form: file for form, file in forms.items() if file is not None}
    page = None if html is None else PageOptions(run, html, path, tick, branch, depth)
    if page is not None:
        write_page(page)
    if page is None or figures or gif or json:
        deep = depth if claims else None
        show_run(ShowOptions(run, path, tick, branch, json, figures, gif, against, height, deep))


@app.command()
def serve(
    what: Annotated[
        str,
        typer.Argument(help="Run folder, or a scenario to run.", metavar="RUN|SCENARIO"),
    ],
    port: Annotated[int | None, typer.Option(help="Port; default: 8642, or a free one.")] = None,
    address: Annotated[
        str, typer.Option(help="Address to listen on; other machines need the token in the URL.")
    ] = "127.0.0.1",
    condition: Annotated[
        list[int] | None,
        typer.Option(help="Run only this condition of the scenario; can be repeated."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Run folder for the scenario.")] = None,
    depth: Annotated[int, typer.Option(help="Depth of the beliefs that are shown first.")] = 2,
) -> None:
    """Show a run in the browser, live while it is being recorded."""
    from beliefnest.cli.serve import ServeOptions, serve

    serve(ServeOptions(what, port, address, tuple(condition or ()), out, depth))


@app.command()
def branches(
    run: Annotated[Path, typer.Argument(help="Run folder or run file.")], json: Json = False
) -> None:
    """Show the branches of a recorded run, each below the branch it was forked from."""
    from beliefnest.cli.branches import show_branches

    show_branches(run, as_json=json)


@app.command()
def prompt(
    run: Annotated[Path, typer.Argument(help="Run folder, or the folder of one condition in it.")],
    path: Annotated[str, typer.Option(help="Belief path to render.")],
    template: Annotated[
        Path | None,
        typer.Option(
            help="File, or name of a template of the run or a built-in one; default: paper."
        ),
    ] = None,
    var: Annotated[
        list[str] | None, typer.Option(help="Variable as NAME=TEXT, such as task=TEXT; repeatable.")
    ] = None,
) -> None:
    """Render a prompt template from a belief of a recorded run."""
    from beliefnest.cli.show import print_prompt

    print_prompt(run, path, template, var or [])


@app.command()
def template(
    name: Annotated[
        str | None, typer.Argument(help="Built-in template; without it, the names of all.")
    ] = None,
) -> None:
    """Print a built-in prompt template, to copy and change it."""
    from beliefnest.cli.listing import print_template

    print_template(name)


@app.command()
def new(
    name: Annotated[str, typer.Argument(help="Name of the scenario and of its file.")],
) -> None:
    """Write a commented scenario to start from."""
    from beliefnest.cli.new import write_starter

    write_starter(name)


@app.command()
def capture(
    where: Annotated[
        str, typer.Argument(help="Server minecraft://HOST:PORT, or a .schem or .nbt file.")
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Scenario file to write.")],
    box: Annotated[
        tuple[int, int, int, int, int, int] | None,
        typer.Option(help="For a server: two corners of the place, X1 Y1 Z1 X2 Y2 Z2."),
    ] = None,
    at: Annotated[
        tuple[int, int, int] | None,
        typer.Option(help="For a file: position of its lowest corner, X Y Z; default 0 0 0."),
    ] = None,
    name: Annotated[
        str | None, typer.Option(help="Name of the scenario; default: the name of its file.")
    ] = None,
) -> None:
    """Write a place on a server, or in a file, as a scenario."""
    from beliefnest.cli.capture import CaptureOptions, write_capture

    write_capture(CaptureOptions(where, out, box, at, name))


@app.command()
def replay(
    run: Annotated[Path, typer.Argument(help="Folder of a run or a study, or a run file.")],
    json: Json = False,
) -> int:
    """Run the recorded programs again; print the first tick and field that differ, if any."""
    from beliefnest.cli.replay import replay_runs

    return replay_runs(run, as_json=json)


@app.command()
def export(
    run: Annotated[Path, typer.Argument(help="Run folder or run file.")],
    out: Annotated[Path, typer.Option(help="Folder to write; it must not exist.")],
    format: Annotated[str, typer.Option(help="Format of the tables: jsonl or parquet.")] = "jsonl",
    path: Annotated[
        list[str] | None,
        typer.Option(help="Belief path whose states are written over time; can be repeated."),
    ] = None,
) -> None:
    """Write a run as tables that other programs can read."""
    from beliefnest.cli.exchange import ExportOptions, export_run

    export_run(ExportOptions(run, format, tuple(path or ()), out))


@app.command("import")
def import_(
    trace: Annotated[Path, typer.Argument(help="JSONL trace of another program.")],
    out: Annotated[Path, typer.Option(help="Run file to write; it must not exist.")],
) -> None:
    """Make a run file from a trace, so that you can read beliefs from it."""
    from beliefnest.cli.exchange import import_run

    import_run(trace, out)


@app.command("list")
def list_installed(json: Json = False) -> None:
    """List scenarios, tasks, suites, templates, worlds and models."""
    from beliefnest.cli.listing import print_installed

    print_installed(as_json=json)


@app.command()
def suite(
    name: Annotated[str, typer.Argument(help="Name of the suite: hi-tom, stories, food-trucks.")],
    data: Annotated[Path, typer.Option(help="File of stories and questions, or of films.")],
    world: Annotated[str, typer.Option(help="World in which the stories play.")] = "scripted",
    rows: Annotated[str | None, typer.Option(help="Rows to answer, as in 1-20,35.")] = None,
    limit: Annotated[int | None, typer.Option(help="Most stories or films to play.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of all random numbers.")] = 0,
    claims_from: Annotated[
        str | None, typer.Option(help="Model that extracts claims from utterances.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for the figure and tables of films.")
    ] = None,
    json: Json = False,
) -> int:
    """Answer a file of questions from nests; compare with its answers, or with people."""
    from beliefnest.cli.suite import SuiteOptions, run_suite

    options = SuiteOptions(name, data, world, rows, limit, seed, json, claims_from, out)
    return run_suite(options)


@app.command()
def study(
    study: Annotated[Path, typer.Argument(help="YAML file of the study.")],
    out: Annotated[
        Path | None,
        typer.Option(help="Study folder; an interrupted or enlarged study continues in it."),
    ] = None,
    jobs: Annotated[int, typer.Option(help="Cells to play in parallel.", min=1)] = 2,
    backend: Annotated[
        str, typer.Option(help="loky: processes on this machine; dask or ray: a cluster.")
    ] = "loky",
    shard: Annotated[
        str | None, typer.Option(help="Play only this part of the study, as I/N, such as 1/4.")
    ] = None,
    merge: Annotated[
        list[Path] | None,
        typer.Option(help="Folder of a shard whose cells are copied first; can be repeated."),
    ] = None,
    record: Annotated[bool, typer.Option(help="Record the runs in OUT/runs.")] = False,
    claims_from: Annotated[
        str | None, typer.Option(help="Model that extracts claims from utterances.")
    ] = None,
    by: Annotated[
        list[str] | None,
        typer.Option(metavar="COLUMN", help="Group rows by this column; can be repeated."),
    ] = None,
    json: Json = False,
) -> int:
    """Play many variations of scenarios with several models; print accuracies with intervals."""
    from beliefnest.cli.study import StudyOptions, run_study

    merged = tuple(merge or ())
    return run_study(
        StudyOptions(
            study, out, jobs, backend, shard, merged, record, json, claims_from, tuple(by or ())
        )
    )


@app.command()
def stats(
    study: Annotated[Path, typer.Argument(help="Folder of a study.")],
    by: Annotated[
        list[str] | None,
        typer.Option(metavar="COLUMN", help="Group rows by this column; can be repeated."),
    ] = None,
    between: Annotated[
        list[str] | None,
        typer.Option(metavar="COLUMN", help="Compare its values in pairs; can be repeated."),
    ] = None,
    effect: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COLUMN",
            help="Fit a regression on this column (A:B: interaction); can be repeated.",
        ),
    ] = None,
    kind: Annotated[
        Literal["gee", "mixed"], typer.Option(help="Kind of regression; variations are groups.")
    ] = "gee",
    family: Annotated[
        Literal["binomial", "gaussian"],
        typer.Option(help="binomial: log odds; gaussian: differences of accuracies."),
    ] = "binomial",
    positions: Annotated[
        bool, typer.Option("--positions", help="Count chosen options by their position.")
    ] = False,
    json: Json = False,
) -> int:
    """Print accuracies, paired differences and regressions of a study, clustered by variation."""
    from beliefnest.cli.stats import StatsOptions, run_stats

    by, between, effect = by or [], between or [], effect or []
    options = StatsOptions(
        study, tuple(by), tuple(between), tuple(effect), kind, family, positions, json
    )
    return run_stats(options)


@app.command()
def power(
    study: Annotated[
        Path, typer.Argument(help="YAML file of a study to plan, or folder of one to draw from.")
    ],
    size: Annotated[
        list[int] | None,
        typer.Option(help="Number of variations; can be repeated.", min=1),
    ] = None,
    accuracy: Annotated[float | None, typer.Option(help="Assumed accuracy; default: 0.8.")] = None,
    difference: Annotated[
        float | None, typer.Option(help="Assumed difference of accuracy; default: 0.1.")
    ] = None,
    correlation: Annotated[
        float | None,
        typer.Option(help="Assumed correlation of rows of one variation; default: 0.3."),
    ] = None,
    between: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="Column whose values are compared.")
    ] = None,
    simulations: Annotated[int, typer.Option(help="Simulated studies of each size.", min=1)] = 400,
    seed: Annotated[int, typer.Option(help="Seed of the simulations.", min=0)] = 0,
    json: Json = False,
) -> int:
    """Simulate how wide intervals are, and which differences are found, with more variations."""
    from beliefnest.cli.stats import PowerOptions, run_power

    assumed = {"accuracy": accuracy, "difference": difference, "correlation": correlation}
    return run_power(
        PowerOptions(study, tuple(size or ()), assumed, between, simulations, seed, json)
    )


@app.command()
def play(
    task: Annotated[
        str | None, typer.Argument(help="Built-in task or scenario, or a file of either.")
    ] = None,
    agent: Annotated[
        list[str] | None,
        typer.Option(help="Policy of an agent, such as anne=search:1; can be repeated."),
    ] = None,
    set: Annotated[
        list[str] | None,
        typer.Option(help="Size of a task, or parameter of a scenario, as agents=3; repeatable."),
    ] = None,
    condition: Annotated[int | None, typer.Option(help="Condition of the scenario.")] = None,
    rounds: Annotated[int | None, typer.Option(help="Limit of rounds.", min=0)] = None,
    seed: Annotated[
        int, typer.Option(help="Instance of the task, and seed of all random numbers.")
    ] = 0,
    world: Annotated[str, typer.Option(help="World in which the episode plays.")] = "scripted",
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for the run; an interrupted episode continues in it."),
    ] = None,
    max_ticks: Annotated[int | None, typer.Option(help="Limit of ticks.", min=1)] = None,
    max_tokens: Annotated[int | None, typer.Option(help="Limit of model tokens.", min=1)] = None,
    max_cost: Annotated[float | None, typer.Option(help="Limit of US dollars.", min=0)] = None,
    patience: Annotated[
        float | None, typer.Option(help="Seconds after which a policy loses its round.")
    ] = None,
    measure_help: Annotated[
        bool, typer.Option("--measure-help", help="Print the help needed, given and superfluous.")
    ] = False,
    listen: Annotated[
        str | None,
        typer.Option(help="Address for people to join: PORT of this machine, or HOST:PORT."),
    ] = None,
    export: Annotated[
        Path | None, typer.Option(help="Write the task to this scenario file; do not play it.")
    ] = None,
    baselines: Annotated[
        bool, typer.Option("--baselines", help="Play the task, or all tasks, with all baselines.")
    ] = False,
    seeds: Annotated[int, typer.Option(help="Instances of each task, for --baselines.")] = 50,
    jobs: Annotated[int, typer.Option(help="Episodes in parallel, for --baselines.", min=1)] = 1,
    page: Annotated[
        Path | None, typer.Option(help="Markdown file to write, for --baselines.")
    ] = None,
    json: Json = False,
) -> int:
    """Let agents act on their own beliefs, round after round; say if they reach the goal."""
    if baselines:
        from beliefnest.cli.baselines import BaselineOptions, run_baselines

        return run_baselines(BaselineOptions(task, seeds, jobs, out, page, json))
    from beliefnest.cli.play import PlayOptions, play_task
    from beliefnest.episodes.episode import Budget

    options = PlayOptions(
        task=task,
        condition=condition,
        agents=tuple(agent or ()),
        parameters=tuple(set or ()),
        rounds=rounds,
        seed=seed,
        world=world,
        out=out,
        budget=Budget(max_ticks, max_tokens, max_cost),
        patience_s=patience,
        measures_help=measure_help,
        listen=_listening(listen),
        export=export,
        as_json=json,
    )
    return play_task(options)


def _listening(listen: str | None) -> str | None:
    """Return the address at which people join; a port alone is on this machine."""
    return f"127.0.0.1:{listen}" if listen is not None and listen.isdecimal() else listen


@app.command()
def reproduce(
    copies: Annotated[
        int, typer.Option(help="Mirrored, turned and renamed copies of each experiment.", min=0)
    ] = 4,
    jobs: Annotated[int, typer.Option(help="Cells to play in parallel.", min=1)] = 1,
    page: Annotated[
        Path | None, typer.Option(help="Write the table to this Markdown file.")
    ] = None,
    json: Json = False,
) -> int:
    """Play the paper's experiments and variations; print the results beside the paper's claims."""
    from beliefnest.cli.reproduce import run_reproduction

    return run_reproduction(copies, jobs, page, as_json=json)


@app.command()
def doctor(
    server: Annotated[
        str | None, typer.Argument(help="Server to check as well, as minecraft://HOST:PORT.")
    ] = None,
    warm: Annotated[
        bool, typer.Option("--warm", help="Compile all kernels now, so that the first run is fast.")
    ] = False,
    json: Json = False,
) -> int:
    """Check Node, the bundle, a world and a model; say what to do if a check fails."""
    from beliefnest.cli.doctor import examine

    return examine(server, as_json=json, warm=warm)


@app.command()
def bench(
    names: Annotated[
        list[str] | None, typer.Argument(help="Names of benches; default: all except minecraft.")
    ] = None,
    json: Json = False,
) -> int:
    """Run benchmarks; print medians and ratios beside their targets."""
    from beliefnest_benchmarks.command import run_benches

    return run_benches(tuple(names or ()), as_json=json)
