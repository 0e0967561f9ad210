"""Expectations about probes: their form in files, their judgement, and their words.

Each kind is a class that reads, judges, describes and writes itself. To add a kind, add its keys to
`ExpectEntry`, and its class to `KINDS`.
"""

import math
import re
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Protocol, TypeVar

import msgspec

from beliefnest.errors import ScenarioError
from beliefnest.nest.past.setting import Setting
from beliefnest.scenarios.believed import Believed, BelievedEntry, Look
from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import KeyPath
from beliefnest.scenarios.expected_state import Expectation, ExpectationEntry
from beliefnest.scenarios.functions import NamedFunction, function_of
from beliefnest.scenarios.naming import container_name, named_place, point_text
from beliefnest.scenarios.trial import Trial
from beliefnest.world import forms
from beliefnest.world.forms import note
from beliefnest.world.limits import AGENT_SLOTS
from beliefnest.world.values import EventKind, Items, Point, Position, block_at
from beliefnest.world.words import items_words, listed, point_words, with_the

__all__ = [
    "Answers",
    "AnswersEntry",
    "Arrives",
    "Awaited",
    "Believes",
    "Deed",
    "ExpectEntry",
    "Expected",
    "InferredEntry",
    "Infers",
    "Intends",
    "Judge",
    "Judgement",
    "Opens",
    "Says",
    "Takes",
    "expected_json",
    "read_expected",
    "read_inferred",
]

T = TypeVar("T")


class Answered(Protocol):
    """Reply to a question, as `Reply` has it."""

    @property
    def question(self) -> str: ...
    @property
    def answer(self) -> str | None: ...


class Happened(Protocol):
    """Facts of a probe with which expectations are told, as `ProbeOutcome` has them."""

    @property
    def opened(self) -> tuple[Position, ...]: ...
    @property
    def arrived(self) -> Point | None: ...
    @property
    def intended(self) -> Point | None: ...
    @property
    def replies(self) -> Sequence[Answered]: ...


_MOST_OPTIONS = 26
"""Greatest number of options: one for each letter."""


class AnswersEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A question to the model, and its right answers."""

    question: Annotated[str, note("The question.", "text")]
    right: Annotated[
        str | list[str] | BelievedEntry,
        note(
            "Right answers; a right answer in words contains one of them. `believed`: the answer "
            "that a simulator holds.",
            "[text]",
        ),
    ]
    options: Annotated[
        list[str],
        note("Options to choose from, shuffled by the seed; empty: an answer in words.", "[text]"),
    ] = []
    wrong: Annotated[
        list[str], note("Texts that an answer in words must not contain.", "[text]")
    ] = []
    reason: Annotated[
        bool, note("True if the model is also asked for a reason, which is recorded.", "keep")
    ] = False


class InferredEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Bounds of a posterior mean: above a value, below a value, or both."""

    above: Annotated[float | str | None, note("A number, or a factor with a lower mean.")] = None
    below: Annotated[float | str | None, note("A number, or a factor with a higher mean.")] = None


class ExpectEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Expectations about a probe: at least one of these; all of them must hold."""

    opens: Annotated[
        forms.Position | BelievedEntry | None,
        note(
            "The container that the agent opens first; `believed`: that in which a simulator "
            "believes an item.",
            "block",
        ),
    ] = None
    arrives: Annotated[
        forms.Point | BelievedEntry | None, note("Place of the agent at the end.", "point")
    ] = None
    intends: Annotated[
        forms.Point | BelievedEntry | None,
        note(
            "Container or place that the program heads for, even if it never gets there.", "place"
        ),
    ] = None
    within: Annotated[forms.Within, note("Greatest distance from there, in blocks.", "keep")] = 2.0
    takes: Annotated[
        dict[str, int] | None,
        note("Counts of items that the agent takes out of containers.", "items"),
    ] = None
    says: Annotated[str | None, note("Part of an utterance of the agent.", "text")] = None
    answers: Annotated[
        AnswersEntry | list[AnswersEntry] | None, note("Questions to the model and right answers.")
    ] = None
    believes: Annotated[
        ExpectationEntry | list[ExpectationEntry] | None,
        note("Content of a belief after the program has ended."),
    ] = None
    inferred: Annotated[
        dict[str, InferredEntry] | None,
        note("Expected posterior means by factor, such as utility.K or credence.L.", "keep"),
    ] = None
    function: Annotated[
        Any,
        note(
            "module:function of the trial; it is imported and run, so use only trusted code. "
            "In code, the function itself."
        ),
    ] = None


class Expected(ABC):
    """Expectation about a probe.

    Attributes:
        verb: Verb of the agent in the heading of a table.
        many: True if a probe can have several of this kind; then values are lists or mappings.
    """

    __slots__ = ()
    verb: ClassVar[str] = "does"
    many: ClassVar[bool] = False

    @property
    @abstractmethod
    def ground(self) -> str:
        """Return what the expectation is judged by, in words."""

    def resolved(self, look: Look, setting: Setting) -> "Expected":
        """Return the expectation with the values that the nest computes.

        Args:
            look: Function from a belief path to the state after the script.
            setting: Setting with names of places.

        Raises:
            ScenarioError: A belief gives no such value; the message names file, line and key.
        """
        return self

    @property
    def explained(self) -> Position | None:
        """Return the container that the belief behind a program is about; None: none."""
        return None

    @property
    def paths(self) -> tuple[str, ...]:
        """Return the paths of the beliefs that judging reads."""
        return ()

    @classmethod
    @abstractmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Expected"]:
        """Yield the expectations of this kind in an entry.

        Raises:
            ScenarioError: The entry is not consistent; the message names file, line and key.
        """

    @abstractmethod
    def written(self) -> dict[str, Any]:
        """Return plain values with the keys of scenario files."""

    def verdict(self, ok: bool, found: str, *, by_deed: bool = False) -> "Judgement":
        """Return the judgement of this expectation.

        Args:
            ok: True if it holds.
            found: What happened instead, for people.
            by_deed: True if something else was done, or said in answer.
        """
        if ok:
            return Judgement(self, ok=True, outcome="ok")
        return Judgement(self, ok=False, why_not=found, outcome="wrong" if by_deed else None)

    @property
    def wanted(self) -> str:
        """Return what is expected, for a table."""
        return self.ground

    def told(self, judged: "Judgement", outcome: Happened, setting: Setting, *, alone: bool) -> str:
        """Return what happened, for a table.

        Args:
            judged: The judgement.
            outcome: Outcome of the probe.
            setting: Setting with names of places.
            alone: True if the heading has the verb.
        """
        return self.wanted if judged.ok else judged.why_not

    def account(self, judged: "Judgement", outcome: Happened, setting: Setting, agent: str) -> str:
        """Return a sentence that says on what grounds the expectation holds or does not.

        Args:
            judged: The judgement.
            outcome: Outcome of the probe.
            setting: Setting with names of places.
            agent: Name of the agent.
        """
        told = "" if judged.ok else f": {judged.why_not}"
        return f"Judged by {self.ground}; that is {judged.words}{told}."


@dataclass(frozen=True, slots=True)
class Judgement:
    """Judgement of one expectation of a probe.

    Attributes:
        expected: The expectation.
        ok: True if it holds.
        why_not: What happened instead, for people; empty if `ok`.
        outcome: One of `judging.OUTCOMES`; None: not ok, and the end of the program decides.
    """

    expected: Expected
    ok: bool
    why_not: str = ""
    outcome: str | None = None

    @property
    def words(self) -> str:
        """Return the judgement in words."""
        return "as expected" if self.ok else "not as expected"


class Deed(Expected):
    """Expectation that is judged by a program's run."""

    __slots__ = ()

    def check(self) -> None:
        """Check before a run that the expectation can be judged.

        Raises:
            InputError: It cannot.
        """

    @abstractmethod
    def judge(self, trial: Trial) -> Judgement:
        """Judge the run of a program."""


