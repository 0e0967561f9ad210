"""Options of commands: each option with its type, its default and its text in `--help`.

Commands get their options as one of these objects; `with_options` tells typer of the fields.
"""

import inspect
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_type_hints

import msgspec
from typer import Argument, Option

from beliefnest.errors import InputError
from beliefnest.skills.manifests import SkillDetail

if TYPE_CHECKING:  # Models take long to import.
    from beliefnest.llm.model_settings import ModelSettings

Options = TypeVar("Options")
Status = TypeVar("Status")

Cache = Literal["read", "write", "off"]
MethodsFormat = Annotated[
    Literal["markdown", "latex"], Option("--format", help="Format of the paragraph.")
]
Json = Annotated[bool, Option("--json", help="Print one JSON object.")]


def with_options(
    kind: type[Options],
) -> Callable[[Callable[[Options], Status]], Callable[..., Status]]:
    """Return a decorator that replaces a command's argument by an argument for each option."""

    def decorated(command: Callable[[Options], Status]) -> Callable[..., Status]:
        @wraps(command)
        def called(**values: object) -> Status:
            return command(kind(**values))

        # Typer reads a command's options from its signature.
        called.__dict__["__signature__"] = inspect.signature(kind)
        called.__annotations__ = get_type_hints(kind, include_extras=True)
        return called

    return decorated


def joining_address(listen: str | None) -> str | None:
    """Return the address at which people join; a port alone is on this machine."""
    return f"127.0.0.1:{listen}" if listen is not None and listen.isdecimal() else listen


class ModelOptions(msgspec.Struct, frozen=True, kw_only=True):
    """Options of requests to models; None: the default, or what a file says."""

    answer_seconds: Annotated[
        float | None,
        Option(help="Longest silence in an answer; each token starts the count again."),
    ] = None
    first_token_seconds: Annotated[
        float | None, Option(help="Longest wait for the first token of an answer.")
    ] = None
    max_output_tokens: Annotated[
        int | None, Option(help="Greatest length of an answer; default: the provider's own.")
    ] = None
    system: Annotated[
        Path | None, Option(help="File with a system message in place of the built-in one.")
    ] = None
    skills: Annotated[
        SkillDetail | None,
        Option(help="Detail of the list of skills in the system message; default: full."),
    ] = None

    retry_unread: Annotated[
        int | None, Option(help="Ask again so often after an answer that cannot be read.")
    ] = None

    @property
    def requests(self) -> dict[str, Any]:
        """Return the given settings of requests by name, apart from `system`."""
        values = {
            "answer_seconds": self.answer_seconds,
            "first_token_seconds": self.first_token_seconds,
            "max_output_tokens": self.max_output_tokens,
            "skills": self.skills,
            "retry_unread": self.retry_unread,
        }
        return {name: value for name, value in values.items() if value is not None}


