"""The commands, their options, and what the process ends with."""

import errno
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from beliefnest.cli.text import printable
from beliefnest.errors import BeliefNestError, InputError
from beliefnest.version import VERSION
from beliefnest.world.texts import is_well_formed

__all__ = ["app", "run_command_line"]

_INTERRUPTED = 130
_BAD_USAGE = 2
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
# Click's ClickException. Typer may have its own copy of click and exports only what derives
# from it: BadParameter, then UsageError, then this.
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
    """Run a command; every fault becomes one line on stderr and an exit status."""
    try:
        status = _run_command(arguments)
    except _UsageFault as error:
        context = getattr(error, "ctx", None)
        asked = "beliefnest" if context is None else context.command_path
        return _fail(f"{error.format_message()} (see {asked} --help)", _BAD_USAGE)
    except BeliefNestError as error:
        return _fail(str(error), error.exit_status)
    except BrokenPipeError:
        # Whoever read our output has left; there is nobody to tell.
        sys.stderr.close()
        return 0
    except OSError as error:
        return _fail(_system_fault(error), _BAD_USAGE)
    except (KeyboardInterrupt, typer.Abort):
        status = _INTERRUPTED
    if status == _INTERRUPTED:
        # Newer versions of typer turn the interrupt into this status themselves, silently.
        return _fail("interrupted", _INTERRUPTED)
    return status if isinstance(status, int) else 0


def _run_command(arguments: Sequence[str]) -> Any:
    for argument in arguments:
        if "\0" in argument or not is_well_formed(argument):
            raise InputError(f"the argument {argument!a} is no text; give whole characters")
    return typer.main.get_command(app).main(
        list(arguments) or ["--help"], prog_name="beliefnest", standalone_mode=False
    )


def _system_fault(error: OSError) -> str:
    """What the operating system refused, where, and what to do."""
    where = "" if error.filename is None else f"{error.filename}: "
    what = error.strerror or str(error) or type(error).__name__
    if error.errno in _FULL:
        return (
            f"{where}{what}; free some space or give another folder, and run the same command "
            "again: what was kept before stays"
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
    """What every command shares."""


@app.command()
def run(
    scenario: Annotated[str, typer.Argument(help="A built-in name, or a scenario file.")],
    condition: Annotated[
        list[int] | None, typer.Option(help="Run only this one; can be repeated.")
    ] = None,
    world: Annotated[
        str, typer.Option(help="Where it plays: embedded, scripted, minecraft://HOST:PORT.")
    ] = "embedded",
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace what stands in a server's box meanwhile.")
    ] = False,
    realtime: Annotated[
        bool, typer.Option("--realtime", help="Play in real time, so that people can join.")
    ] = False,
    listen: Annotated[
        str | None,
        typer.Option(help="Where they do: a port, or HOST:PORT; 25565 of this machine if none."),
    ] = None,
    embody: Annotated[
        list[str] | None,
        typer.Option(help="Let people visit this belief, till you press Enter; can be repeated."),
    ] = None,
    model: Annotated[
        str, typer.Option(help="Who answers: offline, PROVIDER:MODEL, replay: or scripted:FILE.")
    ] = "offline",
    models: Annotated[
        str | None, typer.Option(help="Several models, with commas, in place of --model.")
    ] = None,
    repeat: Annotated[int, typer.Option(help="Runs of each condition with each model.")] = 1,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for what is recorded; an interrupted run goes on in it."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Drives every random number; repeats count up.")] = 0,
    cache: Annotated[
        Cache, typer.Option(help="Use kept answers of providers' models, only keep, or neither.")
    ] = "read",
    answers: Annotated[
        Path | None, typer.Option(help="Folder of kept answers; OUT/answers if none.")
    ] = None,
    max_tokens: Annotated[
        int,
        typer.Option(
            help="Tokens the run may use in all; by default those of free models are left out.",
            min=1,
        ),
    ] = 1_000_000,
    max_cost: Annotated[
        float, typer.Option(help="US dollars the run may cost in all.", min=0)
    ] = 5.0,
    temperature: Annotated[float, typer.Option(help="0 for the likeliest answer.")] = 0.0,
    attempts: Annotated[
        int,
        typer.Option(help="Answers asked for at most; one without a working program is sent back."),
    ] = 3,
    claims_from: Annotated[
        str | None,
        typer.Option(help="A model that reads what is said for claims; nobody if none."),
    ] = None,
    json: Json = False,
) -> int:
    """Play a scenario, follow the beliefs, ask the model, and say whether all is as expected."""
    from beliefnest.bodies.address import overwriting
    from beliefnest.bodies.worlds import world_name
    from beliefnest.cli.run import ModelOptions, RunOptions, run_scenarios
    from beliefnest.llm.budget import RunLimits

    limits = RunLimits(max_tokens, max_cost)
    named = world_name(world, realtime=realtime, listen=_listening(listen))
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
        )
    )


