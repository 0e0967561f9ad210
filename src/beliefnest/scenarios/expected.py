"""Expectations about probes, and about simulators after the script."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from beliefnest.world.values import Items, Point, Position

if TYPE_CHECKING:  # Avoid a cycle: the module of trials imports this one.
    from beliefnest.scenarios.trial import Trial

__all__ = [
    "Answers",
    "Arrives",
    "Believes",
    "Content",
    "Expectation",
    "Expected",
    "Hears",
    "Holds",
    "Infers",
    "Intends",
    "Is",
    "Judge",
    "Opens",
    "Reads",
    "Says",
    "Stands",
    "Takes",
    "Tells",
]


@dataclass(frozen=True, slots=True)
class Opens:
    """Expectation: the program opens this container before any other."""

    container: Position


@dataclass(frozen=True, slots=True)
class Arrives:
    """Expectation: the program brings its agent to a place.

    Attributes:
        place: Middle of the feet, in blocks.
        within: Greatest distance from there, in blocks.
    """

    place: Point
    within: float = 2.0


@dataclass(frozen=True, slots=True)
class Intends:
    """Expectation: the program heads for a place, even if it does not get there.

    The judgement uses the program's calls, never its words. It holds if the first block or agent
    that the program asked to use is at the place. If the place is no container, or the program
    asked to use nothing, it holds if the last goal of a walk is near the place.

    Attributes:
        place: A container or another place, in blocks.
        within: Greatest distance of a walk's goal from the place, in blocks.
        is_container: True if a container of the scenario is there.
    """

    place: Point
    within: float = 2.0
    is_container: bool = False


@dataclass(frozen=True, slots=True)
class Takes:
    """Expectation: the program takes at least these items out of containers.

    Attributes:
        items: Counts by item name.
    """

    items: Items


@dataclass(frozen=True, slots=True)
class Says:
    """Expectation: the program says or whispers something.

    Attributes:
        text: Part of an utterance; case does not matter.
    """

    text: str


@dataclass(frozen=True, slots=True)
class Answers:
    """Expectation: the model answers a question, in words or by choosing an option.

    Attributes:
        question: The question.
        right: Right answers. An answer in words is right if it contains one of them as whole
            words, in any case, and none of `wrong`.
        options: Options to choose from, shuffled by the seed; empty: an answer in words.
        wrong: Texts that a right answer in words must not contain.
        reason: True if the model is also asked for a reason.
    """

    question: str
    right: tuple[str, ...]
    options: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()
    reason: bool = False


@dataclass(frozen=True, slots=True)
class Judge:
    """Expectation: a Python function accepts the trial.

    Attributes:
        function: Function of the trial; returns True, or False or a text that says why not.
        name: Name in tables.
    """

    function: "Callable[[Trial], bool | str]"
    name: str


@dataclass(frozen=True, slots=True)
class Holds:
    """Expected state: a container holds exactly these known items."""

    container: Position
    items: Items


@dataclass(frozen=True, slots=True)
class Stands:
    """Expected state: an agent stands at a place.

    Attributes:
        agent: Name of the agent.
        place: Middle of the feet, in blocks; None: the place is unknown.
        within: Greatest distance from there, in blocks.
    """

    agent: str
    place: Point | None
    within: float = 2.0


@dataclass(frozen=True, slots=True)
class Hears:
    """Expected state: a simulator knows of an utterance, or of none.

    Attributes:
        text: Part of an utterance.
        ever: True if an utterance with this part is known; False if none is.
    """

    text: str
    ever: bool = True


@dataclass(frozen=True, slots=True)
class Reads:
    """Expected state: a sign has a text.

    Attributes:
        sign: Position of the sign.
        text: Text of the sign; None: the text is unknown.
    """

    sign: Position
    text: str | None


@dataclass(frozen=True, slots=True)
class Is:
    """Expected state: a block has a block state.

    Attributes:
        block: Position of the block.
        state: Block state, as in `State.blocks`; None: the block is unknown.
    """

    block: Position
    state: str | None


Content = Holds | Stands | Hears | Reads | Is
"""Expected state of a simulator."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """Expectation about a simulator after the script.

    Attributes:
        path: Path of the simulator.
        content: Expected state.
        label: Name for tables.
    """

    path: str
    content: Content
    label: str = ""


@dataclass(frozen=True, slots=True)
class Believes:
    """Expectation: a simulator has an expected state at the end of a probe's program."""

    expectation: Expectation


Tells = Opens | Arrives | Intends | Takes | Says | Believes | Judge
"""Expectations that are judged by a program's run."""


@dataclass(frozen=True, slots=True)
class Infers:
    """Expectation about the posterior mean of a factor: above or below something.

    Attributes:
        factor: The factor, such as `utility.K`.
        above: A number, or another factor whose mean is lower; None: any.
        below: A number, or another factor whose mean is higher; None: any.
    """

    factor: str
    above: float | str | None = None
    below: float | str | None = None


Expected = Tells | Answers | Infers
"""Expectations about a probe."""