class RunOptions(ModelOptions, frozen=True):
    """Options of `beliefnest run`."""

    scenario: Annotated[str, Argument(help="A built-in name, or a scenario file.")]
    condition: Annotated[
        list[int] | None, Option(help="Run only this condition; can be repeated.")
    ] = None
    world: Annotated[str, Option(help="World: embedded, scripted, or minecraft://HOST:PORT.")] = (
        "embedded"
    )
    overwrite: Annotated[
        bool,
        Option("--overwrite", help="Replace what stands in the box on the server for the run."),
    ] = False
    realtime: Annotated[
        bool, Option("--realtime", help="Play in real time, so that people can join.")
    ] = False
    listen: Annotated[
        str | None, Option(help="Address for people to join: PORT or HOST:PORT; default: 25565.")
    ] = None
    embody: Annotated[
        list[str] | None,
        Option(help="Let people visit this belief until you press Enter; can be repeated."),
    ] = None
    model: Annotated[
        str, Option(help="Model: offline, PROVIDER:MODEL, replay:FILE or scripted:FILE.")
    ] = "offline"
    models: Annotated[
        str | None, Option(help="Several models, separated by commas, instead of --model.")
    ] = None
    repeat: Annotated[int, Option(help="Runs of each condition with each model.")] = 1
    out: Annotated[
        Path | None, Option(help="Run folder to write; an interrupted run continues in it.")
    ] = None
    seed: Annotated[
        int, Option(help="Seed of all random numbers; each further repeat adds 1.", min=0)
    ] = 0
    cache: Annotated[
        Cache, Option(help="Cached answers: use and store them, only store them, or neither.")
    ] = "read"
    answers: Annotated[
        Path | None, Option(help="Folder of cached answers; default OUT/answers.")
    ] = None
    max_tokens: Annotated[
        int,
        Option(help="Token limit of the whole run; the default does not count free models.", min=1),
    ] = 1_000_000
    max_cost: Annotated[float, Option(help="Cost limit of the whole run in US dollars.", min=0)] = (
        5.0
    )
    temperature: Annotated[float, Option(help="Sampling temperature; 0: the likeliest answer.")] = (
        0.0
    )
    attempts: Annotated[
        int, Option(help="Most answers for one probe; a failed program is sent back to the model.")
    ] = 3
    claims_from: Annotated[
        str | None, Option(help="Model that extracts claims from utterances; default: none.")
    ] = None
    json: Json = False

    @property
    def named_models(self) -> tuple[str, ...]:
        """Return the names of the models that play."""
        return (self.model,) if self.models is None else tuple(self.models.split(","))

    @property
    def asked_models(self) -> tuple[str, ...]:
        """Return the names of all models that the run may ask, each once."""
        more = () if self.claims_from is None else (self.claims_from,)
        return tuple(dict.fromkeys((*self.named_models, *more)))

    @property
    def full_world(self) -> str:
        """Return the name of the world with the address to join and the permission to build."""
        from beliefnest.worlds.names import world_name
        from beliefnest.worlds.servers.address import overwriting

        listen = joining_address(self.listen)
        named = world_name(self.world, realtime=self.realtime, listen=listen)
        return overwriting(named) if self.overwrite else named

    @property
    def settings(self) -> dict[str, object]:
        """Return the settings that affect results, for the record."""
        return {
            "conditions": list(dict.fromkeys(self.condition or ())),
            "world": self.full_world,
            "models": list(self.named_models),
            "repeat": self.repeat,
            "seed": self.seed,
            "attempts": self.attempts,
            "temperature": self.temperature,
            **({} if self.claims_from is None else {"claims_from": self.claims_from}),
            **self.model_settings.chosen,
        }

    @property
    def model_settings(self) -> "ModelSettings":
        """Return the settings of requests to models; raise InputError if one is not valid."""
        from beliefnest.llm.model_settings import ModelSettings

        return ModelSettings.of_file(self.system, **self.requests)


class ShowOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest show`."""

    run: Annotated[Path, Argument(help="Run folder, or the folder of one condition in it.")]
    path: Annotated[str, Option(help="Belief path; / is the real world.")] = "/"
    tick: Annotated[int | None, Option(help="Tick; default: the latest.")] = None
    branch: Annotated[str | None, Option(help="Branch of the simulator.")] = None
    png: Annotated[Path | None, Option(help="Draw the state to a PNG file.")] = None
    svg: Annotated[Path | None, Option(help="Draw the state to an SVG file.")] = None
    pdf: Annotated[Path | None, Option(help="Draw the state to a PDF file.")] = None
    gif: Annotated[
        Path | None, Option(help="Draw all states up to the tick to a GIF or WebP animation.")
    ] = None
    against: Annotated[
        str, Option(help="Belief path to compare with; differences are drawn as false.")
    ] = "/"
    height: Annotated[
        int | None, Option(help="Storey to draw: height y of things on its floor.")
    ] = None
    html: Annotated[
        Path | None, Option(help="Write the whole run as one page that needs no network.")
    ] = None
    claims: Annotated[
        bool, Option("--claims", help="Show only claims, and the beliefs that took them up.")
    ] = False
    depth: Annotated[
        int, Option(help="Depth of the beliefs on the page of --html or in --claims.")
    ] = 2
    json: Json = False

    @property
    def figures(self) -> Mapping[str, Path]:
        """Return the files of figures by format."""
        files = {"png": self.png, "svg": self.svg, "pdf": self.pdf}
        return {form: file for form, file in files.items() if file is not None}


class ServeOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest serve`."""

    what: Annotated[
        str, Argument(help="Run folder, or a scenario to run or edit.", metavar="RUN|SCENARIO")
    ]
    edit: Annotated[
        bool, Option("--edit", help="Edit the scenario file on its plan; it may be new.")
    ] = False
    port: Annotated[int | None, Option(help="Port; default: 8642, or a free one.")] = None
    address: Annotated[
        str, Option(help="Address to listen on; other machines need the token in the URL.")
    ] = "127.0.0.1"
    condition: Annotated[
        list[int] | None, Option(help="Run only this condition of the scenario; can be repeated.")
    ] = None
    out: Annotated[Path | None, Option(help="Run folder for the scenario.")] = None
    depth: Annotated[int, Option(help="Depth of the beliefs that are shown first.")] = 2


class CaptureOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest capture`."""

    where: Annotated[str, Argument(help="Server minecraft://HOST:PORT, or a .schem or .nbt file.")]
    out: Annotated[Path, Option("-o", "--out", help="Scenario file to write.")]
    box: Annotated[
        tuple[int, int, int, int, int, int] | None,
        Option(help="For a server: two corners of the place, X1 Y1 Z1 X2 Y2 Z2."),
    ] = None
    at: Annotated[
        tuple[int, int, int] | None,
        Option(help="For a file: position of its lowest corner, X Y Z; default 0 0 0."),
    ] = None
    unknown: Annotated[
        str,
        Option(
            help="For a file with blocks or items that this version of Minecraft lacks: refuse, or "
            "air, which replaces the blocks and leaves the items out."
        ),
    ] = "refuse"
    name: Annotated[
        str | None, Option(help="Name of the scenario; default: the name of its file.")
    ] = None


class ExportOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest export`."""

    run: Annotated[Path, Argument(help="Run folder or run file.")]
    out: Annotated[Path, Option(help="Folder to write; it must not exist.")]
    format: Annotated[str, Option(help="Format of the tables: jsonl or parquet.")] = "jsonl"
    path: Annotated[
        list[str] | None,
        Option(help="Belief path whose states are written over time; can be repeated."),
    ] = None


class SuiteOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest suite`."""

    name: Annotated[str, Argument(help="Suite: hi-tom, tomi, stories, food-trucks; or audit.")]
    file: Annotated[
        Path | None, Argument(help="The file, in place of --data.", show_default=False)
    ] = None
    data: Annotated[Path | None, Option(help="File of stories and questions, or of films.")] = None
    world: Annotated[str, Option(help="World in which the stories play.")] = "scripted"
    rows: Annotated[str | None, Option(help="Rows to answer, as in 1-20,35.")] = None
    limit: Annotated[int | None, Option(help="Most stories or films to play.")] = None
    seed: Annotated[int, Option(help="Seed of all random numbers.", min=0)] = 0
    claims_from: Annotated[
        str | None, Option(help="Model that extracts claims from utterances.")
    ] = None
    strict: Annotated[
        bool, Option("--strict", help="Stop at the first line that cannot be read.")
    ] = False
    out: Annotated[
        Path | None,
        Option(help="Folder of results; an interrupted or enlarged suite continues in it."),
    ] = None
    json: Json = False

    @property
    def path(self) -> Path:
        """Return the path of the file; raise InputError if there is none, or are two."""
        named = [each for each in (self.file, self.data) if each is not None]
        if len(named) != 1:
            raise InputError(f"{len(named)} files are given; give one: --data FILE")
        return named[0]


class StudyOptions(ModelOptions, frozen=True):
    """Options of `beliefnest study`."""

    study: Annotated[Path, Argument(help="YAML file of the study.")]
    out: Annotated[
        Path | None, Option(help="Study folder; an interrupted or enlarged study continues in it.")
    ] = None
    jobs: Annotated[int, Option(help="Cells to play in parallel.", min=1)] = 2
    backend: Annotated[
        str, Option(help="loky: processes on this machine; dask or ray: a cluster.")
    ] = "loky"
    shard: Annotated[
        str | None, Option(help="Play only this part of the study, as I/N, such as 1/4.")
    ] = None
    merge: Annotated[
        list[Path] | None,
        Option(help="Folder of a shard whose cells are copied first; can be repeated."),
    ] = None
    record: Annotated[bool, Option(help="Record the runs in OUT/runs.")] = False
    claims_from: Annotated[
        str | None, Option(help="Model that extracts claims from utterances.")
    ] = None
    by: Annotated[
        list[str] | None,
        Option(metavar="COLUMN", help="Group rows by this column; can be repeated."),
    ] = None
    json: Json = False


class ItemsOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest items`."""

    study: Annotated[Path, Argument(help="YAML file of the study; to ask models, folder of a set.")]
    out: Annotated[
        Path | None, Option("--out", "-o", help="Folder of the set; of results, with --models.")
    ] = None
    report: Annotated[bool, Option("--report", help="Print balance, and what shortcuts score.")] = (
        False
    )
    verify: Annotated[
        bool, Option("--verify", help="Make the set again, and compare every byte.")
    ] = False
    parquet: Annotated[bool, Option("--parquet", help="Write the items as Parquet, too.")] = False
    check_embedded: Annotated[
        int, Option(min=0, metavar="N", help="Play N scenes in the embedded world, too.")
    ] = 0
    held_out: Annotated[
        float | None, Option(metavar="SHARE", help="Share of seeds whose items are held out.")
    ] = None
    set_version: Annotated[
        str | None, Option(metavar="TEXT", help="Version of the set (default 1.0.0).")
    ] = None
    changes: Annotated[str | None, Option(metavar="TEXT", help="Changes in this version.")] = None
    functional: Annotated[
        bool, Option("--functional", help="Certify which order the episodes of tasks need.")
    ] = False
    model: Annotated[
        str | None, Option(help="Model to ask and to let play, with --functional.")
    ] = None
    models: Annotated[str | None, Option(help="Models that answer a set, separated by commas.")] = (
        None
    )
    people: Annotated[
        list[Path] | None,
        Option(help="File or folder of participants' answers, to stand beside --models."),
    ] = None
    gap: Annotated[
        list[Path] | None,
        Option(metavar="DIR", help="Folder of --functional with one of --models."),
    ] = None
    verify_results: Annotated[
        Path | None, Option(metavar="FILE", help="Results of models on a set to check.")
    ] = None
    max_tokens: Annotated[
        int | None, Option(min=1, help="Token limit of --models; default: none.")
    ] = None
    max_cost: Annotated[float, Option(min=0, help="Cost limit of --models in US dollars.")] = 5.0
    jobs: Annotated[int, Option(min=1, help="Processes, with --functional or --models.")] = 2
    json: Json = False

    @property
    def folder(self) -> Path:
        """Return the folder to write or verify; raise InputError if none is named."""
        if self.out is None:
            raise InputError("name the folder of the set, or of the results, with -o")
        return self.out


class SearchItemsOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest search-items`."""

    study: Annotated[Path, Argument(help="YAML file of the study.")]
    out: Annotated[
        Path, Option("--out", "-o", help="Folder; an interrupted search continues in it.")
    ]
    model: Annotated[str, Option(help="Model to search weaknesses of.")]
    budget: Annotated[int, Option(help="Most questions; half of them search, the others test.")] = (
        400
    )
    transfer: Annotated[
        str | None, Option(metavar="MODEL", help="Second model, which is tested as well.")
    ] = None
    seed: Annotated[int, Option(help="Seed of all draws.", min=0)] = 0
    max_cost: Annotated[
        float | None, Option(help="Cost limit in US dollars; default: that of the study.", min=0)
    ] = None
    jobs: Annotated[int, Option(min=1, help="Questions to ask in parallel.")] = 1
    json: Json = False


class ParticipantsOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest participants`."""

    study: Annotated[Path, Argument(help="YAML file of the study.")]
    out: Annotated[
        Path, Option("--out", "-o", help="Folder of the page; with --read, folder of the study.")
    ]
    show: Annotated[Literal["film", "story", "both"], Option(help="What people are shown.")] = (
        "both"
    )
    instructions: Annotated[
        Path | None, Option(help="Text file with instructions or consent for people.")
    ] = None
    ending: Annotated[
        Path | None, Option(help="Text file for the end of a session, such as a code.")
    ] = None
    title: Annotated[str, Option(help="Title of the browser's tab.")] = "Study"
    post: Annotated[
        str | None, Option(metavar="URL", help="Send the answers to this address as JSON.")
    ] = None
    read: Annotated[
        list[Path] | None,
        Option(
            metavar="FILE",
            help="Read answers, a file or a folder of files, into the study; can be repeated.",
        ),
    ] = None
    name: Annotated[str, Option(help="Name of the people in the column model.")] = "people"
    pseudonyms: Annotated[
        bool, Option("--pseudonyms", help="With --read: p1, p2 ... in place of ids.")
    ] = False
    exclude: Annotated[
        Path | None,
        Option(
            metavar="FILE",
            help="With --read: CSV file of participants who do not count: participant, reason.",
        ),
    ] = None
    json: Json = False


class StatsOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest stats`."""

    study: Annotated[Path, Argument(help="Folder of a study.")]
    by: Annotated[
        list[str] | None,
        Option(
            metavar="COLUMN",
            help="Group rows by this column, for regressions too; can be repeated.",
        ),
    ] = None
    where: Annotated[
        str | None,
        Option(
            metavar="CONDITION",
            help="Use only rows that hold this, such as 'order == 2 and condition != \"3\"'.",
        ),
    ] = None
    between: Annotated[
        list[str] | None,
        Option(metavar="COLUMN", help="Compare its values in pairs; can be repeated."),
    ] = None
    effect: Annotated[
        list[str] | None,
        Option(
            metavar="COLUMN",
            help="Fit a regression on this column (A:B: interaction); can be repeated.",
        ),
    ] = None
    kind: Annotated[
        Literal["gee", "mixed"], Option(help="Kind of regression; variations are groups.")
    ] = "gee"
    family: Annotated[
        Literal["binomial", "gaussian"],
        Option(help="binomial: log odds; gaussian: differences of accuracies."),
    ] = "binomial"
    positions: Annotated[
        bool, Option("--positions", help="Count chosen options by their position.")
    ] = False
    figure: Annotated[
        Path | None,
        Option(
            help="Draw the accuracies to this .svg, .pdf or .png file: the first --by along the "
            "axis, the others by colour."
        ),
    ] = None
    json: Json = False


