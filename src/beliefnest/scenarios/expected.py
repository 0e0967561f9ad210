"""What may be expected of a probe, and of a simulator after the script."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from beliefnest.world.values import Items, Point, Position

if TYPE_CHECKING:  # A trial holds what these judge.
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
class Intends:
    """A program is to make for a place, whether or not it gets there or finds anything there.

    Known from what the program asked for, never from its words: the first thing it asked to use
    is at the place or, if the place is no container or it asked to use nothing, the last place it
    asked to walk to is near.

    Attributes:
        place: A container or another place, in blocks.
        within: Greatest distance of a walk's goal from there, in blocks.
        is_container: Whether a container of the scenario stands there.
    """

    place: Point
    within: float = 2.0
    is_container: bool = False


@dataclass(frozen=True, slots=True)
class Takes:
    """A program is to take at least these items out of containers.

    Attributes:
        items: Item name to count.
    """

    items: Items


@dataclass(frozen=True, slots=True)
class Says:
    """A program is to say something aloud or to one.

    Attributes:
        text: Part of an utterance, in upper or lower case.
    """

    text: str


@dataclass(frozen=True, slots=True)
class Answers:
    """A model is to answer a question in words, or by choosing an option.

    Attributes:
        question: What is asked.
        right: The answers that are right. One in words is right if it has one of these in it,
            as whole words in upper or lower case, and none of `wrong`.
        options: What it chooses from, shuffled by the seed; empty: it answers in words.
        wrong: What an answer in words may not have in it.
        reason: Whether it is asked why.
    """

    question: str
    right: tuple[str, ...]
    options: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()
    reason: bool = False


@dataclass(frozen=True, slots=True)
class Judge:
    """A Python function says whether a probe came out right.

    Attributes:
        function: Given the trial, True if it did, else False or a text that says why not.
        name: What tables call it.
    """

    function: "Callable[[Trial], bool | str]"
    name: str


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
class Reads:
    """Something is to be written on a sign as far as a simulator knows.

    Attributes:
        sign: Where the sign is.
        text: What is to be written on it; None: that is to be unknown.
    """

    sign: Position
    text: str | None


@dataclass(frozen=True, slots=True)
class Is:
    """Something is to be a block as far as a simulator knows.

    Attributes:
        block: Where the block is.
        state: The block state, as `State.blocks` has it; None: it is to be unknown.
    """

    block: Position
    state: str | None


Content = Holds | Stands | Hears | Reads | Is
"""What a simulator is to hold."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """What a simulator is to hold after the script.

    Attributes:
        path: The simulator.
        content: What it is to hold.
        label: A name for tables.
    """

    path: str
    content: Content
    label: str = ""


@dataclass(frozen=True, slots=True)
class Believes:
    """A simulator is to hold something once a probe's program has ended."""

    expectation: Expectation


Tells = Opens | Arrives | Intends | Takes | Says | Believes | Judge
"""What is judged by a program's run."""

Expected = Tells | Answers
"""What may be expected of a probe."""