@dataclass(frozen=True, slots=True)
class Awaited(Deed):
    """Expectation about the place where a simulator believes an item or agent; not yet computed.

    Attributes:
        key: Its key: `opens`, `arrives` or `intends`.
        believed: The belief that gives the place.
        within: Greatest distance from there, in blocks.
        containers: Containers of the scenario.
    """

    ground = "a place that a simulator believes in"
    key: str
    believed: Believed
    within: float
    containers: frozenset[Position]

    @property
    def paths(self) -> tuple[str, ...]:
        return (self.believed.path,)

    @classmethod
    def of(cls, key: str, entry: ExpectEntry, path: KeyPath, checks: Checks) -> "Awaited":
        """Return the expectation of an entry whose place a simulator gives.

        Raises:
            ScenarioError: The entry is not consistent, or asks for something that has no place.
        """
        believed = Believed.read(getattr(entry, key), (*path, key), checks)
        kinds = ("item",) if key == "opens" else ("item", "agent")
        if believed.kind not in kinds:
            raise checks.fault((*path, key), f"needs a place; give {' or '.join(kinds)}")
        return cls(key, believed, entry.within, frozenset(checks.snapshot.containers))

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Awaited"]:
        for key in ("opens", "arrives", "intends"):
            if isinstance(getattr(entry, key), BelievedEntry):
                yield cls.of(key, entry, path, checks)

    def written(self) -> dict[str, Any]:
        return {self.key: self.believed.written()}

    def resolved(self, look: Look, setting: Setting) -> "Expected":
        place = self.believed.place(look, setting)
        match self.key:
            case "opens":
                if block_at(place) not in self.containers:
                    raise ScenarioError(
                        f"{self.believed.where}needs a container, but the item is believed "
                        f"{named_place(place, setting)}"
                    )
                return Opens(block_at(place), self.believed)
            case "arrives":
                return Arrives(place, self.within, self.believed)
            case _:
                return Intends(
                    place, self.within, block_at(place) in self.containers, self.believed
                )

    def judge(self, trial: Trial) -> Judgement:
        raise AssertionError("the expectation is resolved before a program runs")


@dataclass(frozen=True, slots=True)
class Opens(Deed):
    """Expectation: the program opens this container before any other.

    Attributes:
        container: The container.
        believed: The belief that gave it; None: the scenario gives it.
    """

    verb = "opens"
    ground = "the container that the agent opens first"
    container: Position
    believed: Believed | None = None

    @property
    def explained(self) -> Position | None:
        return self.container

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Opens"]:
        if entry.opens is not None and not isinstance(entry.opens, BelievedEntry):
            checks.container((*path, "opens"), entry.opens)
            yield cls(entry.opens)

    def written(self) -> dict[str, Any]:
        return {"opens": list(self.container), **_source("opens", self.believed)}

    def judge(self, trial: Trial) -> Judgement:
        first = trial.opened[:1]
        found = f"opened {point_words(first[0])} first" if first else "opened nothing"
        return self.verdict(first == (self.container,), found, by_deed=bool(first))

    def told(self, judged: Judgement, outcome: Happened, setting: Setting, *, alone: bool) -> str:
        opened = container_name(outcome.opened[0], setting) if outcome.opened else "nothing"
        return opened if alone else f"opens {opened}"

    def account(self, judged: Judgement, outcome: Happened, setting: Setting, agent: str) -> str:
        opened = with_the(container_name(outcome.opened[0], setting)) if outcome.opened else "none"
        return (
            f"Judged by the container that {agent} opens first, in the world and not in the "
            f"model's words: it is {opened}, expected was "
            f"{with_the(container_name(self.container, setting))}; that is {judged.words}."
        )


