"""Expectations about probes: their form in files, and the base of all kinds.

Each kind is a class that reads, judges, describes and writes itself: in `expected_acts.py` if a
program is judged, in `expected_answers.py` if an answer is, in `expected_kinds.py` if an inference
is. To add a kind, add its keys to `ExpectEntry`, and its class to `KINDS` in `expected_kinds.py`.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, ClassVar, Protocol, TypeVar

import msgspec

from beliefnest.facts.kinds import WITHIN, FactEntry, StatedFact
from beliefnest.facts.reading import check_entry, fact_in
from beliefnest.nest.past.setting import Setting
from beliefnest.scenarios.believed import Believed, BelievedEntry, StateOf
from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import KeyPath
from beliefnest.scenarios.naming import Naming
from beliefnest.scenarios.trial import Trial
from beliefnest.world import forms
from beliefnest.world.forms import note
from beliefnest.world.values import Point, Position

T = TypeVar("T")


class Answered(Protocol):
    """Reply to a question, as `Reply` has it."""

    @property
    def question(self) -> str: ...
    @property
    def answer(self) -> str | None: ...
    @property
    def outcome(self) -> str: ...
    @property
    def why_not(self) -> str: ...


class ProbeFacts(Protocol):
    """Facts of a probe with which expectations are told, as `ProbeOutcome` has them."""

    @property
    def opened(self) -> tuple[Position, ...]: ...
    @property
    def arrived(self) -> Point | None: ...
    @property
    def intended(self) -> Point | None: ...
    @property
    def replies(self) -> Sequence[Answered]: ...


class AnswersEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A question to the model, and its right answers."""

    question: Annotated[str, note("The question.", "text")]
    right: Annotated[
        str | list[str] | BelievedEntry,
        note(
            "Right answers; a right answer in words contains one of them. A path and a "
            "thing: the answer that a simulator holds.",
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


class ExpectationEntry(FactEntry, frozen=True, kw_only=True):
    """An expected fact about a simulator."""

    path: Annotated[str, note("Belief path; / is the real world.", "path")]
    label: Annotated[str, note("A name for tables and overrides.", "keep")] = ""


def expected_fact(entry: ExpectationEntry, path: KeyPath, checks: Checks) -> StatedFact:
    """Return the fact that an entry expects.

    Raises:
        ScenarioError: The entry is no fact, or names something that does not exist.
    """
    fact = fact_in(check_entry(entry, path, checks))
    return StatedFact(fact, checks.belief_path((*path, "path"), entry.path), entry.label)


class ExpectEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Expectations about a probe: at least one of these; all of them must hold."""

    opens: Annotated[
        forms.WrittenPosition | BelievedEntry | None,
        note(
            "The container that the agent opens first; with a path: that in which a simulator "
            "believes an item.",
            "block",
        ),
    ] = None
    arrives: Annotated[
        forms.WrittenPoint | BelievedEntry | None, note("Place of the agent at the end.", "point")
    ] = None
    intends: Annotated[
        forms.WrittenPoint | BelievedEntry | None,
        note(
            "Container or place that the program heads for, even if it never gets there.", "place"
        ),
    ] = None
    within: Annotated[forms.Within, note("Greatest distance from there, in blocks.", "keep")] = (
        WITHIN
    )
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

    def resolved(self, look: StateOf, naming: Naming) -> "Expected":
        """Return the expectation with the values that the nest computes.

        Args:
            look: Function from a belief path to the state after the script.
            naming: Names of things in the text of the probe.

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

    def verdict(self, ok: bool, instead: str, *, by_deed: bool = False) -> "Judgement":
        """Return the judgement of this expectation.

        Args:
            ok: True if it holds.
            instead: What happened instead, for people.
            by_deed: True if something else was done, or said in answer.
        """
        if ok:
            return Judgement(self, ok=True, outcome="ok")
        return Judgement(self, ok=False, why_not=instead, outcome="wrong" if by_deed else None)

    @property
    def wanted(self) -> str:
        """Return what is expected, for a table."""
        return self.ground

    def told(
        self, judged: "Judgement", outcome: ProbeFacts, setting: Setting, *, alone: bool
    ) -> str:
        """Return what happened, for a table.

        Args:
            judged: The judgement.
            outcome: Outcome of the probe.
            setting: Setting with names of places.
            alone: True if the heading has the verb.
        """
        return self.wanted if judged.ok else judged.why_not

    def account(
        self, judged: "Judgement", outcome: ProbeFacts, setting: Setting, agent: str
    ) -> str:
        """Return a sentence that says on what grounds the expectation holds or does not.

        Args:
            judged: The judgement.
            outcome: Outcome of the probe.
            setting: Setting with names of places.
            agent: Name of the agent.
        """
        reason = "" if judged.ok else f": {judged.why_not}"
        return f"Judged by {self.ground}; that is {judged.words}{reason}."


class Judgement(msgspec.Struct, frozen=True):
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


def expected_json(expected: tuple[Expected, ...]) -> dict[str, object] | None:
    """Return the expectations of a probe with the keys of scenario files; None: none."""
    form: dict[str, Any] = {}
    for each in expected:
        for key, value in each.written().items():
            if each.many and key in form:
                form[key] = form[key] | value if key == "inferred" else form[key] + value
            else:
                form[key] = value
    return form or None


def as_list(entry: T | list[T] | None) -> list[T]:
    """Return a value that may be written alone or as a list, as a list."""
    if entry is None:
        return []
    return entry if isinstance(entry, list) else [entry]


def source_of(key: str, believed: Believed | None) -> dict[str, Any]:
    """Return the belief that gave a value, under a key of its own; empty: the scenario gave it."""
    return {} if believed is None else {f"{key}_from": believed.written()}
