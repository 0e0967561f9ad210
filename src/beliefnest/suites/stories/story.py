"""Meaning of a story's sentences: rooms, containers, agents, and the act of each line.

This module tracks only reality, as far as the acts need it: an agent must be in a room, and a
thing is taken out of the container it is in. It knows nothing of beliefs.
"""

from collections.abc import Iterator, Mapping, Sequence

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.suites.stories.grammar import (
    IT,
    Absent,
    Entered,
    Exited,
    Line,
    Located,
    Moved,
    Opened,
    Placed,
    Present,
    Returned,
    Sentence,
    Stayed,
    Taken,
    Told,
    UseDoor,
    Wait,
    Whispered,
    Write,
    parse_lines,
)
from beliefnest.world.signs import sign_fault
from beliefnest.world.texts import quoted
from beliefnest.world.words import listed

WAITING_ROOM = "waiting_room"
"""Room from which agents see no other room. In stories without testimony, agents in it do not
see each other either. In other stories, all agents that are in no room meet there."""


_ROOM = "room"
"""Room of a story that names none."""


class Place(msgspec.Struct, frozen=True, order=True):
    """Container in a room; other rooms may have containers of the same name."""

    room: str
    container: str


class HandOver(msgspec.Struct, frozen=True):
    """Hands of an agent."""

    agent: str


class Come(msgspec.Struct, frozen=True):
    """Agents enter a room at the same time.

    Attributes:
        agents: The agents.
        room: The room.
        shuts: Rooms with shut doors on the way; the agents open these doors and shut them again.
    """

    agents: tuple[str, ...]
    room: str
    shuts: tuple[str, ...] = ()


class Go(msgspec.Struct, frozen=True):
    """Agents leave all rooms, through shut doors as in `Come`."""

    agents: tuple[str, ...]
    shuts: tuple[str, ...] = ()


class Move(msgspec.Struct, frozen=True):
    """An agent takes a thing from one place to another."""

    agent: str
    thing: str
    source: Place
    target: Place


class Take(msgspec.Struct, frozen=True):
    """An agent takes a thing out of a place into its hands."""

    agent: str
    thing: str
    source: Place


class Put(msgspec.Struct, frozen=True):
    """An agent puts a thing out of its hands into a place."""

    agent: str
    thing: str
    target: Place


class LookInto(msgspec.Struct, frozen=True):
    """An agent opens a container and looks into it."""

    agent: str
    place: Place


class Tell(msgspec.Struct, frozen=True):
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


Act = Come | Go | Move | Take | Put | LookInto | UseDoor | Write | Tell | Wait


class Story(msgspec.Struct, frozen=True):
    """Story that can be played. All tuples and mappings are in order of first mention.

    Attributes:
        lines: Lines of the story.
        acts: Act of each line.
        rooms: Names of the rooms, without the waiting room.
        places: The containers.
        agents: Names of the agents; those that are not `present` are in no room at first.
        things: First place of each thing, or the hands that have it.
        doors: Rooms with a door, which is open at first.
        signs: Rooms with a sign, which is empty at first.
        present: Rooms of agents that are in a room from the beginning, by agent.
        notes: Remarks on lines for reports: who cannot hear what is said.
    """

    lines: tuple[Line, ...]
    acts: tuple[Act, ...]
    rooms: tuple[str, ...]
    places: tuple[Place, ...]
    agents: tuple[str, ...]
    things: dict[str, Place | HandOver]
    doors: tuple[str, ...] = ()
    signs: tuple[str, ...] = ()
    present: Mapping[str, str] = msgspec.field(default_factory=dict)
    notes: tuple[str, ...] = ()

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
    written, lines = lines, tuple(_named(lines))
    rooms = _rooms(lines)
    reader = _Reader(lines, rooms, _stated_rooms(lines, rooms))
    acts = tuple(reader.act(number) for number in range(len(lines)))
    return Story(
        lines=tuple(written),
        acts=acts,
        rooms=rooms,
        places=tuple(reader.places),
        agents=tuple(reader.whereabouts),
        things=reader.first,
        doors=tuple(reader.is_open),
        signs=tuple(dict.fromkeys(act.room for act in acts if isinstance(act, Write))),
        present=reader.present,
        notes=tuple(reader.notes()),
    )