@dataclass(frozen=True, slots=True)
class Arrives(Deed):
    """Expectation: the program brings its agent to a place.

    Attributes:
        place: Middle of the feet, in blocks.
        within: Greatest distance from there, in blocks.
        believed: The belief that gave the place; None: the scenario gives it.
    """

    verb = "arrives at"
    ground = "where the agent stands in the end"
    place: Point
    within: float = 2.0
    believed: Believed | None = None

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Arrives"]:
        if entry.arrives is not None and not isinstance(entry.arrives, BelievedEntry):
            yield cls(entry.arrives, entry.within)

    def written(self) -> dict[str, Any]:
        told = {"arrives": list(self.place), "within": self.within}
        return told | _source("arrives", self.believed)

    def judge(self, trial: Trial) -> Judgement:
        arrived = trial.arrived
        ok = arrived is not None and math.dist(self.place, arrived) <= self.within
        found = "is nowhere" if arrived is None else f"ended at {point_words(arrived)}"
        return self.verdict(ok, found)

    def told(self, judged: Judgement, outcome: Happened, setting: Setting, *, alone: bool) -> str:
        where = "nowhere" if outcome.arrived is None else point_text(outcome.arrived)
        return where if alone else f"arrives at {where}"

    def account(self, judged: Judgement, outcome: Happened, setting: Setting, agent: str) -> str:
        where, far = "nowhere", ""
        if outcome.arrived is not None:
            where = named_place(outcome.arrived, setting)
            far = f", {math.dist(outcome.arrived, self.place):.1f} blocks from there"
        return (
            f"Judged by where {agent} stands in the end: {where}; expected was "
            f"{named_place(self.place, setting)}, within {self.within:g} blocks{far}; "
            f"that is {judged.words}."
        )


@dataclass(frozen=True, slots=True)
class Intends(Deed):
    """Expectation: the program heads for a place, even if it does not get there.

    The judgement uses the program's calls, never its words. It holds if the first block or agent
    that the program asked to use is at the place. If the place is no container, or the program
    asked to use nothing, it holds if the last goal of a walk is near the place.

    Attributes:
        place: A container or another place, in blocks.
        within: Greatest distance of a walk's goal from the place, in blocks.
        is_container: True if a container of the scenario is there.
        believed: The belief that gave the place; None: the scenario gives it.
    """

    ground = "what the program makes for"
    place: Point
    within: float = 2.0
    is_container: bool = False
    believed: Believed | None = None

    @property
    def explained(self) -> Position | None:
        return block_at(self.place) if self.is_container else None

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Intends"]:
        if entry.intends is not None and not isinstance(entry.intends, BelievedEntry):
            is_container = entry.intends in checks.snapshot.containers
            yield cls(entry.intends, entry.within, is_container)

    def written(self) -> dict[str, Any]:
        told = {"intends": list(self.place), "within": self.within}
        return told | _source("intends", self.believed)

    def judge(self, trial: Trial) -> Judgement:
        intended = trial.intended
        found = f"made for {'nothing' if intended is None else point_words(intended)}"
        return self.verdict(self._met(trial), found, by_deed=intended is not None)

    def _met(self, trial: Trial) -> bool:
        used, walked = trial.used, trial.walked
        if used and block_at(used[0]) == block_at(self.place):
            return True
        if self.is_container and used:
            return False
        return bool(walked) and math.dist(block_at(walked[-1]), block_at(self.place)) <= self.within

    def told(self, judged: Judgement, outcome: Happened, setting: Setting, *, alone: bool) -> str:
        if outcome.intended is None:
            return "makes for nothing"
        place = block_at(outcome.intended)
        labelled = place in setting.labels
        where = container_name(place, setting) if labelled else point_text(outcome.intended)
        return f"makes for {where}"


@dataclass(frozen=True, slots=True)
class Takes(Deed):
    """Expectation: the program takes at least these items out of containers.

    Attributes:
        items: Counts by item name.
    """

    ground = "what the agent takes out of containers"
    items: Items

    @property
    def wanted(self) -> str:
        return f"takes {items_words(self.items, ids=True)}"

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Takes"]:
        if entry.takes is None:
            return
        if not entry.takes:
            raise checks.fault((*path, "takes"), "name at least one item")
        checks.items((*path, "takes"), entry.takes, AGENT_SLOTS, "an inventory")
        yield cls(dict(entry.takes))

    def written(self) -> dict[str, Any]:
        return {"takes": dict(self.items)}

    def judge(self, trial: Trial) -> Judgement:
        taken: Counter[str] = Counter()
        for event in trial.result.events:
            if event.kind is EventKind.GET_ITEM_FROM_CHEST and event.actor == trial.agent:
                taken.update(event.detail["items"])
        ok = all(taken[name] >= count for name, count in self.items.items())
        found = f"took {items_words(taken, ids=True) or 'nothing'}"
        return self.verdict(ok, found, by_deed=bool(taken))