@app.command()
def show(
    run: Annotated[Path, typer.Argument(help="A run folder, or one condition's in it.")],
    path: Annotated[str, typer.Option(help="Belief path; / is the real world.")] = "/",
    tick: Annotated[int | None, typer.Option(help="Tick; the latest if not given.")] = None,
    branch: Annotated[str | None, typer.Option(help="Branch of the simulator.")] = None,
    png: Annotated[Path | None, typer.Option(help="Draw it, as a PNG file.")] = None,
    svg: Annotated[Path | None, typer.Option(help="Draw it, as an SVG file.")] = None,
    pdf: Annotated[Path | None, typer.Option(help="Draw it, as a PDF file.")] = None,
    gif: Annotated[
        Path | None, typer.Option(help="Draw it up to that tick, as a moving GIF or WebP file.")
    ] = None,
    against: Annotated[str, typer.Option(help="Drawn as false is what differs from this.")] = "/",
    height: Annotated[
        int | None, typer.Option(help="The storey to draw, y of what stands on its floor.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option(help="Write all of the run as one page that needs no network.")
    ] = None,
    claims: Annotated[
        bool, typer.Option("--claims", help="Show what was claimed, and who took it up, alone.")
    ] = False,
    depth: Annotated[
        int, typer.Option(help="How deep all beliefs in that page, or of claims, go.")
    ] = 2,
    json: Json = False,
) -> None:
    """Show what a simulator of a recorded run held."""
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
        typer.Argument(help="A run folder, or a scenario, which is run.", metavar="RUN|SCENARIO"),
    ],
    port: Annotated[int | None, typer.Option(help="Port; 8642 if it is free.")] = None,
    address: Annotated[
        str, typer.Option(help="Where to listen; on any but this machine a token is asked for.")
    ] = "127.0.0.1",
    condition: Annotated[
        list[int] | None, typer.Option(help="Of a scenario, only this one; can be repeated.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Of a scenario, its run folder.")] = None,
    depth: Annotated[int, typer.Option(help="How deep beliefs are shown from the start.")] = 2,
) -> None:
    """Show a run in the browser, live while it goes on."""
    from beliefnest.cli.serve import ServeOptions, serve

    serve(ServeOptions(what, port, address, tuple(condition or ()), out, depth))


@app.command()
def branches(
    run: Annotated[Path, typer.Argument(help="A run folder, or a run file.")], json: Json = False
) -> None:
    """Show the branches of a recorded run, each below the one it was forked from."""
    from beliefnest.cli.branches import show_branches

    show_branches(run, as_json=json)


@app.command()
def prompt(
    run: Annotated[Path, typer.Argument(help="A run folder, or one condition's in it.")],
    path: Annotated[str, typer.Option(help="The belief to render.")],
    template: Annotated[
        Path | None,
        typer.Option(help="A file, one the run keeps, default, or paper (the one without this)."),
    ] = None,
    var: Annotated[list[str] | None, typer.Option(help="A variable, as task=TEXT.")] = None,
) -> None:
    """Render a prompt template from a belief of a recorded run."""
    from beliefnest.cli.show import print_prompt

    print_prompt(run, path, template, var or [])


@app.command()
def new(
    name: Annotated[str, typer.Argument(help="Name of the scenario, and of its file.")],
) -> None:
    """Write a commented scenario to start from."""
    from beliefnest.cli.new import write_starter

    write_starter(name)


