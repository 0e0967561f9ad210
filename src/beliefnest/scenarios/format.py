"""The form of a scenario file: what may be written where.

These types are the single source of the published JSON schema (`docs/scenario.schema.json`)
and of the check of a file's form. Whether the content makes sense is checked in `build`.
"""

from typing import Annotated, Any, Literal

import msgspec

from beliefnest.scenarios.rules import EpisodeEntry
from beliefnest.world import values as world
from beliefnest.world.limits import FARTHEST

__all__ = [
    "LABELLED",
    "AgentEntry",
    "AnswersEntry",
    "BelievedSignEntry",
    "BlockEntry",
    "ContainerEntry",
    "DoubtEntry",
    "EquipmentEntry",
    "ExpectEntry",
    "ExpectationEntry",
    "GridEntry",
    "InferEntry",
    "InferredEntry",
    "InitialBeliefEntry",
    "LevelsEntry",
    "ParameterEntry",
    "PerceptionEntry",
    "ProbeEntry",
    "RadiusEntry",
    "ScenarioFile",
    "SignEntry",
    "StepEntry",
]


def _note(text: str) -> msgspec.Meta:
    return msgspec.Meta(description=text)


_WIDEST = 1_000
"""Radians either way."""
_LONGEST_TIMEOUT = 10_000_000
"""Ticks; about six days."""

_Whole = Annotated[int, msgspec.Meta(ge=-FARTHEST, le=FARTHEST)]
_Number = Annotated[float, msgspec.Meta(ge=-FARTHEST, le=FARTHEST)]
Position = tuple[_Whole, _Whole, _Whole]
Point = tuple[_Number, _Number, _Number]
_Angle = Annotated[float, msgspec.Meta(ge=-_WIDEST, le=_WIDEST)]
_ItemsField = Annotated[dict[str, int], _note("Item name to count.")]