@dataclass(frozen=True, slots=True)
class Says(Deed):
    """Expectation: the program says or whispers something.

    Attributes:
        text: Part of an utterance; case does not matter.
    """

    ground = "what the agent says"
    text: str

    @property
    def wanted(self) -> str:
        return f"says {self.text!r}"

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Says"]:
        if entry.says is None:
            return
        if not entry.says.strip():
            raise checks.fault((*path, "says"), "is empty; give part of an utterance")
        yield cls(entry.says)

    def written(self) -> dict[str, Any]:
        return {"says": self.text}

    def judge(self, trial: Trial) -> Judgement:
        said = [line for _, line in trial.result.said]
        ok = any(self.text.casefold() in line.casefold() for line in said)
        return self.verdict(ok, f"said {said[-1]!r}" if said else "said nothing")


@dataclass(frozen=True, slots=True)
class Answers(Expected):
    """Expectation: the model answers a question, in words or by choosing an option.

    Attributes:
        question: The question.
        right: Right answers. An answer in words is right if it contains one of them as whole
            words, in any case, and none of `wrong`.
        options: Options to choose from, shuffled by the seed; empty: an answer in words.
        wrong: Texts that a right answer in words must not contain.
        reason: True if the model is also asked for a reason.
        believed: The belief that gives the right answers; None: the scenario gives them. `right` is
            empty until the nest has computed them.
    """

    many = True
    ground = "the model's answer to the question"
    question: str
    right: tuple[str, ...]
    options: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()
    reason: bool = False
    believed: Believed | None = None

    @property
    def paths(self) -> tuple[str, ...]:
        return () if self.believed is None else (self.believed.path,)

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Answers"]:
        for number, each in enumerate(_listed(entry.answers)):
            place = (*path, "answers", number)
            right: tuple[str, ...] = ()
            believed = None
            if isinstance(each.right, BelievedEntry):
                believed = Believed.read(each.right, (*place, "right"), checks)
            else:
                right = (each.right,) if isinstance(each.right, str) else tuple(each.right)
            found = cls(
                each.question,
                right,
                tuple(each.options),
                tuple(each.wrong),
                each.reason,
                believed,
            )
            for key, message in found._faults():
                raise checks.fault((*place, *key), message)
            yield found

    def _faults(self) -> Iterator[tuple[KeyPath, str]]:
        right, options = self.right, self.options
        given = self.believed is not None or (right and all(each.strip() for each in right))
        if not self.question.strip() or not given:
            yield (), "give a question and at least one right answer"
        missing = [each for each in right if each not in options]
        if options and missing:
            yield ("right",), f"{missing[0]!r} is none of the options"
        if len(options) > _MOST_OPTIONS:
            yield ("options",), f"are more than {_MOST_OPTIONS}"
        if len({each.casefold() for each in options}) < len(options):
            yield ("options",), "has an option twice"
        if options and set(right) == set(options):
            yield ("options",), "are all right; give one that is not"
        letters = [each for each in options if len(each.strip()) == 1 and each.isalpha()]
        if letters:
            yield (
                ("options",),
                f"{letters[0]!r} is a single letter, which names an option; write it out",
            )
        both = [each for each in right if each in self.wrong]
        if both:
            yield ("wrong",), f"{both[0]!r} is right as well"
        if options and self.wrong:
            yield ("wrong",), "is for answers in words, without options"

    def written(self) -> dict[str, Any]:
        asked = {
            "question": self.question,
            "right": self._right,
            "options": list(self.options),
            "wrong": list(self.wrong),
            "reason": self.reason,
        }
        if self.right:
            asked |= _source("right", self.believed)
        return {"answers": [asked]}

    @property
    def _right(self) -> list[str] | dict[str, Any]:
        if self.believed is not None and not self.right:
            return self.believed.written()
        return list(self.right)

    def resolved(self, look: Look, setting: Setting) -> "Expected":
        if self.believed is None or self.right:
            return self
        found = replace(self, right=self.believed.answers(look, setting, self.options))
        both = [each for each in found.right if each in self.wrong]
        if both:
            raise ScenarioError(
                f"{self.believed.where}the belief gives {both[0]!r}, which 'wrong' names as well"
            )
        return found

    def judge(self, answer: str | None) -> Judgement:
        """Judge the answer to the question; None: there was no answer."""
        if answer is None:
            return Judgement(self, ok=False, why_not="gave no answer", outcome="no_answer")
        if self.options:
            ok = answer in self.right
        else:
            right = self.right if self.believed is None else self.believed.accepted(self.right)
            named = [any(_has(answer, each) for each in all_) for all_ in (right, self.wrong)]
            ok = named == [True, False]
        return self.verdict(ok, f"answered {answer!r}", by_deed=True)

    def told(self, judged: Judgement, outcome: Happened, setting: Setting, *, alone: bool) -> str:
        answers = {each.question: each.answer for each in outcome.replies}
        return f"answers {answers.get(self.question) or 'nothing'}"

    def account(self, judged: Judgement, outcome: Happened, setting: Setting, agent: str) -> str:
        told = "" if judged.ok else f": {judged.why_not}"
        source = "" if self.believed is None else f" ({self.believed.words}; computed by the nest)"
        right = listed([repr(each) for each in self.right], "or")
        return f"Judged by {self.ground}; right is {right}{source}; that is {judged.words}{told}."


