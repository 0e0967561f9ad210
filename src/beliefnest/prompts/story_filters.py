"""Filters that tell what a mind observed, as prose or as rows."""

import itertools
from collections.abc import Iterable, Iterator, Sequence

from beliefnest.prompts import event_rows, text
from beliefnest.prompts.filterset import filter
from beliefnest.prompts.observations import (
    Assumed,
    AssumedAgent,
    Found,
    Happened,
    Lying,
    Observation,
    Outset,
    Read,
    SightChange,
)
from beliefnest.prompts.simulator_view import BranchView
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.event_words import happened
from beliefnest.world.near import BESIDE, names_near
from beliefnest.world.registry import block_name
from beliefnest.world.signs import sign_words
from beliefnest.world.values import Items, Point, Position, block_at, feet_in
from beliefnest.world.words import listed, point_words, things_words, titled, with_the

_ROW_HEADER = "time;what;agent_name;description"
_AT_CONTAINER = (EventKind.GET_ITEM_FROM_CHEST, EventKind.DEPOSIT_ITEM_INTO_CHEST)
_ENDS = (".", "!", "?", ".”", "!”", "?”")


@filter("observations")
def observations(branch: BranchView) -> str:
    """Return what the owner observed, one line each, in the order of time.

    A line is `time;what;agent_name;description`. Actions have the names of their skills; who
    else perceived them is not told. `inside` is the complete contents of a container when the
    owner saw them (`{}`: empty), `assumed` contents, places and possessions of agents that it took
    for granted from the start. A container without such a line was never looked into. `visible`
    and `lastSeen` tell which agents, containers and signs came into sight and went out of it.
    `Not observed` if there is nothing to tell. In the real world each agent's sight is told.
    """
    rows = [row for each in branch.observations for row in _rows(each, branch.state.owner)]
    return "\n".join([_ROW_HEADER, *rows]) if rows else text.NOT_OBSERVED


@filter("beginning")
def beginning(branch: BranchView, narrated: bool = False, coordinates: bool = False) -> str:
    """Return the scene before the first event as prose in the past tense.

    The owner is `you`; with `narrated=true` it is told of by name. In the real world a narrator
    tells everything, with what each agent can see. `coordinates=true` adds positions.
    """
    teller = _Teller(branch, narrated=narrated, coordinates=coordinates)
    return " ".join(teller.scene(_scene(branch.observations)))


@filter("story")
def story(branch: BranchView, narrated: bool = False, coordinates: bool = False) -> str:
    """Return what the owner observed after the beginning, as prose in the past tense.

    Sentences are in the order of events. Arguments as in `beginning`. `Nothing happened.` if
    nothing was observed.
    """
    teller = _Teller(branch, narrated=narrated, coordinates=coordinates)
    all_ = branch.observations
    before = list(_scene(all_))
    return " ".join(teller.course(all_[len(before) :], before)) or "Nothing happened."


def captions(branch: BranchView) -> list[tuple[int, str]]:
    """Return the sentences of `beginning` and `story`, each with the tick that it tells of.

    The first entry is the whole beginning. Sentences are in the order of time.
    """
    all_ = branch.observations
    if not all_:
        return []
    before = list(_scene(all_))
    opening = " ".join(_teller_of(branch).scene(before))
    course = _teller_of(branch).dated_course(all_[len(before) :], before)
    return [*([(all_[0].tick, opening)] if opening else []), *course]


def _teller_of(branch: BranchView) -> "_Teller":
    return _Teller(branch, narrated=False, coordinates=False)


def _scene(observations: Sequence[Observation]) -> Iterator[Observation]:
    """Yield the observations before the first event and the first later change of sight."""
    first = observations[0].tick if observations else 0
    for each in observations:
        if isinstance(each, Happened) or (isinstance(each, SightChange) and each.tick > first):
            return
        yield each


