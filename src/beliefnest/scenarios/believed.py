"""Right answers that the nest computes: what a simulator believes about one thing."""

import difflib
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import Annotated, Any, ClassVar

import msgspec

from beliefnest.belief.view import State
from beliefnest.errors import ScenarioError
from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import KeyPath
from beliefnest.scenarios.naming import Naming
from beliefnest.world import forms
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.forms import note
from beliefnest.world.near import NEAR, names_near
from beliefnest.world.registry import block_name, parse_state
from beliefnest.world.signs import sign_words
from beliefnest.world.texts import quoted
from beliefnest.world.values import Point, Position
from beliefnest.world.words import listed, point_words

StateOf = Callable[[str], State]
"""Function from a belief path to the state after the script."""

_UNKNOWN = "unknown"
_NOT_KNOWN = (
    *(
        "not known",
        "not know",
        "don't know",
        "doesn't know",
        "don\u2019t know",
        "doesn\u2019t know",
    ),
    "no idea",
)
"""Further words for the answer that something is unknown."""
_EMPTY = ("nothing", "empty")
_SMALL = frozenset(
    ["a", "an", "the", "in", "at", "on", "inside", "with", "by", "near", "has", "is", "it", "to"]
)
"""Words that do not distinguish options."""


class BelievedEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Belief of a simulator after the script: a path and exactly one thing."""

    path: Annotated[str, note("Belief path; / is the real world.", "path")]
    item: Annotated[str | None, note("An item: where it is.", "item")] = None
    agent: Annotated[str | None, note("An agent: at which named place it is.", "agent")] = None
    container: Annotated[
        forms.WrittenPosition | None, note("A container: names of the items in it.", "block")
    ] = None
    block: Annotated[
        forms.WrittenPosition | None, note("A block: its name; open or shut; on or off.", "block")
    ] = None
    sign: Annotated[forms.WrittenPosition | None, note("A sign: its text.", "block")] = None
    unknown: Annotated[str, note("The right answer if the simulator does not know it.", "text")] = (
        _UNKNOWN
    )


class _Found(msgspec.Struct, frozen=True):
    """One right answer.

    Attributes:
        names: Texts that give this answer, the best first.
        ranked: True if only the best one is right; with options, the best that is an option.
        place: Its place, if it is a place.
        written: Further texts that an option of the scenario may have for it.
    """

    names: tuple[str, ...]
    ranked: bool = False
    place: Point | None = None
    written: tuple[str, ...] = ()


class Believed(msgspec.Struct, frozen=True):
    """Right answer that is read from a simulator after the script.

    Attributes:
        path: Path of the simulator.
        kind: Kind of the thing: a key of `BelievedEntry`.
        thing: Name or position of the thing.
        unknown: Right answer if the simulator does not know it.
        where: File, line and key, for messages.
    """

    kinds: ClassVar[tuple[str, ...]] = ("item", "agent", "container", "block", "sign")
    path: str
    kind: str
    thing: str | Position
    unknown: str
    where: str

    @classmethod
    def read(cls, entry: BelievedEntry, path: KeyPath, checks: Checks) -> "Believed":
        """Return the right answer of an entry.

        Raises:
            ScenarioError: The entry names no thing or several, or something that does not exist.
        """
        checks.belief_path((*path, "path"), entry.path)
        kinds = [kind for kind in cls.kinds if getattr(entry, kind) is not None]
        if len(kinds) != 1:
            raise checks.fault(path, f"name exactly one of {', '.join(cls.kinds)}")
        kind, thing = kinds[0], getattr(entry, kinds[0])
        match kind:
            case "item":
                with checks.document.naming((*path, kind)):
                    checks.registry.item_stack(thing)
            case "agent":
                checks.agent((*path, kind), thing)
            case "container":
                thing = checks.container((*path, kind), thing)
            case _:
                checks.inside((*path, kind), thing)
        if not entry.unknown.strip():
            raise checks.fault((*path, "unknown"), "is empty; give the answer")
        return cls(entry.path, kind, thing, entry.unknown, checks.document.key_at(path))

    def written(self) -> dict[str, Any]:
        """Return plain values with the keys of scenario files."""
        thing = self.thing if isinstance(self.thing, str) else list(self.thing)
        entry: dict[str, Any] = {"path": self.path, self.kind: thing}
        return entry if self.unknown == _UNKNOWN else {**entry, "unknown": self.unknown}

    @property
    def words(self) -> str:
        """Return what is asked of the nest, for people."""
        thing = self.thing if isinstance(self.thing, str) else point_words(self.thing)
        holder = "in reality" if self.path == "/" else f"as {self.path} believes"
        return f"{self.kind} {thing.replace('_', ' ')}, {holder}"

    def answers(self, look: StateOf, naming: Naming, options: Sequence[str]) -> tuple[str, ...]:
        """Return the right answers: options, or texts if there are no options.

        An item that is believed to be in several places has several right answers.

        Raises:
            ScenarioError: An answer is none of the options, or all options are right, or the agent
                is near no named place.
        """
        beliefs = self._found(look(self.path), naming)
        if not options:
            texts = [name for each in beliefs for name in each.names[: 1 if each.ranked else None]]
            return tuple(dict.fromkeys(texts))
        right = dict.fromkeys(self._option(each, options) for each in beliefs)
        if len(right) == len(options):
            raise self._fault("all options are right; give one that is not")
        return tuple(option for option in options if option in right)

    def accepted(self, right: Sequence[str]) -> tuple[str, ...]:
        """Return texts of a right answer in words: those given, and other words for `unknown`."""
        return (*right, *_NOT_KNOWN) if _UNKNOWN in right else tuple(right)

    def place(self, look: StateOf, naming: Naming) -> Point:
        """Return the one place of an item or agent; containers have the place of their block.

        Raises:
            ScenarioError: The place is unknown, or there are several.
        """
        beliefs = self._found(look(self.path), naming)
        places = [each.place for each in beliefs if each.place is not None]
        if len(places) != 1:
            listed_names = listed([each.names[0] for each in beliefs])
            raise self._fault(f"needs one place, but the belief is: {listed_names}")
        return places[0]

    def _option(self, belief: _Found, options: Sequence[str]) -> str:
        for name in (*belief.names, *belief.written):
            alike = [option for option in options if bare_words(option) == bare_words(name)]
            if len(alike) == 1:
                return alike[0]
        raise self._fault(
            f"the right answer is {quoted(belief.names[0])}, which is none of the options "
            f"{', '.join(options)}; add it{_alike(belief.names, options)}"
        )

    def _found(self, state: State, naming: Naming) -> list[_Found]:
        match self.kind, self.thing:
            case "item", str(name):
                beliefs = list(_located(state, naming, name))
            case "agent", str(name):
                beliefs = list(self._standing(state, naming, name))
            case "container", (int(), int(), int()) as at:
                content = state.containers.get(at)
                is_known = content is not None and (content.items or content.complete)
                beliefs = [_Found(content_names(content.items))] if content and is_known else []
            case "sign", (int(), int(), int()) as at:
                text = state.signs.get(at)
                said = () if text is None else (sign_words(text),) if text else ("nothing", "blank")
                beliefs = [_Found(said)] if said else []
            case _, (int(), int(), int()) as at:
                beliefs = list(_stated(state, at))
            case _:
                raise AssertionError(self.kind)
        return beliefs or [_Found((self.unknown,))]

    def _standing(self, state: State, naming: Naming, agent: str) -> Iterator[_Found]:
        feet = state.agents[agent].position
        if feet is None:
            return
        names = [
            *names_near(feet, {at: name for name, at in naming.places.items()}),
            *names_near(feet, naming.objects),
        ]
        if not names:
            raise self._fault(
                f"{agent} is believed at {point_words(feet)}, which is within {NEAR:g} blocks of "
                "nothing with a name in this belief; name a place in 'places' whose ground it knows"
            )
        written = tuple(names_near(feet, naming.written))
        yield _Found(tuple(names), ranked=True, place=feet, written=written)

    def _fault(self, message: str) -> ScenarioError:
        return ScenarioError(f"{self.where}{message}")


def _alike(names: Sequence[str], options: Sequence[str]) -> str:
    if shared := [each for each in options if names[0].endswith(f" {each}")]:
        return f"; several things are labelled {quoted(shared[0])}: give each a label of its own"
    close = [each for name in names for each in difflib.get_close_matches(name, options, 1, 0.8)]
    return f", or mend {quoted(close[0])}" if close else ""


def _located(state: State, naming: Naming, item: str) -> Iterator[_Found]:
    """Yield the containers, agents and places that have an item."""
    for at, content in state.containers.items():
        if content.items.get(item):
            words = point_words(at)
            written = (naming.written[at],) if at in naming.written else ()
            unlabelled = () if at in naming.labelled else (words,)
            yield _Found((naming.objects.get(at, words), *unlabelled), place=at, written=written)
    for name, agent in state.agents.items():
        if agent.inventory.get(item) or item in (agent.equipment or {}).values():
            yield _Found((name,), place=agent.position)
    for dropped in state.items.values():
        if dropped.name == item:
            near = names_near(dropped.position, {at: n for n, at in naming.places.items()})
            yield _Found(("floor", "ground", *near), place=dropped.position)


def content_names(items: Collection[str]) -> tuple[str, ...]:
    """Return texts that name what is in a container, the best first."""
    if not items:
        return _EMPTY
    words = [name.replace("_", " ") for name in sorted(items)]
    plural = [f"{word}s" for word in words]
    return (listed(words), listed(plural), *(items if len(words) == 1 else ()))


def _stated(state: State, at: Position) -> Iterator[_Found]:
    block = state.blocks[at]
    if block is None:
        return
    name, properties = block_name(block), parse_state(block)[1]
    if is_door(name):
        yield _Found(("open",) if properties.get("open") == "true" else ("shut", "closed"))
    elif is_switch(name):
        yield _Found(("on",) if properties.get("powered") == "true" else ("off",))
    else:
        yield _Found((name.replace("_", " "), name, block))


def bare_words(text: str) -> list[str]:
    """Return the words that distinguish an option."""
    words = re.findall(r"[\w'.-]+", text.replace("_", " ").replace("\u2019", "'").casefold())
    return [word.rstrip(".") for word in words if word not in _SMALL] or words