@dataclass(frozen=True, slots=True)
class Believes(Deed):
    """Expectation: a simulator has an expected state at the end of a probe's program."""

    many = True
    ground = "what is believed once the program has ended"
    expectation: Expectation

    @property
    def wanted(self) -> str:
        return self.expectation.label or f"{self.expectation.path} as expected"

    @property
    def paths(self) -> tuple[str, ...]:
        return (self.expectation.path,)

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Believes"]:
        for number, each in enumerate(_listed(entry.believes)):
            yield cls(Expectation.read(each, (*path, "believes", number), checks))

    def written(self) -> dict[str, Any]:
        return {"believes": [self.expectation.written()]}

    def judge(self, trial: Trial) -> Judgement:
        expectation = self.expectation
        instead = expectation.content.instead(trial.belief(expectation.path))
        return self.verdict(instead is None, f"{expectation.where}: {instead}")


@dataclass(frozen=True, slots=True)
class Judge(Deed):
    """Expectation: a Python function accepts the trial.

    Attributes:
        function: Function of the trial; returns True, or False or a text that says why not.
        name: Name in tables.
    """

    ground = "a function of the scenario"
    function: Callable[[Trial], bool | str]
    name: str

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Judge"]:
        if entry.function is not None:
            with checks.document.naming((*path, "function")):
                yield cls(*function_of(entry.function))

    @property
    def wanted(self) -> str:
        return self.name

    def check(self) -> None:
        if isinstance(self.function, NamedFunction):
            self.function.loaded()

    def written(self) -> dict[str, Any]:
        return {"function": self.name}

    def judge(self, trial: Trial) -> Judgement:
        try:
            answer: object = self.function(trial)
        except Exception as error:  # noqa: BLE001  # a user's function may raise anything; report it
            answer = None
            said = f"{self.name} raised {type(error).__name__}: {error}"
        else:
            said = f"{self.name} returned {answer!r}; it returns True, False or a text"
        if not isinstance(answer, bool | str):
            return Judgement(self, ok=False, why_not=said, outcome="error")
        said = answer if isinstance(answer, str) else f"{self.name} says no"
        return self.verdict(answer is True, said)