def _named(lines: Sequence[Line]) -> Iterator[Line]:
    """Yield the lines with the names of things in place of `it`; agents and things are told apart.

    `it` is the thing that was named last. If a remark names something else after that, `it` is
    ambiguous.

    Raises:
        InputError: `it` stands for nothing, or for one of several things.
    """
    agents = {name for line in lines for name in _actors(line.sentence)}
    things = {
        s.thing
        for line in lines
        if isinstance(s := line.sentence, Located | Moved | Placed | Taken)
    }
    holders = {line.sentence.place for line in lines if isinstance(line.sentence, Located)}
    holders |= {s.container for line in lines if isinstance(s := line.sentence, Moved | Placed)}
    last: str | None = None
    doubt: str | None = None
    for line in lines:
        sentence = line.sentence
        if isinstance(sentence, Present):
            sentence = _placed(line, sentence, agents, lines)
        if isinstance(sentence, Located | Moved | Placed | Taken | Told | Whispered):
            thing = sentence.thing
            if thing == IT:
                if last is None:
                    raise line.fault("no earlier line names a thing that 'it' could be")
                if doubt is not None:
                    raise line.fault(f"'it' may be the {last} or the {doubt}; name the thing")
                thing, sentence = last, replace(sentence, thing=last)
            if not (isinstance(sentence, Located) and thing in holders):
                last, doubt = thing, None
        if isinstance(sentence, Wait) and sentence.about is not None:
            if sentence.about in things - holders:
                last, doubt = sentence.about, None
            elif sentence.about not in holders | agents:
                doubt = sentence.about
        yield replace(line, sentence=sentence)


def _actors(sentence: Sentence) -> tuple[str, ...]:
    """Return the agents that do something in a sentence."""
    match sentence:
        case Absent() | Entered() | Exited() | Returned() | Stayed():
            return sentence.agents
        case Moved() | Placed() | Taken() | UseDoor() | Write() | Opened() | Told() | Whispered():
            return (sentence.agent,)
        case _:
            return ()


def _placed(
    line: Line, sentence: Present, agents: set[str], lines: Sequence[Line]
) -> Present | Located:
    """Return what `X is in the Y` says: that agents are in a room, or where a thing is."""
    named = Entered | Exited | Stayed | UseDoor | Write
    rooms = {each.sentence.room for each in lines if isinstance(each.sentence, named)}
    rooms |= {
        each.sentence.place
        for each in lines
        if isinstance(each.sentence, Present) and agents & set(each.sentence.names)
    }
    if agents & set(sentence.names) or sentence.place in rooms:
        return sentence
    if len(sentence.names) == 1:
        return Located(sentence.names[0], sentence.place)
    raise line.fault("write one sentence for each thing")


def _rooms(lines: Sequence[Line]) -> tuple[str, ...]:
    """Return the names of rooms: places that agents enter, and places of containers."""
    sentences = [line.sentence for line in lines]
    visited = [room for s in sentences for room in _visited(s)]
    located = [s for s in sentences if isinstance(s, Located)]
    holders = {s.place for s in located if s.place not in visited}
    holders |= {s.container for s in sentences if isinstance(s, Moved | Placed)}
    holders |= {s.source for s in sentences if isinstance(s, Moved | Taken) and s.source}
    for line in lines:
        both = holders.intersection(visited, _visited(line.sentence))
        if both:
            raise line.fault(f"the {min(both)} cannot be a room and a container")
    unvisited = [s.place for s in located if s.thing in holders and s.place not in visited]
    rooms = tuple(name for name in dict.fromkeys(visited + unvisited) if name != WAITING_ROOM)
    if len(rooms) > 1 and _ROOM in rooms:
        line = next(line for line in lines if _ROOM in _visited(line.sentence))
        others = ", ".join(name for name in rooms if name != _ROOM)
        raise line.fault(f"'the room' may be one of several; name it: {others}")
    return rooms or (_ROOM,)


