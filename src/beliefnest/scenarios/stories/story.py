"""What a story's sentences mean: rooms, containers, agents, and what is done step by step.

Only what is really the case is followed here, as far as the acts need it (an agent has to
be in a room, a thing is taken out of the container it is in). Beliefs are no part of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from beliefnest.errors import InputError
from beliefnest.scenarios.stories.grammar import (
    Entered,
    Exited,
    Line,
    Located,
    Moved,
    Remark,
    Stayed,
    parse_lines,
)

__all__ = ["WAITING_ROOM", "Act", "Come", "Go", "Move", "Place", "Story", "Wait", "read_story"]

WAITING_ROOM = "waiting_room"
"""The room that shows nothing: nobody in it sees anyone else."""


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A container: rooms may have containers of the same name."""

    room: str
    container: str


@dataclass(frozen=True, slots=True)
class Come:
    """Agents come into a room at the same time."""

    agents: tuple[str, ...]
    room: str


@dataclass(frozen=True, slots=True)
class Go:
    """Agents go where each is alone."""

    agents: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Move:
    """An agent takes a thing from one place to another."""

    agent: str
    thing: str
    source: Place
    target: Place


@dataclass(frozen=True, slots=True)
class Wait:
    """Nothing is done."""


Act = Come | Go | Move | Wait


@dataclass(frozen=True, slots=True)
class Story:
    """A story that can be played.

    Attributes:
        lines: Its lines.
        acts: What is done in each line.
        rooms: Names of the rooms, the waiting room left out, in order of mention.
        places: The containers, in order of mention.
        agents: Who acts in it, in order of mention; each is in no room at first.
        things: Where each thing is at first, in order of mention.
    """

    lines: tuple[Line, ...]
    acts: tuple[Act, ...]
    rooms: tuple[str, ...]
    places: tuple[Place, ...]
    agents: tuple[str, ...]
    things: dict[str, Place]


def read_story(text: str) -> Story:
    """The story that a text tells.

    Raises:
        InputError: A line cannot be parsed, or contradicts those before it; the message
            gives its number.
    """
    lines = parse_lines(text)
    if not lines:
        raise InputError("the story is empty; give it one sentence a line")
    rooms = _rooms(lines)
    reader = _Reader(lines, rooms, _stated_rooms(lines, rooms))
    acts = tuple(reader.act(number) for number in range(len(lines)))
    return Story(
        lines=lines,
        acts=acts,
        rooms=rooms,
        places=tuple(reader.places),
        agents=tuple(reader.whereabouts),
        things=reader.first,
    )


def _rooms(lines: Sequence[Line]) -> tuple[str, ...]:
    """Names of the rooms: what is gone into, and what containers are in."""
    sentences = [line.sentence for line in lines]
    visited = [s.room for s in sentences if isinstance(s, Entered | Exited | Stayed)]
    located = [s for s in sentences if isinstance(s, Located)]
    holders = {s.place for s in located if s.place not in visited}
    holders |= {s.container for s in sentences if isinstance(s, Moved)}
    unvisited = [s.place for s in located if s.thing in holders and s.place not in visited]
    return tuple(name for name in dict.fromkeys(visited + unvisited) if name != WAITING_ROOM)


def _stated_rooms(lines: Sequence[Line], rooms: Sequence[str]) -> dict[str, str]:
    """The room of every container for which a line states it."""
    stated: dict[str, str] = {}
    for line in lines:
        match line.sentence:
            case Located(thing, place) if place in (*rooms, WAITING_ROOM):
                if place == WAITING_ROOM:
                    raise line.fault("nothing is seen in the waiting room; name another room")
                if stated.setdefault(thing, place) != place:
                    raise line.fault(f"the {thing} is in the {stated[thing]} already")
    return stated


@dataclass
class _Reader:
    """Follows where agents and things really are, line by line."""

    lines: Sequence[Line]
    rooms: Sequence[str]
    stated: dict[str, str]
    whereabouts: dict[str, str | None] = field(default_factory=dict)
    first: dict[str, Place] = field(default_factory=dict)
    now: dict[str, Place] = field(default_factory=dict)
    places: dict[Place, None] = field(default_factory=dict)

    def act(self, number: int) -> Act:
        """What is done in a line."""
        line = self.lines[number]
        match line.sentence:
            case Entered(agents, room):
                self.whereabouts.update(dict.fromkeys(agents, room))
                return Go(agents) if room == WAITING_ROOM else Come(agents, room)
            case Exited(agents, room):
                self._check_inside(line, agents, room)
                self.whereabouts.update(dict.fromkeys(agents))
                return Go(agents)
            case Stayed(agents, room):
                self._check_inside(line, agents, room)
                return Wait()
            case Moved(agent, thing, container):
                return self._move(line, agent, thing, container)
            case Located(thing, place):
                self._locate(number, thing, place)
                return Wait()
            case Remark():
                return Wait()

    def _check_inside(self, line: Line, agents: Sequence[str], room: str) -> None:
        for agent in agents:
            found = self.whereabouts.get(agent)
            if found != room:
                where = "in no room" if found is None else f"in the {found}"
                raise line.fault(f"{agent} is {where}; let {agent} enter the {room} first")

    def _move(self, line: Line, agent: str, thing: str, container: str) -> Move:
        room = self.whereabouts.get(agent)
        if room is None or room == WAITING_ROOM:
            raise line.fault(f"{agent} is in no room with containers; let {agent} enter one first")
        source = self.now.get(thing)
        if source is None:
            raise line.fault(f"nothing says where the {thing} was; say 'The {thing} is in the ...'")
        if source.room != room:
            raise line.fault(f"the {thing} is in the {source.room} and {agent} in the {room}")
        stated = self.stated.get(container, room)
        if stated != room:
            raise line.fault(f"the {container} is in the {stated} and {agent} in the {room}")
        target = self._place(line, room, container)
        self.now[thing] = target
        return Move(agent, thing, source, target)

    def _locate(self, number: int, thing: str, place: str) -> None:
        line = self.lines[number]
        if place in self.rooms:
            self._place(line, place, thing)
            return
        room = self.stated.get(place) or self._room_near(number)
        found = self._place(line, room, place)
        self.first.setdefault(thing, found)
        if self.now.setdefault(thing, found) != found:
            before = self.now[thing]
            raise line.fault(f"the {thing} is in the {before.container} of the {before.room}")

    def _place(self, line: Line, room: str, container: str) -> Place:
        """A container of a room, which becomes one of the story's."""
        if container in self.first:
            raise line.fault(f"the {container} lies in a container itself")
        place = Place(room, container)
        self.places.setdefault(place)
        return place

    def _room_near(self, number: int) -> str:
        """The room that was entered last before a line, or next after it."""
        before, after = self.lines[:number][::-1], self.lines[number:]
        for line in (*before, *after):
            sentence = line.sentence
            if isinstance(sentence, Entered) and sentence.room != WAITING_ROOM:
                return sentence.room
        raise self.lines[number].fault("it is in no room that is entered; name its room")