@dataclass(frozen=True, slots=True)
class Infers(Expected):
    """Expectation about the posterior mean of a factor: above or below something.

    Attributes:
        factor: The factor, such as `utility.K`.
        above: A number, or another factor whose mean is lower; None: any.
        below: A number, or another factor whose mean is higher; None: any.
    """

    many = True
    factor: str
    above: float | str | None = None
    below: float | str | None = None

    @property
    def ground(self) -> str:
        return f"the posterior mean of {self.factor}"

    @property
    def factors(self) -> list[str]:
        """Return the factors that the expectation names."""
        return [each for each in (self.factor, *self._bounds.values()) if isinstance(each, str)]

    @property
    def _bounds(self) -> dict[str, float | str]:
        bounds = {"above": self.above, "below": self.below}
        return {word: bound for word, bound in bounds.items() if bound is not None}

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Infers"]:
        if entry.inferred is not None:
            raise checks.fault((*path, "inferred"), "is for probes that infer; give 'infer', too")
        yield from ()

    def written(self) -> dict[str, Any]:
        return {"inferred": {self.factor: self._bounds}}

    def judge(self, means: Mapping[str, float], impossible: str | None) -> Judgement:
        """Judge inferred means; `impossible` is the reason why no hypothesis explains them."""
        instead = impossible or self._instead(means)
        return self.verdict(instead is None, instead or "", by_deed=True)

    def _instead(self, means: Mapping[str, float]) -> str | None:
        mean = means[self.factor]
        for word, bound in self._bounds.items():
            number = means[bound] if isinstance(bound, str) else bound
            if not (mean > number if word == "above" else mean < number):
                told = f"{bound} ({number:.3g})" if isinstance(bound, str) else f"{number:g}"
                return f"{self.factor} is {mean:.3g}, not {word} {told}"
        return None


KINDS: tuple[type[Expected], ...] = (
    Infers,
    Awaited,
    Opens,
    Arrives,
    Intends,
    Takes,
    Says,
    Answers,
    Believes,
    Judge,
)
"""Kinds, in the order in which a probe's expectations are read and judged."""


def read_expected(entry: ExpectEntry, path: KeyPath, checks: Checks) -> tuple[Expected, ...]:
    """Return the expectations of a probe that asks a model.

    Raises:
        ScenarioError: The entry is not consistent; the message names file, line and key.
    """
    found = tuple(each for kind in KINDS for each in kind.read(entry, path, checks))
    if not found:
        keys = [key for key in entry.__struct_fields__ if key not in ("within", "inferred")]
        raise checks.fault(path, f"expects nothing; give at least one of {', '.join(keys)}")
    return found


def read_inferred(
    entry: ExpectEntry, path: KeyPath, checks: Checks, factors: Sequence[str]
) -> tuple[Infers, ...]:
    """Return the expectations of a probe that infers.

    Args:
        entry: The entry.
        path: Its place in the document.
        checks: Checks of the document.
        factors: Factors of the model.

    Raises:
        ScenarioError: A factor is not in the model, or has no bounds, or a model is asked.
    """
    for key in entry.__struct_fields__:
        if key not in ("inferred", "within") and getattr(entry, key) is not None:
            raise checks.fault((*path, key), "is for probes that ask a model; give 'inferred'")
    path = (*path, "inferred")
    if not entry.inferred:
        raise checks.fault(path, "expects nothing; name a factor, such as utility.K")
    found = []
    for factor, bounds in entry.inferred.items():
        expected = Infers(factor, bounds.above, bounds.below)
        for name in expected.factors:
            if name not in factors:
                raise checks.fault(
                    (*path, factor), f"there is no factor {name!r}; there are {', '.join(factors)}"
                )
        if bounds.above is None and bounds.below is None:
            raise checks.fault((*path, factor), "expects nothing; give above, below or both")
        found.append(expected)
    return tuple(found)


def expected_json(expected: tuple[Expected, ...]) -> dict[str, object] | None:
    """Return the expectations of a probe with the keys of scenario files; None: none."""
    found: dict[str, Any] = {}
    for each in expected:
        for key, value in each.written().items():
            if each.many and key in found:
                found[key] = found[key] | value if key == "inferred" else found[key] + value
            else:
                found[key] = value
    return found or None


def _listed(entry: T | list[T] | None) -> list[T]:
    """Return a value that may be written alone or as a list, as a list."""
    if entry is None:
        return []
    return entry if isinstance(entry, list) else [entry]


def _source(key: str, believed: Believed | None) -> dict[str, Any]:
    """Return the belief that gave a value, under a key of its own; empty: the scenario gave it."""
    return {} if believed is None else {f"{key}_from": believed.written()}


def _has(answer: str, text: str) -> bool:
    """Return True if an answer contains a text as whole words."""
    return re.search(rf"(?<!\w){re.escape(text.casefold())}(?!\w)", answer.casefold()) is not None
