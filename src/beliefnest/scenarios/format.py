"""Form of scenario files: the allowed keys and values.

These types are the single source of the published JSON schema (`docs/scenario.schema.json`)
and of the check of a file's form. The module `build` checks if the content is consistent.
"""

from typing import Annotated, Any, Literal

import msgspec

from beliefnest.facts.kinds import FactEntry
from beliefnest.perception.options import Perception
from beliefnest.scenarios.expected import ExpectationEntry, ExpectEntry
from beliefnest.scenarios.rules import EpisodeEntry
from beliefnest.world import values as world
from beliefnest.world.forms import WrittenPoint, WrittenPosition, note

_WIDEST = 1_000
"""Greatest angle in radians, in both directions."""
_LONGEST_TIMEOUT = 10_000_000
"""Ticks; about six days."""

_Timeout = Annotated[int, msgspec.Meta(gt=0, le=_LONGEST_TIMEOUT)]
_Senses = Literal["world", "percepts"]
_SENSES = note("Facts that programs read: all, or what their agents perceive or remember.")
_Angle = Annotated[float, msgspec.Meta(ge=-_WIDEST, le=_WIDEST)]
_ItemsField = Annotated[dict[str, int], note("Item name to count.")]
_LabelField = Annotated[str, note("Its name in tables and pictures.")]
_LooksField = Annotated[str, note("What it seems to contain, in words; see the key `labels`.")]
_HIGHEST = 384
"""Height of a Minecraft world in blocks."""
_Height = Annotated[int, msgspec.Meta(ge=1, le=_HIGHEST)]