def _rows(each: Observation, owner: str | None) -> Iterator[str]:
    at = each.tick
    match each:
        case Outset(feet=feet, has=has):
            for name, point in feet.items() if owner is None else ():
                yield f"{at};visible;{name};position:{text.point(point)}"
            for name, items in has.items():
                if name != owner:
                    yield f"{at};has;{name};items:{text.mapping(items)}"
        case Assumed(place=place, items=items):
            yield f"{at};assumed;-;chest:{text.position(place)} & items:{text.mapping(items)}"
        case AssumedAgent(name=name, feet=point, has=items):
            facts = [] if point is None else [f"position:{text.point(point)}"]
            facts += [f"items:{text.mapping(items)}"] if items else []
            yield f"{at};assumed;{name};{' & '.join(facts)}"
        case Found(place=place, items=items):
            yield f"{at};inside;-;chest:{text.position(place)} & items:{text.mapping(items)}"
        case Read(place=place, text=words):
            yield f"{at};sign;-;position:{text.position(place)} & text:{sign_words(words)}"
        case Lying(name=name, count=count, position=point):
            lying = text.mapping({name: count})
            yield f"{at};lying;-;position:{text.point(point)} & items:{lying}"
        case SightChange():
            yield from _sight_rows(each, owner)
        case Happened(event=event):
            if not event.kind.is_speech:
                yield event_rows.row(event)


def _sight_rows(sight: SightChange, owner: str | None) -> Iterator[str]:
    seen = (
        ("visible", sight.agents, sight.places),
        ("lastSeen", sight.lost_agents, sight.lost_places),
    )
    for how, agents, places in seen:
        where = ", ".join(map(text.position, places))
        if owner is None and (agents or places):
            names = f"agents:{', '.join(agents)}" if agents else ""
            sights = " & ".join(
                part for part in (names, f"blocks:{where}" if where else "") if part
            )
            word = "sees" if how == "visible" else "seesNoLonger"
            yield f"{sight.tick};{word};{sight.viewer};{sights}"
            continue
        for name, point in agents.items():
            yield f"{sight.tick};{how};{name};position:{text.point(point)}"
        if places:
            yield f"{sight.tick};{how};-;blocks:{where}"