def _visited(sentence: Sentence) -> tuple[str, ...]:
    """Return the room that a sentence says agents to be in."""
    match sentence:
        case Exited(_, None):
            return ()
        case Entered() | Exited() | Stayed() | UseDoor() | Write():
            return (str(sentence.room),)
        case Present():
            return (sentence.place,)
        case _:
            return ()


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


class _Reader(msgspec.Struct):
    """Interpreter that tracks the real places of agents and things, line by line."""

    lines: Sequence[Line]
    rooms: Sequence[str]
    stated: dict[str, str]
    whereabouts: dict[str, str | None] = msgspec.field(default_factory=dict)
    first: dict[str, Place | HandOver] = msgspec.field(default_factory=dict)
    now: dict[str, Place | HandOver] = msgspec.field(default_factory=dict)
    places: dict[Place, None] = msgspec.field(default_factory=dict)
    is_open: dict[str, bool] = msgspec.field(default_factory=dict)
    present: dict[str, str] = msgspec.field(default_factory=dict)
    left: dict[str, str] = msgspec.field(default_factory=dict)
    said: list[tuple[Line, Told, dict[str, str | None]]] = msgspec.field(default_factory=list)

    def act(self, number: int) -> Act:  # noqa: PLR0911, PLR0912  # one case a sentence
        """Return the act of a line."""
        line = self.lines[number]
        match line.sentence:
            case Entered(agents, room):
                return self._enter(agents, room)
            case Returned(agents):
                return self._return(line, agents)
            case Exited(agents, room):
                return self._exit(number, agents, room)
            case Absent(agents):
                return self._be_away(agents)
            case Moved(agent, thing, container, source):
                return self._move(line, agent, thing, container, source)
            case Placed(agent, thing, container):
                return self._put(number, agent, thing, container)
            case Taken(agent, thing, source):
                source_held = self._held(line, agent, thing, source)
                self.now[thing] = HandOver(agent)
                return Take(agent, thing, source_held)
            case Opened(agent, container):
                room = self._room_of(line, agent, self._room_with(container))
                return LookInto(
                    agent, self._place(line, self._here(line, room, container), container)
                )
            case UseDoor() | Write() as used:
                self._check_inside(line, (used.agent,), used.room)
                return self._door(line, used) if isinstance(used, UseDoor) else _text(line, used)
            case Told() | Whispered():
                return self._tell(line, line.sentence)
            case Stayed(agents, room) | Present(agents, room):
                self._check_inside(line, agents, room)
            case Located(thing, place):
                self._locate(number, thing, place)
            case Wait():
                pass
        return Wait()

    def _enter(self, agents: Sequence[str], room: str) -> Come | Go:
        shuts = self._shuts(room, agents)
        self.whereabouts.update(dict.fromkeys(agents, room))
        agents = tuple(agents)
        return Go(agents, shuts) if room == WAITING_ROOM else Come(agents, room, shuts)

    def _return(self, line: Line, agents: Sequence[str]) -> Come | Go:
        rooms = {self.left.get(agent) for agent in agents}
        room = rooms.pop()
        inside = [agent for agent in agents if self.whereabouts.get(agent)]
        if room is None or rooms or inside:
            raise line.fault(f"{listed(agents)} left no room together; name the room")
        return self._enter(agents, room)

    def _exit(self, number: int, agents: Sequence[str], room: str | None) -> Go:
        line = self.lines[number]
        if room is None:
            rooms = {self.whereabouts[name] for name in agents if name in self.whereabouts}
            room = rooms.pop() if rooms else self._room_near(number)
            if room is None or rooms:
                raise line.fault("they are in no room together; name the room")
        shuts = self._shuts(room, agents)
        self._check_inside(line, agents, room)
        self.whereabouts.update(dict.fromkeys(agents))
        self.left.update(dict.fromkeys(agents, room))
        return Go(tuple(agents), shuts)

    def _be_away(self, agents: Sequence[str]) -> Go | Wait:
        """Return the leaving of agents that are where they have been all the time."""
        staying = [
            name
            for name in agents
            if self.whereabouts.setdefault(name, None) is not None
            and self.left.get(name) in (None, self.whereabouts[name])
        ]
        if not staying:
            return Wait()
        rooms = {name: str(self.whereabouts[name]) for name in staying}
        shuts = dict.fromkeys(r for room in rooms.values() for r in self._shuts(room, staying))
        self.left |= rooms
        self.whereabouts.update(dict.fromkeys(staying))
        return Go(tuple(staying), tuple(shuts))

    def _shuts(self, room: str, agents: Sequence[str]) -> tuple[str, ...]:
        """Return the rooms with shut doors between a room and agents."""
        passed = [room, *(self.whereabouts.get(agent) for agent in agents)]
        return tuple(dict.fromkeys(r for r in passed if r and not self.is_open.get(r, True)))

    def _door(self, line: Line, used: UseDoor) -> UseDoor:
        if self.is_open.setdefault(used.room, True) is used.opens:
            state = "open" if used.opens else "shut"
            raise line.fault(f"the door of the {used.room} is {state} already")
        self.is_open[used.room] = used.opens
        return used

    def _check_inside(self, line: Line, agents: Sequence[str], room: str) -> None:
        for agent in agents:
            room_before = self._since_beginning(agent, room)
            if room_before != room:
                where = "in no room" if room_before is None else f"in the {room_before}"
                raise line.fault(f"{agent} is {where}; let {agent} enter the {room} first")

    def _since_beginning(self, agent: str, room: str) -> str | None:
        """Return the room of an agent; one that no line has named yet was always in `room`."""
        if agent not in self.whereabouts:
            self.whereabouts[agent] = room
            if room != WAITING_ROOM:
                self.present[agent] = room
        return self.whereabouts[agent]

    def _move(
        self, line: Line, agent: str, thing: str, container: str, named: str | None
    ) -> Move | Put:
        if self.now.get(thing) == HandOver(agent) and named is None:
            return self._out_of_hand(line, agent, thing, container)
        source = self._held(line, agent, thing, named)
        target = self._place(line, self._here(line, source.room, container), container)
        self.now[thing] = target
        return Move(agent, thing, source, target)

    def _put(self, number: int, agent: str, thing: str, container: str) -> Move | Put:
        line = self.lines[number]
        if thing not in self.now:
            room = self._room_with(container) or self._room_near(number, agent)
            self._room_of(line, agent, room)
            self.first[thing] = self.now[thing] = HandOver(agent)
        return self._move(line, agent, thing, container, None)

    def _out_of_hand(self, line: Line, agent: str, thing: str, container: str) -> Put:
        room = self._room_of(line, agent, None)
        target = self._place(line, self._here(line, room, container), container)
        self.now[thing] = target
        return Put(agent, thing, target)

    def _held(self, line: Line, agent: str, thing: str, named: str | None) -> Place:
        """Return the place of a thing, after checking that an agent can take it there."""
        source = self.now.get(thing)
        if source is None:
            raise line.fault(f"nothing says where the {thing} was; say 'The {thing} is in the ...'")
        if isinstance(source, HandOver):
            raise line.fault(f"{source.agent} has the {thing} in the hands")
        room = self._room_of(line, agent, source.room)
        if source.room != room:
            raise line.fault(f"the {thing} is in the {source.room} and {agent} in the {room}")
        if named not in (None, source.container):
            raise line.fault(f"the {thing} is in the {source.container}, not in the {named}")
        return source

    def _tell(self, line: Line, words: Told | Whispered) -> Tell:
        hearer = words.hearer if isinstance(words, Whispered) else None
        for name in (words.agent, hearer):
            if name is not None and name not in self.whereabouts:
                raise line.fault(f"{name} was in no room so far; let {name} enter one first")
        if words.agent == hearer:
            raise line.fault(f"{words.agent} cannot whisper to itself; name somebody else")
        if words.thing not in self.now:
            raise line.fault(f"nothing says where the {words.thing} was; say where it is first")
        where = self.now[words.thing]
        room = self._room_with(words.container) or (
            where.room if isinstance(where, Place) else self.whereabouts[where.agent]
        )
        if room in (None, WAITING_ROOM):
            raise line.fault(f"nothing says in which room the {words.container} is; say it first")
        place = self._place(line, str(room), words.container)
        if isinstance(words, Told):
            self.said.append((line, words, dict(self.whereabouts)))
        return Tell(words.agent, hearer, words.thing, place, words.is_there)

    def notes(self) -> Iterator[str]:
        """Yield remarks on what is said aloud where nobody, or not the addressee, hears it."""
        for line, tell, then in self.said:
            rooms = {name: then.get(name, self.present.get(name)) for name in self.whereabouts}
            inside = {name: None if at == WAITING_ROOM else at for name, at in rooms.items()}
            here = inside.pop(tell.agent)
            audience = [name for name, at in inside.items() if at == here]
            hears = f"{listed(audience)} {'hears' if len(audience) == 1 else 'hear'} it"
            if tell.hearer is not None and tell.hearer not in audience:
                hears = f"{hears} instead" if audience else "nobody hears it"
                yield f"{line.place}: {quoted(line.text)}: {tell.hearer} is not there; {hears}"
            elif not audience:
                yield f"{line.place}: {quoted(line.text)}: nobody else is there; nobody hears it"

    def _room_of(self, line: Line, agent: str, room: str | None) -> str:
        """Return the room with containers that an agent is in.

        Args:
            line: The line.
            agent: The agent.
            room: Room in which an agent that no line has named yet is; None: it is in none.
        """
        room_found = self.whereabouts.get(agent)
        if room is not None:
            room_found = self._since_beginning(agent, room)
        if room_found is None or room_found == WAITING_ROOM:
            raise line.fault(f"{agent} is in no room with containers; let {agent} enter one first")
        return room_found

    def _room_with(self, container: str) -> str | None:
        """Return the room of a container; None: it is in none yet, or in several."""
        rooms = {place.room for place in self.places if place.container == container}
        return self.stated.get(container) or (rooms.pop() if len(rooms) == 1 else None)

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
        located = self._place(line, room, place)
        self.first.setdefault(thing, located)
        if self.now.setdefault(thing, located) != located:
            before = self.now[thing]
            if isinstance(before, HandOver):
                raise line.fault(f"{before.agent} holds the {thing}; say where it is put")
            raise line.fault(f"the {thing} is in the {before.container} of the {before.room}")

    def _place(self, line: Line, room: str, container: str) -> Place:
        """Return a container of a room, and add it to the story's containers."""
        if container in self.first:
            raise line.fault(f"the {container} lies in a container itself")
        place = Place(room, container)
        self.places.setdefault(place)
        return place

    def _room_near(self, number: int, agent: str | None = None) -> str:
        """Return the only room, or that of an agent, or the one that agents entered last.

        If agents entered none before the line, it is the one that they enter next.
        """
        if len(self.rooms) == 1:
            return self.rooms[0]
        inside = None if agent is None else self.whereabouts.get(agent)
        if inside is not None:
            return inside
        before, after = self.lines[:number][::-1], self.lines[number:]
        for line in (*before, *after):
            match line.sentence:
                case Entered(_, room) | Present(_, room) if room != WAITING_ROOM:
                    return room
        raise self.lines[number].fault("it is in no room that is entered; name its room")


def _text(line: Line, written: Write) -> Write:
    """Return what is written, after checking that a sign can hold it."""
    if fault := sign_fault(written.text):
        raise line.fault(fault)
    return Write(written.agent, written.room, written.text.rstrip("\n"))