class _Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Base of all parts of a scenario file; unknown keys are errors."""


class BlockEntry(_Entry, frozen=True):
    """Blocks of one kind, with one of `at`, `fill` and `walls`. Later entries replace earlier."""

    block: Annotated[str | None, note("A block state: name or name[property=value,...].")]
    at: Annotated[WrittenPosition | None, note("One position.")] = None
    fill: Annotated[
        tuple[WrittenPosition, WrittenPosition] | None,
        note("Two inclusive corners; all between them."),
    ] = None
    walls: Annotated[
        tuple[WrittenPosition, WrittenPosition] | None,
        note("Two inclusive corners; the four vertical sides of the box between them."),
    ] = None


class TerrainEntry(_Entry, frozen=True):
    """All blocks of the box, compressed, as `beliefnest capture` writes them."""

    states: Annotated[list[str], note("Block states: name or name[property=value,...].")]
    chunks: Annotated[
        int, msgspec.Meta(ge=0, description="Number of different cubes; 0: it is not cut.")
    ]
    cells: Annotated[str, note("Numbers of states, by Zstandard and in Base64.")]


class ContainerEntry(_Entry, frozen=True):
    """A container with its block."""

    at: Annotated[WrittenPosition, note("Position of its block.")]
    block: Annotated[str, note("A block state of a container.")] = "chest"
    items: _ItemsField = {}
    label: _LabelField = ""
    looks: _LooksField = ""


_SignText = Annotated[
    str, note("Text on its front: at most 4 lines of 45 characters, separated by line breaks.")
]


class SignEntry(_Entry, frozen=True):
    """A sign with its block and its text."""

    at: Annotated[WrittenPosition, note("Position of its block.")]
    text: _SignText = ""
    block: Annotated[str, note("A block state of a sign.")] = "oak_sign"
    claims: Annotated[list[FactEntry], note("Claims of the text, for its readers.")] = []


class BelievedSignEntry(_Entry, frozen=True):
    """A believed sign and its text."""

    at: Annotated[WrittenPosition, note("Its position.")]
    text: _SignText = ""
    block: Annotated[
        str | None, note("A block state of a sign; null: that of the real sign there.")
    ] = None


class EquipmentEntry(_Entry, frozen=True):
    """Equipment of an agent: items by slot."""

    head: Annotated[str | None, note("A helmet, or another item worn on the head.")] = None
    chest: Annotated[str | None, note("A chestplate.")] = None
    legs: Annotated[str | None, note("Leggings.")] = None
    feet: Annotated[str | None, note("Boots.")] = None
    main_hand: Annotated[str | None, note("Item in the main hand.")] = None
    off_hand: Annotated[str | None, note("Item in the other hand.")] = None


class _AgentAttributes(_Entry, frozen=True):
    """Attributes of an agent apart from its name and place."""

    facing: Annotated[
        Literal["north", "east", "south", "west"] | WrittenPoint | None,
        note("A direction, or a point to look at; instead of yaw and pitch."),
    ] = None
    yaw: Annotated[_Angle | None, note("Radians; 0 looks north (-z), pi/2 west (-x).")] = None
    pitch: Annotated[_Angle | None, note("Radians, positive upwards.")] = None
    inventory: Annotated[
        dict[str, int], note("Counts by item name; equipment is added if it is not listed.")
    ] = {}
    equipment: Annotated[EquipmentEntry, note("Worn and held items.")] = EquipmentEntry()
    health: Annotated[float, msgspec.Meta(gt=0, le=20, description="Half hearts.")] = 20.0
    food: Annotated[float, msgspec.Meta(ge=0, le=20, description="Half drumsticks.")] = 20.0
    type: Annotated[
        Literal["bot", "human"],
        note("A bot that runs programs, or a person who joins with the agent's name."),
    ] = "bot"


class AgentEntry(_AgentAttributes, frozen=True, kw_only=True):
    """An agent: a Mineflayer bot in a Minecraft world, or a person."""

    position: Annotated[world.Point, note("Middle of the feet, in blocks.")]


class LegendEntry(_AgentAttributes, frozen=True, kw_only=True):
    """Meaning of a character on a map: a block, door, container or sign; an agent; a place.

    One character can mean several of them, such as an agent at a place. `facing` is that of the
    agent or door.
    """

    block: Annotated[str | None, note("A block state; one block, unless `height` is given.")] = None
    height: Annotated[_Height | None, note("Height of `block` in blocks.")] = None
    door: Annotated[
        str | None, note("A door of two blocks, such as oak; by default it faces across its wall.")
    ] = None
    open: Annotated[bool, note("True if the door is open.")] = False
    container: Annotated[str | None, note("A block state of a container.")] = None
    items: _ItemsField = {}
    label: _LabelField = ""
    looks: _LooksField = ""
    sign: Annotated[_SignText | None, note("A sign with this text.")] = None
    claims: Annotated[list[FactEntry], note("Claims of the sign's text, for its readers.")] = []
    agent: Annotated[str | None, note("Name of an agent that stands here.")] = None
    place: Annotated[str | None, note("Name of this place.")] = None
    floor: Annotated[str | None, note("The block below, instead of the floor of the map.")] = None
    above: Annotated[
        str | None, note("The blocks above it, as high as the floor of the map is.")
    ] = None


_Rows = Annotated[
    str | list[str], note("Rows of characters, from north to south; each from west to east.")
]


class FloorEntry(_Entry, frozen=True):
    """A floor of a map with a height of its own."""

    rows: _Rows
    height: Annotated[_Height, note("Height of this floor in blocks.")] = 1


class MapEntry(_Entry, frozen=True):
    """A drawing of the scene: floors as rows of characters, each explained by the legend."""

    floors: Annotated[
        str | list[str | list[str] | FloorEntry],
        note("The floors, the lowest first; or the rows of the only one."),
    ]
    legend: Annotated[
        dict[str, str | LegendEntry],
        note(
            "Character to meaning; a text is a block as high as the floor. `.` is air unless "
            "stated otherwise."
        ),
    ] = {}
    origin: Annotated[
        WrittenPosition, note("Block of the first character of the first row of the lowest floor.")
    ] = (0, 1, 0)
    floor: Annotated[str | None, note("Block below the lowest floor; null: none.")] = "stone"
    height: Annotated[_Height, note("Height of each floor in blocks.")] = 3


class _BelievedContainerEntry(_Entry, frozen=True):
    """Believed contents of a container."""

    at: Annotated[WrittenPosition, note("Its position.")]
    items: _ItemsField = {}
    complete: Annotated[bool, note("True if these are believed to be all items in it.")] = True


class InitialBeliefEntry(_Entry, frozen=True):
    """Initial content of a belief."""

    path: Annotated[
        str, note("A belief path such as /observer/sally; with /** at the end, also all below it.")
    ]
    containers: Annotated[
        list[_BelievedContainerEntry], note("Believed contents of containers.")
    ] = []
    blocks: Annotated[list[BlockEntry], note("Believed blocks; `block` null: unknown.")] = []
    signs: Annotated[list[BelievedSignEntry], note("Believed signs.")] = []
    agents: Annotated[
        dict[str, WrittenPoint] | list[str],
        note("Believed positions of the feet; or names of agents, which are where they stand."),
    ] = {}
    inventories: Annotated[
        dict[str, dict[str, int]], note("Items that agents are known to have, by agent.")
    ] = {}


class StepEntry(_Entry, frozen=True):
    """Programs that run together in the real world; `agent` and `program`, or `programs`."""

    label: Annotated[str, note("What happens; used in progress, messages and overrides.")] = ""
    agent: Annotated[str | None, note("The agent of a single program.")] = None
    program: Annotated[str | None, note("JavaScript, the body of an async function.")] = None
    programs: Annotated[dict[str, str], note("Programs by agent.")] = {}
    senses: Annotated[_Senses | None, _SENSES] = None
    timeout_ticks: Annotated[_Timeout, note("Ticks of 50 ms after which the step fails.")] = 1200


class _MindGoalEntry(_Entry, frozen=True):
    """A possible goal of an agent; exactly one of the keys."""

    at: Annotated[WrittenPosition | None, note("The cell in which to stand.")] = None
    block: Annotated[str | None, note("Name of the block on which to stand.")] = None
    item: Annotated[str | None, note("Name of the item to take.")] = None


class LevelsEntry(_Entry, frozen=True):
    """Utilities to consider: all values of a range."""

    range: Annotated[tuple[float, float], note("Lowest and highest value.")]
    step: Annotated[float, msgspec.Meta(gt=0, description="Between values.")] = 1.0


class GridEntry(_Entry, frozen=True):
    """Initial credences to consider: a grid over the alternatives."""

    grid: Annotated[int, msgspec.Meta(ge=1, le=1000, description="Steps from 0 to 1.")]
    smoothing: Annotated[
        float, msgspec.Meta(ge=0, le=1, description="Weight of the uniform credence in each.")
    ] = 0.0


class InferEntry(_Entry, frozen=True):
    """Inference of an agent's goals and beliefs from its motion, as known at the probe's `path`.

    The keys are those of `MindModel` and `Simulator.infer`.
    """

    agent: Annotated[str, note("The agent that is modelled.")]
    goals: Annotated[
        dict[str, _MindGoalEntry], msgspec.Meta(min_length=1, description="Goals by name.")
    ]
    utilities: Annotated[
        dict[str, float | list[float] | LevelsEntry] | list[dict[str, float]],
        note("Values to consider by goal, all combinations; or a list of combinations."),
    ]
    doubt: Annotated[
        dict[str, list[FactEntry]] | None,
        note(
            "Alternatives that the agent cannot tell apart: facts that all of them state of the "
            "same things; null: it knows the world."
        ),
    ] = None
    credences: Annotated[
        list[list[float]] | GridEntry | None,
        note("Initial credences to consider, rows over the alternatives; null: uniform."),
    ] = None
    actual: Annotated[
        str | dict[str, float] | None,
        note("An alternative, `unknown`, or weights; null: the state at the probe's path."),
    ] = None
    prior: Annotated[
        list[list[float]] | None, note("Weights, utilities by credences; null: uniform.")
    ] = None
    rationality: Annotated[
        float | list[float], note("Inverse temperature of choices; a list is a factor.")
    ] = 2.5
    discount: Annotated[float, note("Factor on the value of the future with each act.")] = 0.99
    step_cost: Annotated[float, note("Cost of a step.")] = 1.0
    stay_cost: Annotated[float, note("Cost of staying.")] = 0.0
    act_cost: Annotated[float, note("Cost of acting on a goal, and of opening.")] = 1.0
    diagonal: Annotated[bool, note("True if steps also lead to diagonal neighbours.")] = False
    step_ticks: Annotated[
        int | None, note("Ticks without movement that are one stay; null: by the world.")
    ] = None
    stays: Annotated[bool, note("True if ticks without movement are evidence.")] = True
    lapse: Annotated[float, note("Weight that a contradicted alternative keeps.")] = 0.0
    since: Annotated[int, msgspec.Meta(ge=0, description="The first tick that counts.")] = 0
    until: Annotated[
        Annotated[int, msgspec.Meta(ge=0)] | None,
        note("The last tick that counts; null: the script's end."),
    ] = None
    ended: Annotated[
        bool, note("True if the agent acts on the goal at its place after the last tick.")
    ] = False
    smooth: Annotated[bool, note("True if credence_now uses later evidence too.")] = False


class ProbeEntry(_Entry, frozen=True):
    """A request to a model, with a prompt from one belief.

    The model's program runs in a simulator and is judged there. `acts_in`, `agent` and `task` may
    be missing if only `answers` are expected. With `infer` no model is asked, and only `path`,
    `label` and `expect` may stand beside it.
    """

    path: Annotated[str, note("Belief path from which the prompt is rendered.")]
    acts_in: Annotated[str | None, note("Path of the simulator in which the program runs.")] = None
    agent: Annotated[str | None, note("The agent that runs the program.")] = None
    task: Annotated[str | None, note("Task of the agent, for the model.")] = None
    label: Annotated[str, note("A name for tables and overrides.")] = ""
    intended: Annotated[
        str,
        note(
            "Intended right answer, `true belief` or `false belief`; a warning is given if the "
            "computed answer is another one."
        ),
    ] = ""
    template: Annotated[
        str | None,
        note(
            "A built-in template, such as `story`, or a prompt template file beside the scenario; "
            "null: `paper` for programs, `question` for questions."
        ),
    ] = None
    expect: Annotated[ExpectEntry | None, note("How the outcome is judged.")] = None
    infer: Annotated[
        InferEntry | None,
        note("Inference about an agent from the state at `path`; no model is asked."),
    ] = None
    senses: Annotated[_Senses | None, _SENSES] = None
    timeout_ticks: Annotated[_Timeout, note("Ticks of 50 ms after which the program fails.")] = 1200


class ParameterEntry(_Entry, frozen=True):
    """A parameter, whose value replaces `${name}` in any value."""

    default: Annotated[Any, note("Value if none is given.")]
    values: Annotated[list[Any], note("Allowed values; empty: `range`, or only the default.")] = []
    range: Annotated[tuple[int | float, int | float] | None, note("Lowest and highest value.")] = (
        None
    )
    step: Annotated[
        int | float | None,
        note("Step in `range`; 0: any number. Default: 1 for whole bounds, else 0."),
    ] = None
    description: Annotated[str, note("Description.")] = ""


class InstanceEntry(_Entry, frozen=True):
    """Rules for the value of a parameter in a random instance."""

    within: Annotated[
        tuple[WrittenPosition, WrittenPosition] | None,
        note("Two inclusive corners: the value is a position between them."),
    ] = None
    free: Annotated[bool, note("True if `blocks` must leave the position free, above a block.")] = (
        True
    )
    apart: Annotated[
        Annotated[float, msgspec.Meta(ge=0)],
        note("Least distance to the other drawn positions, in blocks."),
    ] = 1.0
    seen_by: Annotated[list[str], note("Agents that see the position at the start.")] = []
    hidden_from: Annotated[list[str], note("Agents that do not see it at the start.")] = []
    reached_by: Annotated[
        list[str], note("Agents that can walk to where their hand reaches the position.")
    ] = []
    differs_from: Annotated[list[str], note("Parameters that have other values.")] = []


class _File(_Entry, frozen=True, kw_only=True):
    """All keys of a scenario file that are the same with and without a map."""

    name: Annotated[str, note("Short name, for tables and folders.")]
    description: Annotated[str, note("Description of the scenario.")] = ""
    reported_by: Annotated[
        str, note("Source of the expectations, as in 'as the paper reports'.")
    ] = ""
    parameters: Annotated[
        dict[str, ParameterEntry], note("Parameters, which replace `${name}` in other values.")
    ] = {}
    constraints: Annotated[
        list[str], note("Expressions over parameters that must hold, such as `gap < 4`.")
    ] = []
    instances: Annotated[
        dict[str, InstanceEntry | None],
        note("Parameters whose values the seed of a task draws, each with its rules."),
    ] = {}
    terrain: Annotated[
        TerrainEntry | None, note("All blocks of the box, compressed; `blocks` replace them.")
    ] = None
    blocks: Annotated[list[BlockEntry], note("Blocks in the box; the rest is air.")] = []
    containers: Annotated[
        list[ContainerEntry], note("Containers, their initial contents, and their names.")
    ] = []
    signs: Annotated[list[SignEntry], note("Signs and their texts.")] = []
    places: Annotated[
        dict[str, WrittenPosition], note("Named places: block positions by name.")
    ] = {}
    perception: Annotated[Perception, note("Range of sight and hearing, and effect of claims.")] = (
        Perception()
    )
    senses: Annotated[_Senses, _SENSES] = "world"
    static_blocks: Annotated[
        list[str | WrittenPosition],
        note("Blocks that all agents know from the start: names, or positions."),
    ] = []
    unique: Annotated[
        list[str],
        note(
            "Items that all agents know to exist only once: an agent that sees one believes that "
            "it is nowhere else."
        ),
    ] = []
    labels: Annotated[bool, note("True if prompts contain `label` and `looks` of containers.")] = (
        False
    )
    initial_beliefs: Annotated[list[InitialBeliefEntry], note("Beliefs before the script.")] = []
    script: Annotated[list[StepEntry], note("Steps in the real world, in order.")] = []
    probes: Annotated[list[ProbeEntry], note("Requests to models after the script.")] = []
    expectations: Annotated[list[ExpectationEntry], note("Expected beliefs after the script.")] = []
    episode: Annotated[
        EpisodeEntry | None, note("Goals of agents, and the rules of play in rounds.")
    ] = None
    conditions: Annotated[
        dict[int, dict[str, Any]],
        note(
            "Overrides by number: a mapping is merged key by key, any other value and `{}` "
            "replaces. For a list of labelled entries, a mapping changes the entries with these "
            "labels."
        ),
    ] = {}


_BOX = note("Two inclusive corners of the scenario's space.")


class ScenarioFile(_File, frozen=True, kw_only=True):
    """A scenario: a world, agents, a script, and expected beliefs."""

    box: Annotated[tuple[WrittenPosition, WrittenPosition], _BOX]
    agents: Annotated[
        dict[str, AgentEntry], msgspec.Meta(min_length=1, description="Agents by name.")
    ]


class WrittenFile(_File, frozen=True, kw_only=True):
    """A scenario as people write it: with a map, or with `box` and `agents`."""

    map: Annotated[
        MapEntry | msgspec.UnsetType,
        note(
            "A drawing of the scene. Other keys add to it, and `box` and `agents` may be missing."
        ),
    ] = msgspec.UNSET
    box: Annotated[tuple[WrittenPosition, WrittenPosition] | msgspec.UnsetType, _BOX] = (
        msgspec.UNSET
    )
    agents: Annotated[
        dict[str, dict[str, Any]],
        note("Agents by name. What is stated here counts for agents on the map, too."),
    ] = {}