class _Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Base of all parts of a scenario file: a key that is not listed is an error."""


class BlockEntry(_Entry, frozen=True):
    """Blocks of one kind; exactly one of `at`, `fill` and `walls`. Later entries win."""

    block: Annotated[str | None, _note("A block state: name or name[property=value,...].")]
    at: Annotated[Position | None, _note("One position.")] = None
    fill: Annotated[
        tuple[Position, Position] | None, _note("Two inclusive corners; all between them.")
    ] = None
    walls: Annotated[
        tuple[Position, Position] | None,
        _note("Two inclusive corners; the four upright sides of what lies between them."),
    ] = None


class ContainerEntry(_Entry, frozen=True):
    """A container, its block included."""

    at: Annotated[Position, _note("Where its block is.")]
    block: Annotated[str, _note("A block state of a container.")] = "chest"
    items: _ItemsField = {}
    label: Annotated[str, _note("What people call it, in tables and pictures.")] = ""
    looks: Annotated[str, _note("What it looks as if it held, in words; see the key `labels`.")] = (
        ""
    )


_SignText = Annotated[
    str,
    _note("What is written on its front: at most 4 lines of 45 characters, split by line breaks."),
]


class ClaimEntry(_Entry, frozen=True):
    """A claim: what a text states."""

    kind: Annotated[
        Literal["located", "absent", "position", "block"],
        _note("That an item is in a container, or not; where an agent is; which block is there."),
    ]
    place: Annotated[Point, _note("The container, the agent's feet, or the block's position.")]
    item: Annotated[str | None, _note("The item of `located` and `absent`.")] = None
    agent: Annotated[str | None, _note("The agent of `position`.")] = None
    state: Annotated[str | None, _note("The block of `block`: name[property=value,...].")] = None


class SignEntry(_Entry, frozen=True):
    """A sign, its block included, and what is written on it."""

    at: Annotated[Position, _note("Where its block is.")]
    text: _SignText = ""
    block: Annotated[str, _note("A block state of a sign.")] = "oak_sign"
    claims: Annotated[list[ClaimEntry], _note("What the text claims, for those who read it.")] = []


class BelievedSignEntry(_Entry, frozen=True):
    """A sign that is believed to be somewhere, and to say something."""

    at: Annotated[Position, _note("Its position.")]
    text: _SignText = ""
    block: Annotated[
        str | None, _note("A block state of a sign; null: that of the sign which stands there.")
    ] = None


class EquipmentEntry(_Entry, frozen=True):
    """What an agent wears or holds: slot to item."""

    head: Annotated[str | None, _note("A helmet, or another item that is worn there.")] = None
    chest: Annotated[str | None, _note("A chestplate.")] = None
    legs: Annotated[str | None, _note("Leggings.")] = None
    feet: Annotated[str | None, _note("Boots.")] = None
    main_hand: Annotated[str | None, _note("What it holds; mostly the right hand.")] = None
    off_hand: Annotated[str | None, _note("What it holds in the other hand.")] = None


class AgentEntry(_Entry, frozen=True):
    """An agent: a Mineflayer bot in a Minecraft world, or a person."""

    position: Annotated[world.Point, _note("Middle of the feet, in blocks.")]
    facing: Annotated[
        Literal["north", "east", "south", "west"] | Point | None,
        _note("A direction, or a point to look at; in place of yaw and pitch."),
    ] = None
    yaw: Annotated[_Angle | None, _note("Radians; 0 looks north (-z), pi/2 west (-x).")] = None
    pitch: Annotated[_Angle | None, _note("Radians, positive upwards.")] = None
    inventory: Annotated[
        dict[str, int],
        _note("Item name to count; what is worn or held counts in and need not be listed."),
    ] = {}
    equipment: Annotated[EquipmentEntry, _note("What it wears and holds.")] = EquipmentEntry()
    health: Annotated[float, msgspec.Meta(gt=0, le=20, description="Half hearts.")] = 20.0
    food: Annotated[float, msgspec.Meta(ge=0, le=20, description="Half drumsticks.")] = 20.0
    type: Annotated[
        Literal["bot", "human"],
        _note("Who acts: a bot by programs, or a person who joins by the agent's name."),
    ] = "bot"


class RadiusEntry(_Entry, frozen=True):
    """Hearing up to a distance."""

    radius: Annotated[float, msgspec.Meta(gt=0, le=FARTHEST, description="In blocks.")]


class PerceptionEntry(_Entry, frozen=True):
    """What agents can perceive; the same for all of them, at every depth."""

    max_visible_distance: Annotated[float | None, _note("In blocks; null: no limit.")] = 20.0
    field_of_view: Annotated[float, _note("Full angle of sight in degrees, up to 360.")] = 360.0
    hearing: Annotated[Literal["global", "sight"] | RadiusEntry, _note("Whom an agent hears.")] = (
        "global"
    )
    containers: Annotated[
        Literal["opaque", "transparent"], _note("Whether contents show from outside.")
    ] = "opaque"
    transparent_blocks: Annotated[list[str], _note("Further blocks to see through.")] = []
    negative_evidence: Annotated[
        bool, _note("Whether a place seen empty makes a pose believed there unknown.")
    ] = False
    testimony: Annotated[
        Literal["none", "accept", "informed"],
        _note(
            "How hearers take claims: none, all, or those of who may know better than one can see."
        ),
    ] = "none"
    grace: Annotated[
        int,
        msgspec.Meta(ge=0, description="Ticks out of sight after which a speaker may know better."),
    ] = 100
    sincere: Annotated[
        bool, _note("Whether speakers are taken to believe what is not believed of them.")
    ] = True
    speech_ticks: Annotated[
        int, msgspec.Meta(ge=0, le=1200, description="Ticks that it takes to say something.")
    ] = 0


class _BelievedContainerEntry(_Entry, frozen=True):
    """What a container is believed to hold."""

    at: Annotated[Position, _note("Its position.")]
    items: _ItemsField = {}
    complete: Annotated[bool, _note("Whether these are believed to be all.")] = True


class InitialBeliefEntry(_Entry, frozen=True):
    """What a belief holds before anything happens."""

    path: Annotated[
        str,
        _note("A belief path such as /observer/sally; /** at its end: that and all below it."),
    ]
    containers: Annotated[
        list[_BelievedContainerEntry], _note("What containers are believed to hold.")
    ] = []
    blocks: Annotated[list[BlockEntry], _note("Believed blocks; block null: unknown.")] = []
    signs: Annotated[list[BelievedSignEntry], _note("Believed signs.")] = []
    agents: Annotated[dict[str, Point], _note("Believed positions of the feet.")] = {}


class StepEntry(_Entry, frozen=True):
    """Programs that run together in the real world; `agent` and `program`, or `programs`."""

    label: Annotated[str, _note("What happens, for progress, messages and overrides.")] = ""
    agent: Annotated[str | None, _note("The agent of a single program.")] = None
    program: Annotated[str | None, _note("JavaScript, the body of an async function.")] = None
    programs: Annotated[dict[str, str], _note("Agent to program.")] = {}
    senses: Annotated[
        Literal["world", "percepts"] | None,
        _note("What programs read: everything, or what their agents perceive or remember."),
    ] = None
    timeout_ticks: Annotated[
        int,
        msgspec.Meta(
            gt=0,
            le=_LONGEST_TIMEOUT,
            description="Ticks of 50 ms after which the step has failed.",
        ),
    ] = 1200


class AnswersEntry(_Entry, frozen=True):
    """A question to the model, and its right answers."""

    question: Annotated[str, _note("What is asked.")]
    right: Annotated[
        str | list[str],
        _note("The right answer, or several; of words, what a right answer has in it."),
    ]
    options: Annotated[
        list[str], _note("What it chooses from, shuffled by the seed; else it answers in words.")
    ] = []
    wrong: Annotated[list[str], _note("What an answer in words may not have in it.")] = []
    reason: Annotated[bool, _note("Whether it is asked why; what it says is kept.")] = False


class ExpectationEntry(_Entry, frozen=True):
    """What a belief should hold in the end: a container, agent, sign, block, or what was heard."""

    path: Annotated[str, _note("The belief; / is the real world.")]
    label: Annotated[str, _note("A name for tables and overrides.")] = ""
    container: Annotated[Position | None, _note("A container that holds `items`.")] = None
    items: Annotated[dict[str, int] | None, _note("Exactly the items known to be in it.")] = None
    agent: Annotated[str | None, _note("An agent that stands at `position`.")] = None
    sign: Annotated[Position | None, _note("A sign that says `text`.")] = None
    text: Annotated[str | None, _note("Exactly what is written; null: that is not known.")] = None
    block: Annotated[Position | None, _note("A block that is `state`.")] = None
    state: Annotated[str | None, _note("A block state; null: it is not known.")] = None
    heard: Annotated[str | None, _note("Part of an utterance that is known of.")] = None
    not_heard: Annotated[str | None, _note("Part of no utterance that is known of.")] = None
    position: Annotated[Point | None, _note("Middle of the feet.")] = None
    within: Annotated[
        float,
        msgspec.Meta(
            gt=0, le=FARTHEST, description="Greatest distance from `position`, in blocks."
        ),
    ] = 2.0


class InferredEntry(_Entry, frozen=True):
    """What a posterior mean should be: above something, below something, or both."""

    above: Annotated[float | str | None, _note("A number, or a factor with a lower mean.")] = None
    below: Annotated[float | str | None, _note("A number, or a factor with a higher mean.")] = None


class ExpectEntry(_Entry, frozen=True):
    """What should come of a probe: at least one of these, all of them together."""

    opens: Annotated[Position | None, _note("The container that is opened first.")] = None
    arrives: Annotated[Point | None, _note("Where the agent stands in the end.")] = None
    intends: Annotated[
        Point | None,
        _note("The container or place that the program makes for, also if it never gets there."),
    ] = None
    within: Annotated[
        float,
        msgspec.Meta(gt=0, le=FARTHEST, description="Greatest distance from there, in blocks."),
    ] = 2.0
    takes: Annotated[
        dict[str, int] | None, _note("Items that are taken out of containers, and how many.")
    ] = None
    says: Annotated[str | None, _note("Part of what the agent says.")] = None
    answers: Annotated[
        AnswersEntry | list[AnswersEntry] | None, _note("What the model answers to questions.")
    ] = None
    believes: Annotated[
        ExpectationEntry | list[ExpectationEntry] | None,
        _note("What a belief holds once the program has ended."),
    ] = None
    inferred: Annotated[
        dict[str, InferredEntry] | None,
        _note("Factor, such as utility.K or credence.L, to what its posterior mean should be."),
    ] = None
    function: Annotated[
        Any,
        _note(
            "module:function, given the trial; it is imported and run, so trust who wrote it. "
            "In code, the function itself."
        ),
    ] = None


class _MindGoalEntry(_Entry, frozen=True):
    """What an agent may want to reach; exactly one of the keys."""

    at: Annotated[Position | None, _note("The cell in which to stand.")] = None
    block: Annotated[str | None, _note("Name of the block on which to stand.")] = None
    item: Annotated[str | None, _note("Name of the item to take.")] = None


class LevelsEntry(_Entry, frozen=True):
    """Utilities to consider: all values of a range."""

    range: Annotated[tuple[float, float], _note("Lowest and highest value.")]
    step: Annotated[float, msgspec.Meta(gt=0, description="Between values.")] = 1.0


class GridEntry(_Entry, frozen=True):
    """Initial credences to consider: a grid over the alternatives."""

    grid: Annotated[int, msgspec.Meta(ge=1, le=1000, description="Steps from 0 to 1.")]
    smoothing: Annotated[
        float, msgspec.Meta(ge=0, le=1, description="Weight of the uniform credence in each.")
    ] = 0.0


class _DoubtedBlockEntry(_Entry, frozen=True):
    """A block in an alternative."""

    at: Annotated[Position, _note("Its position.")]
    block: Annotated[str, _note("A block state: name or name[property=value,...].")]


class _DoubtedContainerEntry(_Entry, frozen=True):
    """The complete contents of a container in an alternative."""

    at: Annotated[Position, _note("Its position.")]
    items: _ItemsField = {}


class DoubtEntry(_Entry, frozen=True):
    """An alternative: one way the world could be, which sets the same as all others do."""

    blocks: Annotated[list[_DoubtedBlockEntry], _note("Blocks.")] = []
    containers: Annotated[list[_DoubtedContainerEntry], _note("Contents of containers.")] = []
    agents: Annotated[dict[str, Point], _note("Agents to the middle of their feet.")] = {}


class InferEntry(_Entry, frozen=True):
    """What an agent wants and believes, inferred from what the probe's `path` holds of its course.

    The keys are those of `MindModel` and `Simulator.infer`.
    """

    agent: Annotated[str, _note("The agent that is modelled.")]
    goals: Annotated[
        dict[str, _MindGoalEntry], msgspec.Meta(min_length=1, description="Name to goal.")
    ]
    utilities: Annotated[
        dict[str, float | list[float] | LevelsEntry] | list[dict[str, float]],
        _note("Values to consider by goal, all combinations; or a list of combinations."),
    ]
    doubt: Annotated[
        dict[str, DoubtEntry] | None,
        _note("Alternatives that the agent cannot tell apart; null: it knows the world."),
    ] = None
    credences: Annotated[
        list[list[float]] | GridEntry | None,
        _note("Initial credences to consider, rows over the alternatives; null: uniform."),
    ] = None
    actual: Annotated[
        str | dict[str, float] | None,
        _note("An alternative, `unknown`, or weights; null: what the probe's path holds."),
    ] = None
    prior: Annotated[
        list[list[float]] | None, _note("Weights, utilities by credences; null: uniform.")
    ] = None
    rationality: Annotated[
        float | list[float], _note("Inverse temperature of choices; a list is a factor.")
    ] = 2.5
    discount: Annotated[float, _note("Factor on the value of the future with each act.")] = 0.99
    step_cost: Annotated[float, _note("Cost of a step.")] = 1.0
    stay_cost: Annotated[float, _note("Cost of staying.")] = 0.0
    act_cost: Annotated[float, _note("Cost of acting on a goal, and of opening.")] = 1.0
    diagonal: Annotated[bool, _note("Whether steps also lead to diagonal neighbours.")] = False
    step_ticks: Annotated[
        int | None, _note("Ticks without movement that are one stay; null: by the world.")
    ] = None
    stays: Annotated[bool, _note("Whether ticks without movement are evidence.")] = True
    lapse: Annotated[float, _note("What is left of a contradicted alternative.")] = 0.0
    since: Annotated[int, msgspec.Meta(ge=0, description="The first tick that counts.")] = 0
    until: Annotated[
        Annotated[int, msgspec.Meta(ge=0)] | None,
        _note("The last tick that counts; null: the script's end."),
    ] = None
    ended: Annotated[
        bool, _note("Whether the agent acts on the goal at its place after the last tick.")
    ] = False
    smooth: Annotated[bool, _note("Whether credence_now uses later evidence too.")] = False


class ProbeEntry(_Entry, frozen=True):
    """A model is asked from one belief; its program runs in a simulator and is judged there.

    `acts_in`, `agent` and `task` may be missing where nothing but `answers` is expected. With
    `infer` no model is asked, and `path`, `label` and `expect` alone may stand beside it.
    """

    path: Annotated[str, _note("The belief that the prompt is rendered from.")]
    acts_in: Annotated[str | None, _note("The simulator that the program runs in.")] = None
    agent: Annotated[str | None, _note("The agent that runs it.")] = None
    task: Annotated[str | None, _note("What the model is asked to make the agent do.")] = None
    label: Annotated[str, _note("A name for tables and overrides.")] = ""
    template: Annotated[
        str | None,
        _note("`default`, `paper`, or a prompt template file beside the scenario; null: `paper`."),
    ] = None
    expect: Annotated[ExpectEntry | None, _note("How the outcome is judged.")] = None
    infer: Annotated[
        InferEntry | None,
        _note("What is inferred of an agent from what `path` holds; no model is asked."),
    ] = None
    senses: Annotated[
        Literal["world", "percepts"] | None,
        _note("What programs read: everything, or what their agents perceive or remember."),
    ] = None
    timeout_ticks: Annotated[
        int,
        msgspec.Meta(
            gt=0,
            le=_LONGEST_TIMEOUT,
            description="Ticks of 50 ms after which the program has failed.",
        ),
    ] = 1200


class ParameterEntry(_Entry, frozen=True):
    """A parameter: `${name}` in any value stands for its value."""

    default: Annotated[Any, _note("Its value where none is given.")]
    values: Annotated[list[Any], _note("What it may be; empty: `range`, or only the default.")] = []
    range: Annotated[
        tuple[int | float, int | float] | None, _note("Its lowest and highest value.")
    ] = None
    step: Annotated[
        int | float | None,
        _note("Between values in `range`; 0: any number. 1 for whole bounds, else 0."),
    ] = None
    description: Annotated[str, _note("What it is.")] = ""


class ScenarioFile(_Entry, frozen=True):
    """A scenario: a world, agents, what they do, and what they should come to believe."""

    name: Annotated[str, _note("Short name, for tables and folders.")]
    box: Annotated[
        tuple[Position, Position], _note("Two inclusive corners of the part of space it plays in.")
    ]
    agents: Annotated[
        dict[str, AgentEntry],
        msgspec.Meta(min_length=1, description="Who lives there: name to agent."),
    ]
    description: Annotated[str, _note("What it is about.")] = ""
    reported_by: Annotated[
        str, _note("Who reported what is expected, as in 'as the paper reports'.")
    ] = ""
    parameters: Annotated[
        dict[str, ParameterEntry], _note("What `${name}` in other values stands for.")
    ] = {}
    constraints: Annotated[
        list[str], _note("Expressions over parameters that hold, such as `gap < 4`.")
    ] = []
    blocks: Annotated[list[BlockEntry], _note("The rest of the box is air.")] = []
    containers: Annotated[
        list[ContainerEntry], _note("What containers hold at the start, and what people call them.")
    ] = []
    signs: Annotated[list[SignEntry], _note("Signs, and what is written on them.")] = []
    places: Annotated[dict[str, Position], _note("What people call places: name to block.")] = {}
    perception: Annotated[
        PerceptionEntry,
        _note("How far agents see and hear, and what they make of what they are told."),
    ] = PerceptionEntry()
    senses: Annotated[
        Literal["world", "percepts"],
        _note("What programs read: everything, or what their agents perceive or remember."),
    ] = "world"
    static_blocks: Annotated[
        list[str | Position],
        _note("Blocks that everybody knows from the start: names, or positions."),
    ] = []
    unique: Annotated[
        list[str],
        _note(
            "Items of which everybody knows that there is one: seen in one place, an item is "
            "believed nowhere else."
        ),
    ] = []
    labels: Annotated[
        bool,
        _note("Whether prompts say what containers are called and look as if they held."),
    ] = False
    initial_beliefs: Annotated[
        list[InitialBeliefEntry], _note("What is believed before anything happens.")
    ] = []
    script: Annotated[list[StepEntry], _note("What happens in the real world, in order.")] = []
    probes: Annotated[list[ProbeEntry], _note("What is asked once the script has ended.")] = []
    expectations: Annotated[
        list[ExpectationEntry], _note("What should be believed once the script has ended.")
    ] = []
    episode: Annotated[
        EpisodeEntry | None,
        _note("What agents are after, and the rules by which they act round after round."),
    ] = None
    conditions: Annotated[
        dict[int, dict[str, Any]],
        _note(
            "Number to what differs: a mapping is merged key by key, anything else replaces. "
            "For a list of labelled entries, a mapping changes the entries with these labels."
        ),
    ] = {}


LABELLED = ("script", "probes", "expectations")
"""Lists whose entries a condition may change one by one, by label."""