@app.command()
def capture(
    where: Annotated[str, typer.Argument(help="minecraft://HOST:PORT, or a .schem or .nbt file.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Scenario file to write.")],
    box: Annotated[
        tuple[int, int, int, int, int, int] | None,
        typer.Option(help="Of a server: two corners of the place, X1 Y1 Z1 X2 Y2 Z2."),
    ] = None,
    at: Annotated[
        tuple[int, int, int] | None,
        typer.Option(help="Of a file: where its lowest corner comes to lie; 0 0 0 if not given."),
    ] = None,
    name: Annotated[
        str | None, typer.Option(help="Name of the scenario; the file's if none.")
    ] = None,
) -> None:
    """Write a place of a server, or of a file, as a scenario."""
    from beliefnest.cli.capture import CaptureOptions, write_capture

    write_capture(CaptureOptions(where, out, box, at, name))


@app.command()
def replay(
    run: Annotated[Path, typer.Argument(help="The folder of a run or of a study, or a run file.")],
    json: Json = False,
) -> int:
    """Run the recorded programs again; say which tick and field differ, if any."""
    from beliefnest.cli.replay import replay_runs

    return replay_runs(run, as_json=json)


@app.command()
def export(
    run: Annotated[Path, typer.Argument(help="A run folder, or a run file.")],
    out: Annotated[Path, typer.Option(help="Folder to write; it must not exist.")],
    format: Annotated[str, typer.Option(help="jsonl, or parquet.")] = "jsonl",
    path: Annotated[
        list[str] | None, typer.Option(help="A belief to write over time; can be repeated.")
    ] = None,
) -> None:
    """Write a run as tables that other programs read."""
    from beliefnest.cli.exchange import ExportOptions, export_run

    export_run(ExportOptions(run, format, tuple(path or ()), out))


@app.command("import")
def import_(
    trace: Annotated[Path, typer.Argument(help="A JSONL trace of another program.")],
    out: Annotated[Path, typer.Option(help="Run file to make; it must not exist.")],
) -> None:
    """Make a run of a trace, so that beliefs can be read from it."""
    from beliefnest.cli.exchange import import_run

    import_run(trace, out)


@app.command("list")
def list_installed(json: Json = False) -> None:
    """List scenarios, tasks, suites, templates, worlds and models."""
    from beliefnest.cli.listing import print_installed

    print_installed(as_json=json)


@app.command()
def suite(
    name: Annotated[str, typer.Argument(help="Name of the suite: hi-tom, stories.")],
    data: Annotated[Path, typer.Option(help="File of stories, questions and answers.")],
    world: Annotated[str, typer.Option(help="Where they play.")] = "scripted",
    rows: Annotated[str | None, typer.Option(help="Rows to answer, as in 1-20,35.")] = None,
    limit: Annotated[int | None, typer.Option(help="Play no more stories than this.")] = None,
    seed: Annotated[int, typer.Option(help="Drives every random number.")] = 0,
    claims_from: Annotated[
        str | None, typer.Option(help="Model that reads claims out of what is told.")
    ] = None,
    json: Json = False,
) -> int:
    """Answer a file of questions about stories from nests; say how many answers are right."""
    from beliefnest.cli.suite import SuiteOptions, run_suite

    return run_suite(SuiteOptions(name, data, world, rows, limit, seed, json, claims_from))


