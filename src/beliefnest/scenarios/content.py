"""What a scenario says: its setting, what models are asked, what simulators are to hold."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from beliefnest.nest.past.setting import Setting
from beliefnest.world.values import Items, Point, Position

__all__ = [
    "Arrives",
    "Expectation",
    "Hears",
    "Holds",
    "Opens",
    "Probe",
    "ScenarioContent",
    "Stands",
]


@dataclass(frozen=True, slots=True)
class Opens:
    """A program is to open this container before any other."""

    container: Position


@dataclass(frozen=True, slots=True)
class Arrives:
    """A program is to bring its agent to a place.

    Attributes:
        place: Middle of the feet, in blocks.
        within: Greatest distance from there, in blocks.
    """

    place: Point
    within: float = 2.0


@dataclass(frozen=True, slots=True)
class Probe:
    """A model is asked from one belief; its program runs in a simulator and is judged there.

    Attributes:
        path: The belief that the prompt is rendered from.
        acts_in: The simulator that the program runs in.
        agent: The agent that runs it.
        task: What the model is asked to make the agent do.
        expect: How the outcome is judged; None: it is only recorded.
        template: Text of the prompt template; None: the paper's.
        label: A name for tables.
        timeout_ticks: Ticks of 50 ms after which the program has failed.
    """

    path: str
    acts_in: str
    agent: str
    task: str
    expect: Opens | Arrives | None = None
    template: str | None = None
    label: str = ""
    timeout_ticks: int = 1200


@dataclass(frozen=True, slots=True)
class Holds:
    """A container is to hold exactly these known items."""

    container: Position
    items: Items


@dataclass(frozen=True, slots=True)
class Stands:
    """An agent is to stand at a place.

    Attributes:
        agent: Its name.
        place: Middle of the feet, in blocks; None: its place is to be unknown.
        within: Greatest distance from there, in blocks.
    """

    agent: str
    place: Point | None
    within: float = 2.0


@dataclass(frozen=True, slots=True)
class Hears:
    """Something is to have been said as far as a simulator knows, or not.

    Attributes:
        text: Part of an utterance.
        ever: Whether an utterance with this part is to be known; False: none is.
    """

    text: str
    ever: bool = True


@dataclass(frozen=True, slots=True)
class Expectation:
    """What a simulator is to hold after the script.

    Attributes:
        path: The simulator.
        content: What it is to hold.
        label: A name for tables.
    """

    path: str
    content: Holds | Stands | Hears
    label: str = ""


@dataclass(frozen=True)
class ScenarioContent:
    """What a scenario says under one of its conditions if it has any.

    Attributes:
        setting: What a nest starts from, the script included.
        description: What it is about.
        reported_by: Who reported what is expected; empty: the author of the scenario.
        condition: Number of the condition it is under; None: as written, no overrides.
        condition_description: What is special about the condition.
        conditions: All conditions it could be loaded under: number to description.
        probes: What models are asked, in order.
        expectations: What simulators are to hold after the script.
        source: Where it comes from, for messages.
        text: The text of its file; empty if it was built in code.
        templates: Texts of the templates that its probes name, by the name written there.
    """

    setting: Setting
    description: str = ""
    reported_by: str = ""
    condition: int | None = None
    condition_description: str = ""
    conditions: Mapping[int, str] = field(default_factory=dict)
    probes: tuple[Probe, ...] = ()
    expectations: tuple[Expectation, ...] = ()
    source: str = "scenario"
    text: str = ""
    templates: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Its short name."""
        return self.setting.name

    @property
    def labels(self) -> Mapping[Position, str]:
        """What people call the containers."""
        return self.setting.labels