class _Teller:
    """Teller of observations in English.

    Args:
        branch: The simulator.
        narrated: True if the owner is told of by name.
        coordinates: True if positions are told.
    """

    def __init__(self, branch: BranchView, *, narrated: bool, coordinates: bool) -> None:
        self._names = branch.names
        self._places = {at: name for name, at in branch.places.items()}
        self._labels = branch.labels
        self._unique = branch.unique
        self._agents = tuple(sorted(branch.state.agents))
        self._blocks = branch.state.blocks
        self._you = None if narrated else branch.state.owner
        self._owner = branch.state.owner
        self._coordinates = coordinates
        # The actor of the last event and the block that it used: the block is `it` afterwards.
        self._it: tuple[str | None, Position | None] = (None, None)
        self._in_sight: dict[str, set[Position]] = {}

    def scene(self, observations: Iterable[Observation]) -> Iterator[str]:
        """Yield sentences about the beginning."""
        all_ = list(observations)
        sights = [each for each in all_ if isinstance(each, SightChange)]
        contents = [each for each in all_ if isinstance(each, Found)]
        if self._owner is not None:
            yield from self._first_sights(sights)
        for each in all_:
            if not isinstance(each, SightChange | Found):
                yield from self._one(each)
        yield from self._contents(contents)
        yield from self._looks()
        if self._owner is None:
            yield from self._first_sights(sights)

    def course(self, notes: Sequence[Observation], before: Iterable[Observation]) -> Iterator[str]:
        """Yield sentences about what happened, see `dated_course`."""
        return (sentence for _, sentence in self.dated_course(notes, before))

    def dated_course(
        self, observations: Sequence[Observation], before: Iterable[Observation]
    ) -> Iterator[tuple[int, str]]:
        """Yield sentences about what happened, each with its tick.

        Args:
            observations: Observations from the first event on.
            before: Earlier observations.
        """
        for sight in before:
            if isinstance(sight, SightChange):
                self._keep_sight(sight)
        groups = [list(group) for _, group in itertools.groupby(observations, key=_sight_of)]
        for group in groups:
            sights = [sight for sight in group if isinstance(sight, SightChange)]
            if sights:
                yield from ((sights[0].tick, words) for words in self._changes(sights))
                continue
            rest: Iterator[Observation | None] = iter([*group, None])
            each: Observation | None = next(rest)
            while each is not None:
                following = next(rest)
                joined = self._joined(each, following)
                if joined is None:
                    yield from ((each.tick, words) for words in self._one(each))
                else:
                    yield each.tick, joined
                    following = next(rest)
                each = following

    def _joined(self, each: Observation, following: Observation | None) -> str | None:
        """Return one sentence for an opening and a use of the same container; None: they differ."""
        if not isinstance(each, Happened) or not isinstance(following, Happened):
            return None
        opening, use = each.event, following.event
        same = opening.actor == use.actor and (
            opening.detail.get("position") == use.detail.get("position")
        )
        if (
            opening.kind is not EventKind.OPEN_CONTAINER
            or use.kind not in _AT_CONTAINER
            or not same
        ):
            return None
        first = happened(opening, self._subject(opening.actor), self._words(each))
        self._it = (opening.actor, opening.detail.get("position"))
        return _sentence(f"{first} and {happened(use, '', self._words(following))}")

    def _one(self, each: Observation) -> Iterator[str]:
        match each:
            case Happened(event=event):
                yield _sentence(happened(event, self._subject(event.actor), self._words(each)))
                self._it = (event.actor, event.detail.get("position"))
                if each.heard is not None:
                    yield self._common(each.heard, {event.actor}, "heard it")
            case SightChange():
                yield from self._changes([each])
            case Found(place=place, items=items):
                thing = "it" if self._it == (self._owner, place) else self._thing(place)
                yield self._inside(thing, items)
            case Assumed() | AssumedAgent() if what := self._assumed(each):
                yield _sentence(f"{self._subject(self._owner)} took it for granted that {what}")
            case Read(place=place, text=words):
                thing = self._thing(place)
                if words:
                    yield _sentence(f"On {thing} was written: “{sign_words(words)}”")
                else:
                    yield _sentence(f"Nothing was written on {thing}")
            case Lying(name=name, count=count, position=point):
                where = f" {self._near(point)}" if self._near(point) else ""
                yield _sentence(f"On the floor{where} lay {self._things({name: count})}")
            case Outset():
                yield from self._outset(each)

    def _assumed(self, each: Assumed | AssumedAgent) -> str:
        """Return what the owner took for granted, empty if it has no words."""
        if isinstance(each, AssumedAgent):
            where = "" if each.feet is None else self._near(each.feet)
            facts = [f"stood {where}"] if where else []
            facts += [f"had {self._things(each.has)}"] if each.has else []
            return f"{self._subject(each.name)} {' and '.join(facts)}" if facts else ""
        thing, what = self._thing(each.place), self._things(each.items)
        be = "were" if sum(each.items.values()) > 1 else "was"
        return f"{what} {be} in {thing}" if what else f"{thing} was empty"

    def _outset(self, outset: Outset) -> Iterator[str]:
        if self._owner is None:
            yield _sentence(
                f"This is a story about {listed([titled(name) for name in outset.feet])}"
            )
            things = [self._thing(at, mention=True) for at in self._names]
            if things:
                yield _sentence(f"There {'was' if len(things) == 1 else 'were'} {listed(things)}")
        if self._unique:
            singles = [f"one {name.replace('_', ' ')}" for name in sorted(self._unique)]
            yield _sentence(f"There was only {listed(singles)}")
        for name, point in outset.feet.items():
            where = self._near(point)
            if where:
                yield _sentence(f"{self._subject(name)} stood {where}")
        for name, items in outset.has.items():
            yield _sentence(f"{self._subject(name)} had {self._things(items)}")
            knowing = outset.known.get(name, ())
            # Only a narrator knows for sure that nobody knows.
            if knowing or (self._owner is None and len(self._agents) > 1):
                yield self._common(knowing, {name}, "knew that")

    def _first_sights(self, sights: Sequence[SightChange]) -> Iterator[str]:
        """Yield sentences about what can be seen at first."""
        places = {at for each in sights for at in each.places}
        viewers = {each.viewer for each in sights}
        full = [
            len(each.agents) == len(sights) - 1 and len(each.places) == len(places)
            for each in sights
        ]
        if len(sights) > 1 and all(full) and viewers == {*self._agents}:
            things = " and all of these things" if places else ""
            yield _sentence(f"All of them could see one another{things}")
            return
        for each in sights:
            seen = self._seen(each.agents, each.places)
            if not seen:
                continue
            yield _sentence(f"At first {self._object(each.viewer)} could see {listed(seen)}")

    def _changes(self, sights: Sequence[SightChange]) -> Iterator[str]:
        """Yield sentences about changes of sight at one tick."""
        lost = {each.viewer: list(each.lost_agents) for each in sights}
        seen = {each.viewer: list(each.agents) for each in sights}
        seen_before = {each.viewer: set(self._in_sight.get(each.viewer, ())) for each in sights}
        # Begin with the viewer of whom most changes; others are told with it.
        for each in sorted(sights, key=lambda each: -len(lost[each.viewer])):
            gone = set(each.lost_places)
            some = len(gone) > 1 and gone == seen_before[each.viewer]
            things = ["any of the things there"] if some else map(self._thing, each.lost_places)
            parts = [*map(self._object, lost[each.viewer]), *things]
            if parts:
                back = self._mutual(each.viewer, lost)
                nor = f", nor could {listed(back, 'or')} see {self._object(each.viewer)}"
                sentence = f"{self._subject(each.viewer)} could no longer see {listed(parts, 'or')}"
                yield _sentence(sentence + (nor if back else ""))
            lost[each.viewer] = []
            self._keep_sight(each)
        for each in sorted(sights, key=lambda each: -len(seen[each.viewer])):
            parts = self._seen(seen[each.viewer], each.places)
            if parts:
                back = self._mutual(each.viewer, seen)
                also = f", and {listed(back)} could see {self._object(each.viewer)}"
                sentence = f"{self._subject(each.viewer)} could now see {listed(parts)}"
                yield _sentence(sentence + (also if back else ""))
            seen[each.viewer] = []

    def _mutual(self, viewer: str, changed: dict[str, list[str]]) -> list[str]:
        """Remove and return those for whom the same changed about the viewer, if all of them."""
        others = changed[viewer]
        back = [name for name in others if viewer in changed.get(name, ())]
        if not back or len(back) < len(others):
            return []
        for name in back:
            changed[name].remove(viewer)
        return [self._object(name) for name in back]

    def _keep_sight(self, sight: SightChange) -> None:
        in_sight = self._in_sight.setdefault(sight.viewer, set())
        in_sight.difference_update(sight.lost_places)
        in_sight.update(sight.places)

    def _seen(self, agents: Iterable[str], places: Iterable[Position]) -> list[str]:
        return [*map(self._object, agents), *map(self._thing, places)]

    def _contents(self, contents: Sequence[Found]) -> Iterator[str]:
        empty = [self._thing(each.place) for each in contents if not each.items]
        for each in contents:
            if each.items:
                yield self._inside(self._thing(each.place), each.items)
                if each.known is not None:
                    yield self._common(each.known, set(), "knew that")
        if empty:
            yield _sentence(f"{listed(empty)} {'was' if len(empty) == 1 else 'were'} empty")

    def _looks(self) -> Iterator[str]:
        """Yield what containers seem to contain, if prompts may tell it."""
        for at, label in self._labels.items():
            name = self._names.get(at, "")
            if label != name:
                look = label.removeprefix(name).removeprefix(", ")
                yield _sentence(f"{self._thing(at)} {look}")

    def _words(self, each: Happened) -> dict[str, str]:
        event = each.event
        detail, words = event.detail, {}
        if detail.get("items"):
            words["items"] = self._things(detail["items"])
        for key in ("to", "other"):
            if detail.get(key):
                words[key] = self._object(detail[key])
        if detail.get("destination") is not None:
            words["destination"] = self._way_to(detail["destination"]) or "to another place"
        if detail.get("position") is not None:
            again = event.kind in _AT_CONTAINER and self._it == (event.actor, detail["position"])
            words["thing"] = (
                "it"
                if again
                else self._thing(tuple(detail["position"]), detail.get("block") or each.block)
            )
        return words

    def _thing(self, at: Position, block: str | None = None, *, mention: bool = False) -> str:
        name = self._names.get(at)
        state = block or self._blocks[at]
        if name is None:
            kind = "something" if state is None else block_name(state).replace("_", " ")
            words = kind if state is None else f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"
        else:
            words = with_the(name)
        is_placed = self._coordinates and (mention or self._owner is not None or name is None)
        return f"{words} at {text.position(at)}" if is_placed else words

    def _near(self, point: Point) -> str:
        """Return the named place at a point or the thing near it; empty: there is none."""
        at, near = names_near(point, self._places)[:1], names_near(point, self._names)[:1]
        words = [f"at {with_the(name)}" for name in at] or [f"near {with_the(n)}" for n in near]
        return self._located(words, "at", point)

    def _way_to(self, point: Point) -> str:
        """Return the named place or thing at the end of a walk; empty: there is none.

        A walk leads to a thing only if it ends next to it.
        """
        end = feet_in(block_at(point))
        names = names_near(end, self._places) or names_near(end, self._names, BESIDE)
        return self._located([f"to {with_the(name)}" for name in names[:1]], "to", point)

    def _located(self, words: Sequence[str], preposition: str, point: Point) -> str:
        """Return the words for a point, with its coordinates if they are wanted."""
        if not self._coordinates:
            return "".join(words)
        return f"{''.join(words) or preposition} {point_words(point)}"

    def _common(self, those: Sequence[str], without: set[str | None], did: str) -> str:
        """Return a sentence about who else heard or knew something."""
        others = {*self._agents} - without - {self._owner}
        besides = " else" if without else ""
        if not those:
            words = f"nobody{besides} {did}"
        elif len(others) > 1 and others <= {*those}:
            words = f"everybody{besides} {did}"
        else:
            only = "only " if others > {*those} else ""
            words = f"{only}{listed([titled(name) for name in those])} {did}"
        if self._owner is not None:
            words = f"as far as {self._object(self._owner)} knew, {words}"
        return _sentence(words)

    def _things(self, items: Items) -> str:
        return things_words(items, self._unique)

    def _inside(self, thing: str, items: Items) -> str:
        verb = "were" if sum(items.values()) > 1 else "was"
        things = self._things(items)
        return _sentence(f"In {thing} {verb} {things}" if things else f"{thing} was empty")

    def _subject(self, agent: str | None) -> str:
        if agent is None:
            return ""
        return "You" if agent == self._you else titled(agent)

    def _object(self, agent: str) -> str:
        return "you" if agent == self._you else titled(agent)


def _sight_of(each: Observation) -> int | None:
    """Return the tick of a change of sight; None: it is another observation."""
    return each.tick if isinstance(each, SightChange) else None


def _sentence(words: str) -> str:
    words = words[:1].upper() + words[1:]
    return words if words.endswith(_ENDS) else f"{words}."


FILTERS = (beginning, observations, story)
"""Filters of this module."""
