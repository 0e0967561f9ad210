"""Meaning of a story's sentences: rooms, containers, agents, and the act of each line.

This module tracks only reality, as far as the acts need it: an agent must be in a room, and a
thing is taken out of the container it is in. It knows nothing of beliefs.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from beliefnest.errors import InputError
from beliefnest.suites.stories.grammar import (
    Entered,
    Exited,
    Line,
    Located,
    Moved,
    Opened,
    Stayed,
    Told,
    UseDoor,
    Wait,
    Whispered,
    Write,
    parse_lines,
)
from beliefnest.world.signs import sign_fault

__all__ = [
    "WAITING_ROOM",
    "Act",
    "Come",
    "Go",
    "Look",
    "Move",
    "Place",
    "Story",
    "Tell",
    "read_story",
    "story_of",
]

WAITING_ROOM = "waiting_room"
"""Room from which agents see no other room. In stories without testimony, agents in it do not
see each other either. In other stories, all agents that are in no room meet there."""


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """Container in a room; other rooms may have containers of the same name."""

    room: str
    container: str


@dataclass(frozen=True, slots=True)
class Come:
    """Agents enter a room at the same time.

    Attributes:
        agents: The agents.
        room: The room.
        shuts: Rooms with shut doors on the way; the agents open these doors and shut them again.
    """

    agents: tuple[str, ...]
    room: str
    shuts: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Go:
    """Agents leave all rooms, through shut doors as in `Come`."""

    agents: tuple[str, ...]
    shuts: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Move:
    """An agent takes a thing from one place to another."""

    agent: str
    thing: str
    source: Place
    target: Place


@dataclass(frozen=True, slots=True)
class Look:
    """An agent opens a container and looks into it."""

    agent: str
    place: Place


@dataclass(frozen=True, slots=True)
class Tell:
    """An agent says something with a claim.

    Attributes:
        agent: Speaker.
        hearer: Agent to whom the speaker whispers; None: the speaker says it aloud.
        thing: The thing.
        place: The container.
        is_there: True if the speaker says that the thing is there, False if that it is not.
        is_claimed: True if the claim is stated beside the words, False if only in the words.
    """

    agent: str
    hearer: str | None
    thing: str
    place: Place
    is_there: bool = True
    is_claimed: bool = True

    @property
    def text(self) -> str:
        """Return the words of the utterance."""
        link = "is" if self.is_there else "is not"
        return f"The {self.thing} {link} in the {self.place.container}."


Act = Come | Go | Move | Look | UseDoor | Write | Tell | Wait


@dataclass(frozen=True, slots=True)
class Story:
    """Story that can be played. All tuples and mappings are in order of first mention.

    Attributes:
        lines: Lines of the story.
        acts: Act of each line.
        rooms: Names of the rooms, without the waiting room.
        places: The containers.
        agents: Names of the agents; all are in no room at first.
        things: First place of each thing.
        doors: Rooms with a door, which is open at first.
        signs: Rooms with a sign, which is empty at first.
    """

    lines: tuple[Line, ...]
    acts: tuple[Act, ...]
    rooms: tuple[str, ...]
    places: tuple[Place, ...]
    agents: tuple[str, ...]
    things: dict[str, Place]
    doors: tuple[str, ...] = ()
    signs: tuple[str, ...] = ()

    @property
    def tells(self) -> bool:
        """Return True if an agent tells something in the story."""
        return any(isinstance(act, Tell) for act in self.acts)


def read_story(text: str) -> Story:
    """Parse the text of a story.

    Raises:
        InputError: A line cannot be parsed, or contradicts those before it; the message
            gives its number.
    """
    return story_of(parse_lines(text))


def story_of(lines: Sequence[Line]) -> Story:
    """Return the story of parsed lines.

    Raises:
        InputError: There are no lines, or a line contradicts earlier ones; the message gives its
            number.
    """
    if not lines:
        raise InputError("the story is empty; give it one sentence a line")
    rooms = _rooms(lines)
    reader = _Reader(lines, rooms, _stated_rooms(lines, rooms))
    acts = tuple(reader.act(number) for number in range(len(lines)))
    return Story(
        lines=tuple(lines),
        acts=acts,
        rooms=rooms,
        places=tuple(reader.places),
        agents=tuple(reader.whereabouts),
        things=reader.first,
        doors=tuple(reader.is_open),
        signs=tuple(dict.fromkeys(act.room for act in acts if isinstance(act, Write))),
    )


def _rooms(lines: Sequence[Line]) -> tuple[str, ...]:
    """Return the names of rooms: places that agents enter, and places of containers."""
    sentences = [line.sentence for line in lines]
    named = Entered | Exited | Stayed | UseDoor | Write
    visited = [s.room for s in sentences if isinstance(s, named)]
    located = [s for s in sentences if isinstance(s, Located)]
    holders = {s.place for s in located if s.place not in visited}
    holders |= {s.container for s in sentences if isinstance(s, Moved)}
    unvisited = [s.place for s in located if s.thing in holders and s.place not in visited]
    return tuple(name for name in dict.fromkeys(visited + unvisited) if name != WAITING_ROOM)


def _stated_rooms(lines: Sequence[Line], rooms: Sequence[str]) -> dict[str, str]:
    """Return the rooms of containers for which a line states the room."""
    stated: dict[str, str] = {}
    for line in lines:
        match line.sentence:
            case Located(thing, place) if place in (*rooms, WAITING_ROOM):
                if place == WAITING_ROOM:
                    raise line.fault("agents see nothing in the waiting room; name another room")
                if stated.setdefault(thing, place) != place:
                    raise line.fault(f"the {thing} is in the {stated[thing]} already")
    return stated


@dataclass
class _Reader:
    """Interpreter that tracks the real places of agents and things, line by line."""

    lines: Sequence[Line]
    rooms: Sequence[str]
    stated: dict[str, str]
    whereabouts: dict[str, str | None] = field(default_factory=dict)
    first: dict[str, Place] = field(default_factory=dict)
    now: dict[str, Place] = field(default_factory=dict)
    places: dict[Place, None] = field(default_factory=dict)
    is_open: dict[str, bool] = field(default_factory=dict)

    def act(self, number: int) -> Act:
        """Return the act of a line."""
        line = self.lines[number]
        match line.sentence:
            case Entered() | Exited():
                return self._go(line, line.sentence)
            case Moved(agent, thing, container):
                return self._move(line, agent, thing, container)
            case Opened(agent, container):
                room = self._room_of(line, agent)
                return Look(agent, self._place(line, self._here(line, room, container), container))
            case UseDoor() | Write() as used:
                self._check_inside(line, (used.agent,), used.room)
                return self._door(line, used) if isinstance(used, UseDoor) else _text(line, used)
            case Told() | Whispered():
                return self._tell(line, line.sentence)
            case Stayed(agents, room):
                self._check_inside(line, agents, room)
            case Located(thing, place):
                self._locate(number, thing, place)
            case Wait():
                pass
        return Wait()

    def _go(self, line: Line, sentence: Entered | Exited) -> Come | Go:
        agents, room = sentence.agents, sentence.room
        passed = [room, *(self.whereabouts.get(agent) for agent in agents)]
        shuts = tuple(dict.fromkeys(r for r in passed if r and not self.is_open.get(r, True)))
        if isinstance(sentence, Exited):
            self._check_inside(line, agents, room)
            self.whereabouts.update(dict.fromkeys(agents))
            return Go(agents, shuts)
        self.whereabouts.update(dict.fromkeys(agents, room))
        return Go(agents, shuts) if room == WAITING_ROOM else Come(agents, room, shuts)

    def _door(self, line: Line, used: UseDoor) -> UseDoor:
        if self.is_open.setdefault(used.room, True) is used.opens:
            state = "open" if used.opens else "shut"
            raise line.fault(f"the door of the {used.room} is {state} already")
        self.is_open[used.room] = used.opens
        return used

    def _check_inside(self, line: Line, agents: Sequence[str], room: str) -> None:
        for agent in agents:
            found = self.whereabouts.get(agent)
            if found != room:
                where = "in no room" if found is None else f"in the {found}"
                raise line.fault(f"{agent} is {where}; let {agent} enter the {room} first")

    def _move(self, line: Line, agent: str, thing: str, container: str) -> Move:
        room = self._room_of(line, agent)
        source = self.now.get(thing)
        if source is None:
            raise line.fault(f"nothing says where the {thing} was; say 'The {thing} is in the ...'")
        if source.room != room:
            raise line.fault(f"the {thing} is in the {source.room} and {agent} in the {room}")
        target = self._place(line, self._here(line, room, container), container)
        self.now[thing] = target
        return Move(agent, thing, source, target)

    def _tell(self, line: Line, told: Told | Whispered) -> Tell:
        hearer = told.hearer if isinstance(told, Whispered) else None
        for name in (told.agent, hearer):
            if name is not None and name not in self.whereabouts:
                raise line.fault(f"{name} was in no room so far; let {name} enter one first")
        if told.agent == hearer:
            raise line.fault(f"{told.agent} cannot whisper to itself; name somebody else")
        if told.thing not in self.now:
            raise line.fault(f"nothing says where the {told.thing} was; say where it is first")
        room = self.stated.get(told.container) or self.now[told.thing].room
        place = self._place(line, room, told.container)
        return Tell(told.agent, hearer, told.thing, place, told.is_there)

    def _room_of(self, line: Line, agent: str) -> str:
        """Return the room with containers that an agent is in."""
        room = self.whereabouts.get(agent)
        if room is None or room == WAITING_ROOM:
            raise line.fault(f"{agent} is in no room with containers; let {agent} enter one first")
        return room

    def _here(self, line: Line, room: str, container: str) -> str:
        """Return a room after checking that no line states another room for the container."""
        stated = self.stated.get(container, room)
        if stated != room:
            raise line.fault(f"the {container} is in the {stated}, and they are in the {room}")
        return room

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
        """Return a container of a room, and add it to the story's containers."""
        if container in self.first:
            raise line.fault(f"the {container} lies in a container itself")
        place = Place(room, container)
        self.places.setdefault(place)
        return place

    def _room_near(self, number: int) -> str:
        """Return the room that agents entered last before a line, or next after it."""
        before, after = self.lines[:number][::-1], self.lines[number:]
        for line in (*before, *after):
            sentence = line.sentence
            if isinstance(sentence, Entered) and sentence.room != WAITING_ROOM:
                return sentence.room
        raise self.lines[number].fault("it is in no room that is entered; name its room")


def _text(line: Line, written: Write) -> Write:
    """Return what is written, after checking that a sign can hold it."""
    if fault := sign_fault(written.text):
        raise line.fault(fault)
    return Write(written.agent, written.room, written.text.rstrip("\n"))
