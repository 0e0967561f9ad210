"""Expectations about probes that are judged by the run of a program."""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from beliefnest.errors import ScenarioError
from beliefnest.facts.kinds import WITHIN, StatedFact, middle_of
from beliefnest.facts.states import StateFacts
from beliefnest.nest.past.setting import Setting
from beliefnest.scenarios.believed import Believed, BelievedEntry, StateOf
from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import KeyPath
from beliefnest.scenarios.expected import (
    Deed,
    Expected,
    ExpectEntry,
    Judgement,
    ProbeFacts,
    as_list,
    expected_fact,
    source_of,
)
from beliefnest.scenarios.naming import Naming, container_name, place_name
from beliefnest.scenarios.trial import NamedFunction, Trial, function_of
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.limits import AGENT_SLOTS
from beliefnest.world.values import Items, Point, Position, block_at
from beliefnest.world.words import items_words, point_text, point_words, with_the


@dataclass(frozen=True, slots=True)
class Awaited(Deed):
    """Expectation about the place where a simulator believes an item or agent; not yet computed.

    Attributes:
        key: Its key: `opens`, `arrives` or `intends`.
        believed: The belief that gives the place.
        within: Greatest distance from there, in blocks.
        containers: Containers of the scenario, with the positions of their blocks.
    """

    ground = "a place that a simulator believes in"
    key: str
    believed: Believed
    within: float
    containers: Mapping[Position, frozenset[Position]]

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
            forms = " or ".join(f"{{path: {believed.path}, {kind}: ...}}" for kind in kinds)
            raise checks.fault((*path, key), f"needs a place; write one, or {forms}")
        containers = {place: checks.halves(place) for place in checks.snapshot.containers}
        return cls(key, believed, entry.within, containers)

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Awaited"]:
        for key in ("opens", "arrives", "intends"):
            if isinstance(getattr(entry, key), BelievedEntry):
                yield cls.of(key, entry, path, checks)

    def written(self) -> dict[str, Any]:
        return {self.key: self.believed.written()}

    def resolved(self, look: StateOf, naming: Naming) -> "Expected":
        place = self.believed.place(look, naming)
        match self.key:
            case "opens":
                if block_at(place) not in self.containers:
                    raise ScenarioError(
                        f"{self.believed.where}needs a container, but the item is believed at "
                        f"{point_text(place)}"
                    )
                return Opens(block_at(place), self.believed)
            case "arrives":
                return Arrives(place, self.within, self.believed)
            case _:
                blocks = self.containers.get(block_at(place), frozenset())
                return Intends(place, self.within, blocks, self.believed)

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
            yield cls(checks.container((*path, "opens"), entry.opens))

    def written(self) -> dict[str, Any]:
        return {"opens": list(self.container), **source_of("opens", self.believed)}

    def judge(self, trial: Trial) -> Judgement:
        first = trial.opened[:1]
        deed = f"opened {point_words(first[0])} first" if first else "opened nothing"
        return self.verdict(first == (self.container,), deed, by_deed=bool(first))

    def told(self, judged: Judgement, outcome: ProbeFacts, setting: Setting, *, alone: bool) -> str:
        opened = container_name(outcome.opened[0], setting) if outcome.opened else "nothing"
        return opened if alone else f"opens {opened}"

    def account(self, judged: Judgement, outcome: ProbeFacts, setting: Setting, agent: str) -> str:
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
    within: float = WITHIN
    believed: Believed | None = None

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Arrives"]:
        if entry.arrives is not None and not isinstance(entry.arrives, BelievedEntry):
            yield cls(entry.arrives, entry.within)

    def written(self) -> dict[str, Any]:
        entry = {"arrives": list(self.place), "within": self.within}
        return entry | source_of("arrives", self.believed)

    def judge(self, trial: Trial) -> Judgement:
        arrived = trial.arrived
        ok = arrived is not None and math.dist(middle_of(self.place), arrived) <= self.within
        deed = "is nowhere" if arrived is None else f"ended at {point_words(arrived)}"
        return self.verdict(ok, deed)

    def told(self, judged: Judgement, outcome: ProbeFacts, setting: Setting, *, alone: bool) -> str:
        where = "nowhere" if outcome.arrived is None else point_text(outcome.arrived)
        return where if alone else f"arrives at {where}"

    def account(self, judged: Judgement, outcome: ProbeFacts, setting: Setting, agent: str) -> str:
        where, far = "nowhere", ""
        if outcome.arrived is not None:
            where = f"at {place_name(outcome.arrived, setting)}"
            far = f", {math.dist(outcome.arrived, middle_of(self.place)):.1f} blocks from there"
        return (
            f"Judged by where {agent} stands in the end: {where}; expected was "
            f"at {place_name(self.place, setting)}, within {self.within:g} blocks{far}; "
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
        blocks: Block positions of the container that is there, both halves of a double chest; none
            if no container is there.
        believed: The belief that gave the place; None: the scenario gives it.
    """

    ground = "what the program makes for"
    place: Point
    within: float = WITHIN
    blocks: frozenset[Position] = frozenset()
    believed: Believed | None = None

    @property
    def explained(self) -> Position | None:
        return block_at(self.place) if self.blocks else None

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Intends"]:
        if entry.intends is not None and not isinstance(entry.intends, BelievedEntry):
            yield cls(entry.intends, entry.within, checks.halves(block_at(entry.intends)))

    def written(self) -> dict[str, Any]:
        entry = {"intends": list(self.place), "within": self.within}
        return entry | source_of("intends", self.believed)

    def judge(self, trial: Trial) -> Judgement:
        intended = trial.intended
        deed = f"made for {'nothing' if intended is None else point_words(intended)}"
        return self.verdict(self._met(trial), deed, by_deed=intended is not None)

    def _met(self, trial: Trial) -> bool:
        used, walked = trial.used, trial.walked
        if used and block_at(used[0]) in (self.blocks or {block_at(self.place)}):
            return True
        if self.blocks and used:
            return False
        return bool(walked) and math.dist(block_at(walked[-1]), block_at(self.place)) <= self.within

    def told(self, judged: Judgement, outcome: ProbeFacts, setting: Setting, *, alone: bool) -> str:
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
        deed = f"took {items_words(taken, ids=True) or 'nothing'}"
        return self.verdict(ok, deed, by_deed=bool(taken))


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
class Believes(Deed):
    """Expectation: a simulator has an expected state at the end of a probe's program."""

    many = True
    ground = "what is believed once the program has ended"
    expectation: StatedFact

    @property
    def wanted(self) -> str:
        return self.expectation.label or f"{self.expectation.simulator} as expected"

    @property
    def paths(self) -> tuple[str, ...]:
        return (self.expectation.simulator,)

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Believes"]:
        for number, each in enumerate(as_list(entry.believes)):
            yield cls(expected_fact(each, (*path, "believes", number), checks))

    def written(self) -> dict[str, Any]:
        return {"believes": [self.expectation.written()]}

    def judge(self, trial: Trial) -> Judgement:
        expectation = self.expectation
        instead = expectation.fact.instead(StateFacts(trial.belief(expectation.simulator)))
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