@app.command()
def study(
    study: Annotated[Path, typer.Argument(help="YAML file that says what is combined.")],
    out: Annotated[
        Path | None, typer.Option(help="Its folder; an interrupted or larger study goes on in it.")
    ] = None,
    jobs: Annotated[int, typer.Option(help="Cells that are played at the same time.", min=1)] = 2,
    backend: Annotated[
        str, typer.Option(help="loky: processes here; dask or ray: a cluster.")
    ] = "loky",
    shard: Annotated[
        str | None, typer.Option(help="Only this part of it, as 1/4; others run elsewhere.")
    ] = None,
    merge: Annotated[
        list[Path] | None,
        typer.Option(help="Folder of a shard to take over first; can be repeated."),
    ] = None,
    record: Annotated[bool, typer.Option(help="Record the runs, into OUT/runs.")] = False,
    claims_from: Annotated[
        str | None, typer.Option(help="Model that reads claims out of what is said.")
    ] = None,
    by: Annotated[
        list[str] | None,
        typer.Option(metavar="COLUMN", help="Sum rows up by this column; can be repeated."),
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
def play(
    task: Annotated[
        str | None, typer.Argument(help="A built-in task or scenario, or a file of either.")
    ] = None,
    agent: Annotated[
        list[str] | None,
        typer.Option(help="Who plays an agent, as anne=search:1; can be repeated."),
    ] = None,
    set: Annotated[
        list[str] | None,
        typer.Option(help="Size of a task, as agents=3, or a scenario's parameter; repeatable."),
    ] = None,
    condition: Annotated[int | None, typer.Option(help="A scenario's condition.")] = None,
    rounds: Annotated[int | None, typer.Option(help="Most rounds.", min=0)] = None,
    seed: Annotated[int, typer.Option(help="Which instance; drives every random number.")] = 0,
    world: Annotated[str, typer.Option(help="Where it plays.")] = "scripted",
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for what is recorded; an interrupted episode goes on in it."),
    ] = None,
    max_ticks: Annotated[int | None, typer.Option(help="Most ticks.", min=1)] = None,
    max_tokens: Annotated[int | None, typer.Option(help="Most tokens of models.", min=1)] = None,
    max_cost: Annotated[float | None, typer.Option(help="Most US dollars.", min=0)] = None,
    patience: Annotated[
        float | None, typer.Option(help="Seconds after which a policy has lost its round.")
    ] = None,
    measure_help: Annotated[
        bool, typer.Option("--measure-help", help="Tell what help was needed, given, superfluous.")
    ] = False,
    listen: Annotated[
        str | None, typer.Option(help="Where people join: PORT of this machine, or HOST:PORT.")
    ] = None,
    baselines: Annotated[
        bool, typer.Option("--baselines", help="Play the task, or all, by all baselines instead.")
    ] = False,
    seeds: Annotated[int, typer.Option(help="Instances of each task, for --baselines.")] = 50,
    jobs: Annotated[int, typer.Option(help="Episodes at once, for --baselines.", min=1)] = 1,
    page: Annotated[
        Path | None, typer.Option(help="Markdown file to write, for --baselines.")
    ] = None,
    json: Json = False,
) -> int:
    """Let agents act round after round, each by what it believes; say whether they succeed."""
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
        as_json=json,
    )
    return play_task(options)


def _listening(listen: str | None) -> str | None:
    """Where people join; a port alone is one of this machine."""
    return f"127.0.0.1:{listen}" if listen is not None and listen.isdecimal() else listen


@app.command()
def reproduce(
    copies: Annotated[
        int, typer.Option(help="Mirrored, turned and renamed copies of each experiment.", min=0)
    ] = 4,
    jobs: Annotated[int, typer.Option(help="Played at the same time.", min=1)] = 1,
    page: Annotated[
        Path | None, typer.Option(help="Write the table to this Markdown file.")
    ] = None,
    json: Json = False,
) -> int:
    """Play the paper's experiments, as written and varied; print the results beside its claims."""
    from beliefnest.cli.reproduce import run_reproduction

    return run_reproduction(copies, jobs, page, as_json=json)


@app.command()
def doctor(
    server: Annotated[
        str | None, typer.Argument(help="A server to check, too: minecraft://HOST:PORT.")
    ] = None,
    warm: Annotated[
        bool, typer.Option("--warm", help="Compile now what the first belief would wait for.")
    ] = False,
    json: Json = False,
) -> int:
    """Check Node, the bundle, a world and a model; say what to do about what fails."""
    from beliefnest.cli.doctor import examine

    return examine(server, as_json=json, warm=warm)


@app.command()
def bench(
    names: Annotated[
        list[str] | None, typer.Argument(help="Benches; none: all but minecraft.")
    ] = None,
    json: Json = False,
) -> int:
    """Measure, and print medians and ratios beside the figures to reach."""
    from beliefnest.cli.bench.command import run_benches

    return run_benches(tuple(names or ()), as_json=json)
