"""Expected states of simulators: their form in files, their judgement, and their words.

Each kind is a class that reads, judges, describes and writes itself. To add a kind, add its keys to
`ExpectationEntry`, and its class to `KINDS`.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import msgspec

from beliefnest.belief.view import State
from beliefnest.nest.past.setting import Setting
from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import KeyPath
from beliefnest.scenarios.naming import container_name, point_text
from beliefnest.world import forms
from beliefnest.world import values as world
from beliefnest.world.forms import note
from beliefnest.world.signs import sign_words
from beliefnest.world.values import Items
from beliefnest.world.words import items_words, point_words

__all__ = ["Content", "Expectation", "ExpectationEntry", "Hears", "Holds", "Is", "Reads", "Stands"]


class ExpectationEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Expected content of a belief: a container, agent, sign, block, or utterance."""

    path: Annotated[str, note("Belief path; / is the real world.", "path")]
    label: Annotated[str, note("A name for tables and overrides.", "keep")] = ""
    container: Annotated[
        forms.Position | None, note("A container that holds `items`.", "block")
    ] = None
    items: Annotated[dict[str, int] | None, note("Exactly the known items in it.", "items")] = None
    agent: Annotated[str | None, note("An agent that stands at `position`.", "agent")] = None
    sign: Annotated[forms.Position | None, note("A sign that says `text`.", "block")] = None
    text: Annotated[str | None, note("Exact text of the sign; null: unknown.", "text")] = None
    block: Annotated[forms.Position | None, note("A block that is `state`.", "block")] = None
    state: Annotated[str | None, note("A block state; null: unknown.", "state")] = None
    heard: Annotated[str | None, note("Part of a known utterance.", "text")] = None
    not_heard: Annotated[str | None, note("Text that no known utterance contains.", "text")] = None
    position: Annotated[forms.Point | None, note("Middle of the feet.", "point")] = None
    within: Annotated[
        forms.Within, note("Greatest distance from `position`, in blocks.", "keep")
    ] = 2.0


class Content(ABC):
    """Expected state of a simulator.

    Attributes:
        keys: Keys of `ExpectationEntry` that select the kind; one of them is given.
        form: The kind's keys, for messages.
        containers: Containers whose contents are expected.
        agents: Agents whose places are expected.
        noted: True if pictures show what was found as a line of its own.
    """

    __slots__ = ()
    keys: ClassVar[tuple[str, ...]]
    form: ClassVar[str]
    noted: ClassVar[bool] = False

    @property
    def containers(self) -> tuple[world.Position, ...]:
        return ()

    @property
    def agents(self) -> tuple[str, ...]:
        return ()

    @classmethod
    @abstractmethod
    def read(cls, entry: ExpectationEntry, path: KeyPath, checks: Checks) -> "Content | None":
        """Return the content of an entry of this kind; None: it lacks a key or has too many.

        Raises:
            ScenarioError: The entry names something that does not exist.
        """

    @abstractmethod
    def written(self) -> dict[str, Any]:
        """Return plain values with the keys of scenario files."""

    @abstractmethod
    def instead(self, state: State) -> str | None:
        """Return what a simulator believes instead; None: it is as expected."""

    @abstractmethod
    def found(self, state: State, setting: Setting) -> tuple[str, str]:
        """Return what was looked for, and what a simulator believes, for a table."""


@dataclass(frozen=True, slots=True)
class Holds(Content):
    """Expected state: a container holds exactly these known items."""

    keys = ("container",)
    form = "'container' and 'items'"
    container: world.Position
    items: Items

    @property
    def containers(self) -> tuple[world.Position, ...]:
        return (self.container,)

    @classmethod
    def read(cls, entry: ExpectationEntry, path: KeyPath, checks: Checks) -> "Holds | None":
        if entry.container is None or entry.items is None:
            return None
        whole = checks.container((*path, "container"), entry.container)
        checks.contents((*path, "items"), whole, entry.items)
        return cls(whole, dict(entry.items))

    def written(self) -> dict[str, Any]:
        return {"container": list(self.container), "items": dict(self.items)}

    def instead(self, state: State) -> str | None:
        held = self._held(state)
        if held == dict(self.items):
            return None
        found, wanted = (items_words(each, ids=True) or "nothing" for each in (held, self.items))
        return f"{point_words(self.container)} holds {found}, not {wanted}"

    def found(self, state: State, setting: Setting) -> tuple[str, str]:
        if not self.items:
            held = items_words(self._held(state), ids=True)
            return container_name(self.container, setting), held or "nothing"
        places = [
            container_name(place, setting)
            for place, known in sorted(state.containers.items())
            if all(known.items.get(name, 0) >= count for name, count in self.items.items())
        ]
        return ", ".join(self.items), " and ".join(places) or "nowhere"

    def _held(self, state: State) -> Items:
        # A container that was never perceived has no known contents, so compare with nothing.
        container = state.containers.get(self.container)
        return dict(container.items) if container else {}