class PowerOptions(msgspec.Struct, frozen=True):
    """Options of `beliefnest power`."""

    study: Annotated[
        Path, Argument(help="YAML file of a study to plan, or folder of one to draw from.")
    ]
    size: Annotated[
        list[int] | None, Option(help="Number of variations; can be repeated.", min=1)
    ] = None
    accuracy: Annotated[float | None, Option(help="Assumed accuracy; default: 0.8.")] = None
    difference: Annotated[
        float | None, Option(help="Assumed difference of accuracy; default: 0.1.")
    ] = None
    correlation: Annotated[
        float | None, Option(help="Assumed correlation of rows of one variation; default: 0.3.")
    ] = None
    between: Annotated[
        str | None, Option(metavar="COLUMN", help="Column whose values are compared.")
    ] = None
    simulations: Annotated[int, Option(help="Simulated studies of each size.", min=1)] = 400
    seed: Annotated[int, Option(help="Seed of the simulations.", min=0)] = 0
    json: Json = False


class PlayOptions(ModelOptions, frozen=True):
    """Options of `beliefnest play`."""

    task: Annotated[
        str | None, Argument(help="Built-in task or scenario, or a file of either.")
    ] = None
    agent: Annotated[
        list[str] | None, Option(help="Policy of an agent, such as anne=search:1; can be repeated.")
    ] = None
    set: Annotated[
        list[str] | None,
        Option(help="Size of a task, or parameter of a scenario, as agents=3; repeatable."),
    ] = None
    condition: Annotated[int | None, Option(help="Condition of the scenario.")] = None
    rounds: Annotated[int | None, Option(help="Limit of rounds.", min=0)] = None
    seed: Annotated[
        int, Option(help="Instance of the task, and seed of all random numbers.", min=0)
    ] = 0
    world: Annotated[str, Option(help="World in which the episode plays.")] = "scripted"
    out: Annotated[
        Path | None, Option(help="Folder for the run; an interrupted episode continues in it.")
    ] = None
    max_ticks: Annotated[int | None, Option(help="Limit of ticks.", min=1)] = None
    max_tokens: Annotated[int | None, Option(help="Limit of model tokens.", min=1)] = None
    max_cost: Annotated[float | None, Option(help="Limit of US dollars.", min=0)] = None
    patience: Annotated[
        float | None, Option(help="Seconds after which a policy loses its round.")
    ] = None
    measure_help: Annotated[
        bool, Option("--measure-help", help="Print the help needed, given and superfluous.")
    ] = False
    explain: Annotated[
        bool, Option("--explain", help="Print the courses that policies considered.")
    ] = False
    listen: Annotated[
        str | None, Option(help="Address for people to join: PORT of this machine, or HOST:PORT.")
    ] = None
    export: Annotated[
        Path | None, Option(help="Write the task to this scenario file; do not play it.")
    ] = None
    baselines: Annotated[
        bool, Option("--baselines", help="Play the task, or all tasks, with all baselines.")
    ] = False
    seeds: Annotated[int, Option(help="Instances of each task, for --baselines.")] = 50
    jobs: Annotated[int, Option(help="Episodes in parallel, for --baselines.", min=1)] = 1
    page: Annotated[Path | None, Option(help="Markdown file to write, for --baselines.")] = None
    json: Json = False