@dataclass(frozen=True, slots=True)
class Stands(Content):
    """Expected state: an agent stands at a place.

    Attributes:
        agent: Name of the agent.
        place: Middle of the feet, in blocks; None: the place is unknown.
        within: Greatest distance from there, in blocks.
    """

    keys = ("agent",)
    form = "'agent' and 'position'"
    agent: str
    place: world.Point | None
    within: float = 2.0

    @property
    def agents(self) -> tuple[str, ...]:
        return (self.agent,)

    @classmethod
    def read(cls, entry: ExpectationEntry, path: KeyPath, checks: Checks) -> "Stands | None":
        if entry.agent is None or entry.items is not None:
            return None
        checks.agent((*path, "agent"), entry.agent)
        return cls(entry.agent, entry.position, entry.within)

    def written(self) -> dict[str, Any]:
        return {"agent": self.agent, "position": None if self.place is None else list(self.place)}

    def instead(self, state: State) -> str | None:
        there = state.agents[self.agent].position
        if self.place is None or there is None:
            ok = self.place is there
        else:
            ok = math.dist(self.place, there) <= self.within
        found, wanted = (
            "nowhere" if each is None else f"at {point_words(each)}" for each in (there, self.place)
        )
        return None if ok else f"{self.agent} is {found}, not {wanted}"

    def found(self, state: State, setting: Setting) -> tuple[str, str]:
        there = state.agents[self.agent].position
        return self.agent, "unknown" if there is None else point_text(there)


@dataclass(frozen=True, slots=True)
class Hears(Content):
    """Expected state: a simulator knows of an utterance, or of none.

    Attributes:
        text: Part of an utterance.
        ever: True if an utterance with this part is known; False if none is.
    """

    keys = ("heard", "not_heard")
    form = "'heard', 'not_heard'"
    noted = True
    text: str
    ever: bool = True

    @classmethod
    def read(cls, entry: ExpectationEntry, path: KeyPath, checks: Checks) -> "Hears | None":
        text = entry.heard or entry.not_heard
        if not text or entry.items is not None:
            return None
        return cls(text, ever=entry.heard is not None)

    def written(self) -> dict[str, Any]:
        return {"heard" if self.ever else "not_heard": self.text}

    def instead(self, state: State) -> str | None:
        if self._heard(state) is self.ever:
            return None
        return f"{self.text!r} was {'not ' if self.ever else ''}heard"

    def found(self, state: State, setting: Setting) -> tuple[str, str]:
        return f"{self.text!r}", "heard" if self._heard(state) else "not heard"

    def _heard(self, state: State) -> bool:
        return any(self.text in line for _, _, line in state.chat)


@dataclass(frozen=True, slots=True)
class Reads(Content):
    """Expected state: a sign has a text.

    Attributes:
        sign: Position of the sign.
        text: Text of the sign; None: the text is unknown.
    """

    keys = ("sign",)
    form = "'sign' and 'text'"
    sign: world.Position
    text: str | None

    @classmethod
    def read(cls, entry: ExpectationEntry, path: KeyPath, checks: Checks) -> "Reads | None":
        if entry.sign is None or entry.items is not None:
            return None
        checks.inside((*path, "sign"), entry.sign)
        return cls(entry.sign, entry.text)

    def written(self) -> dict[str, Any]:
        return {"sign": list(self.sign), "text": self.text}

    def instead(self, state: State) -> str | None:
        there, where = state.signs.get(self.sign), point_words(self.sign)
        if there == self.text:
            return None
        found = f"of a sign at {where} nothing is known"
        if there is not None:
            found = f"the sign at {where} says {sign_words(there)!r}"
        return f"{found}, not {'unknown' if self.text is None else repr(sign_words(self.text))}"

    def found(self, state: State, setting: Setting) -> tuple[str, str]:
        there = state.signs.get(self.sign)
        found = "unknown" if there is None else sign_words(there) or "nothing"
        return f"sign {point_words(self.sign)}", found


@dataclass(frozen=True, slots=True)
class Is(Content):
    """Expected state: a block has a block state.

    Attributes:
        block: Position of the block.
        state: Block state, as in `State.blocks`; None: the block is unknown.
    """

    keys = ("block",)
    form = "'block' and 'state'"
    block: world.Position
    state: str | None

    @classmethod
    def read(cls, entry: ExpectationEntry, path: KeyPath, checks: Checks) -> "Is | None":
        if entry.block is None or entry.items is not None:
            return None
        checks.inside((*path, "block"), entry.block)
        return cls(entry.block, checks.state((*path, "state"), entry.state))

    def written(self) -> dict[str, Any]:
        return {"block": list(self.block), "state": self.state}

    def instead(self, state: State) -> str | None:
        there = state.blocks[self.block]
        if there == self.state:
            return None
        return f"{point_words(self.block)} is {there or 'unknown'}, not {self.state or 'unknown'}"

    def found(self, state: State, setting: Setting) -> tuple[str, str]:
        return f"block {point_words(self.block)}", state.blocks[self.block] or "unknown"


KINDS: tuple[type[Content], ...] = (Holds, Stands, Reads, Is, Hears)


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

    @classmethod
    def read(cls, entry: ExpectationEntry, path: KeyPath, checks: Checks) -> "Expectation":
        """Return the expectation of an entry.

        Raises:
            ScenarioError: The entry is no expectation, or names something that does not exist.
        """
        checks.belief_path((*path, "path"), entry.path)
        given = [key for kind in KINDS for key in kind.keys if getattr(entry, key) is not None]
        kind = next((kind for kind in KINDS if given[:1] and given[0] in kind.keys), None)
        content = None if kind is None or len(given) > 1 else kind.read(entry, path, checks)
        if content is None:
            forms_ = ", ".join(kind.form for kind in KINDS)
            raise checks.fault(path, f"give one of {forms_}")
        return cls(entry.path, content, entry.label)

    def written(self) -> dict[str, Any]:
        """Return plain values: path, label, and the content with the keys of scenario files."""
        return {"path": self.path, "label": self.label, "expected": self.content.written()}

    @property
    def where(self) -> str:
        """Return the simulator for people: `reality`, or its path."""
        return "reality" if self.path == "/" else self.path
