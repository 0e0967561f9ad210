"""Reading of narrated stories: what their sentences alone say of beliefs.

The reader knows the sentences of `prompts.story_filters`, and nothing of the nest. It follows one
item, agent or sign along one belief path: an agent knows of an act if the text lets it see the
actor, and credits another with that if the text lets it see the other as well.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from beliefnest.perception.options import Testimony
from beliefnest.world.words import titled

_SENTENCE = re.compile(r"(?:[^.“]|“[^”]*[^.!?”]”)*(?:“[^”]*[.!?]”|[.])")


class UnreadError(Exception):
    """A story says something of the item that this reader does not understand."""


@dataclass
class _Reader:
    """Reader of one story.

    Attributes:
        path: Agents of the belief path, with capital letters.
        item: The item in words.
        takes_up: True if hearers believe what is said.
        people: Agents of the story.
        things: Things of the story, with their articles.
        is_only: True if the story says that there is only one such item.
        sees: Agents and things that each agent sees.
        places: Places of the item in reality and in each belief along the path.
        it: Thing that `it` means.
        had: Agent of the last sentence about possessions, if it has the item.
        said: Speaker and claimed place of the last utterance.
    """

    path: tuple[str, ...]
    item: str
    takes_up: bool
    people: tuple[str, ...] = ()
    things: tuple[str, ...] = ()
    is_only: bool = False
    sees: dict[str, set[str]] = field(default_factory=dict)
    places: list[set[str]] = field(default_factory=list)
    it: str = ""
    had: str | None = None
    said: tuple[str, str] | None = None

    def read(self, text: str) -> set[str]:
        """Return the places of the item in the belief after a whole story."""
        self.places = [set() for _ in range(len(self.path) + 1)]
        for sentence in story_sentences(text):
            match = re.fullmatch(r"(?:.* )?(heard it|knew that)", sentence)
            if match is None:
                self._everybody_hears()
            if not self._beginning(sentence) and not self._sight(sentence):
                self._act(sentence)
        self._everybody_hears()
        return self.places[-1]

    def _everybody_hears(self) -> None:
        """Let everybody have heard the last utterance, unless the story says who did."""
        if self.said is not None:
            self._hear(frozenset(self.people), is_common=True)

    def _beginning(self, sentence: str) -> bool:
        """Read a sentence about the beginning; False: it is none."""
        if hit := re.fullmatch(r"This is a story about (.*)", sentence):
            self.people = tuple(re.split(r", | and ", hit[1]))
            self.sees = {name: set() for name in self.people}
        elif hit := re.fullmatch(r"There (?:was|were) (?!only one )(.*)", sentence):
            self.things = tuple(re.split(r", | and ", hit[1]))
        elif hit := re.fullmatch(r"There was only (.*)", sentence):
            self.is_only = self.is_only or f"one {self.item}" in re.split(r", | and ", hit[1])
        elif hit := re.fullmatch(rf"({self._who}) had (.*)", sentence):
            self.had = hit[1] if self._names_item(hit[2]) else None
            if self.had is not None:
                self._put(self.had, self._knowing({self.had}))
        elif hit := re.fullmatch(r"(.*) knew that", sentence):
            if self.had is not None:
                knowing = self._those(hit[1], self.had)
                group = self._knowing({self.had, *knowing}, is_common=hit[1] == "Everybody else")
                self._put(self.had, group)
        elif hit := re.fullmatch(r"In (.*?) (?:was|were) (.*)", sentence):
            if self._names_item(hit[2]):
                self.places[0].add(self._thing(hit[1]))
        else:
            return False
        return True

    def _sight(self, sentence: str) -> bool:
        """Read a sentence about who sees whom; False: it is none."""
        who = self._who
        if match := re.fullmatch(r"All of them could see one another(.*)", sentence):
            for name in self.people:
                self.sees[name] = {*self.people, *(self.things if match[1] else ())}
        elif match := re.fullmatch(rf"At first ({who}) could see (.*)", sentence):
            self.sees[match[1]] |= self._listed(match[2])
        elif match := re.fullmatch(
            rf"({who}) could now see (.*?)(?:, and (.*) could see {who})?", sentence
        ):
            self.sees[match[1]] |= self._listed(match[2])
            for name in self._listed(match[3] or ""):
                self.sees[name].add(match[1])
        elif match := re.fullmatch(
            rf"({who}) could no longer see (.*?)(?:, nor could (.*) see {who})?", sentence
        ):
            lost = self._listed(match[2])
            lost |= set(self.things) if "any of the things there" in match[2] else set()
            self.sees[match[1]] -= lost
            for name in self._listed(match[3] or ""):
                self.sees[name].discard(match[1])
        else:
            return False
        return True

    def _act(self, sentence: str) -> None:
        """Read a sentence about an act.

        Raises:
            UnreadError: It is about the item and has an unknown form.
        """
        who = self._who
        if match := re.fullmatch(
            rf"({who}) opened (.*?)(?: and (put|took) (.*) (?:into|out of) it)?", sentence
        ):
            self.it = self._thing(match[2])
            self._look(match[1], self.it)
            if match[3] and self._names_item(match[4]):
                self._move(match[1], match[3], self.it)
        elif match := re.fullmatch(rf"({who}) (put|took) (.*) (?:into|out of) (.*)", sentence):
            self.it = self.it if match[4] == "it" else self._thing(match[4])
            self._look(match[1], self.it)
            if self._names_item(match[3]):
                self._move(match[1], match[2], self.it)
        elif match := re.fullmatch(rf"({who}) gave (.*) to ({who})", sentence):
            if self._names_item(match[2]):
                # An onlooker may see only one of the two.
                for depth in self._witnesses({match[1]}):
                    self.places[depth].discard(match[1])
                self._put(match[3], self._witnesses({match[3]}))
        elif match := re.fullmatch(rf"({who}) said: “(.*)”", sentence):
            self._say(match[1], match[2])
        elif match := re.fullmatch(r"(.*) heard it", sentence):
            if self.said is not None:
                heard = {self.said[0], *self._those(match[1], self.said[0])}
                self._hear(frozenset(heard), is_common=False)
        elif re.search(rf"(?<!\w){re.escape(self.item)}s?(?!\w)", sentence) and not re.search(
            # Whoever believes claims may believe those of whispers and signs.
            "(thought|looks as if)"
            if self.takes_up
            else "(thought|whispered|wrote|written|now said|looks as if)",
            sentence,
        ):
            raise UnreadError(sentence)

    def _say(self, speaker: str, text: str) -> None:
        """Note what an utterance says of the item, if it is a plain statement."""
        low = text.casefold().replace("\u2019", "'")
        named = [each for each in self.things if _bare(each) in low]
        mentioned = re.search(rf"\b{re.escape(self.item.casefold())}\b", low)
        denied = re.search(r"\b(not|no longer|never|nowhere)\b|n't\b", low)
        if mentioned and len(named) == 1 and not denied:
            self.said = (speaker, named[0])

    def _hear(self, heard: frozenset[str], *, is_common: bool) -> None:
        """Let hearers believe the last utterance, and others of them that they do."""
        assert self.said is not None
        speaker, place = self.said
        self.said = None
        if not self.takes_up:
            return
        for depth in self._depths(heard, is_common=is_common):
            # What somebody says changes nothing in its own belief.
            owner = self.path[depth - 1]
            is_held = self.is_only and owner in self.places[depth]
            if self.path[:depth] != (speaker,) and not is_held:
                kept = set() if self.is_only else self.places[depth] - set(self.things)
                self.places[depth] = {*kept, place}

    def _look(self, actor: str, thing: str) -> None:
        """Let an actor learn what is in the thing that it opens."""
        for depth in self._depths(self._seeing({actor}), is_common=False):
            if self.path[depth - 1] == actor:
                if thing in self.places[depth - 1]:
                    self._set(depth, None, thing)
                else:
                    self.places[depth].discard(thing)

    def _move(self, actor: str, how: str, thing: str) -> None:
        old, new = (actor, thing) if how == "put" else (thing, actor)
        self._replace(old, new, self._witnesses({actor}))

    def _replace(self, old: str, new: str, depths: Sequence[int]) -> None:
        for depth in depths:
            self._set(depth, old, new)

    def _put(self, place: str, depths: Sequence[int]) -> None:
        self._replace("", place, depths)

    def _set(self, depth: int, old: str | None, new: str) -> None:
        rest = set() if self.is_only else self.places[depth] - {old}
        self.places[depth] = {*rest, new}

    def _witnesses(self, actors: set[str]) -> list[int]:
        """Return the depths of the path at which an act is known; 0 is reality."""
        return [0, *self._depths(self._seeing(actors), is_common=False)]

    def _knowing(self, those: set[str], *, is_common: bool = False) -> list[int]:
        """Return the depths at which something is known that some agents know of themselves."""
        depths = [0]
        for depth, name in enumerate(self.path, 1):
            # Of another's knowledge the story tells nothing, except of the holder's own.
            if name not in those or not (is_common or depth == 1 or name == self.had):
                break
            depths.append(depth)
        return depths

    def _seeing(self, actors: set[str]) -> frozenset[str]:
        saw = {name for name, seen in self.sees.items() if seen & actors}
        return frozenset({*actors, *saw})

    def _depths(self, those: frozenset[str], *, is_common: bool) -> Iterator[int]:
        """Yield the depths along the path at which an event that some perceived is known."""
        for depth, name in enumerate(self.path, 1):
            before = self.path[: depth - 1]
            is_seen = all(name == other or name in self.sees[other] for other in before)
            if name not in those or not (is_seen or is_common):
                return
            yield depth

    @property
    def _who(self) -> str:
        names = map(re.escape, sorted(self.people, key=len, reverse=True))
        return f"(?:{'|'.join(names) or '(?!)'})"

    def _those(self, words: str, without: str) -> set[str]:
        """Return the agents of `Nobody else`, `Everybody else` or a list."""
        if words == "Nobody else":
            return set()
        if words == "Everybody else":
            return {*self.people} - {without}
        return self._listed(words.removeprefix("Only "))

    def _listed(self, words: str) -> set[str]:
        names = {*self.people, *self.things}
        return {each for each in re.split(r", | and | or ", words) if each in names}

    def _thing(self, words: str) -> str:
        named = words[:1].lower() + words[1:]
        return named if named in self.things else words

    def _names_item(self, words: str) -> bool:
        """Return True if a list of items has one of the item.

        Raises:
            UnreadError: It has several.
        """
        item = re.escape(self.item)
        if re.search(rf"\b\d+ {item}s?\b", words):
            raise UnreadError(words)
        return re.search(rf"(^|, | and )(an? |the )?{item}($|, | and )", words) is not None


@dataclass
class _Watcher(_Reader):
    """Reader that follows what each belief along the path last saw of the agent or sign `item`.

    Attributes:
        now: Where the agent is or what the sign says, in the story's words; None: it is not clear.
        seen: The same as last seen, in reality and each belief along the path; empty: never seen.
        glimpsed: Depths at which the thing has come into sight since the last act with it.
        fresh: Depths that saw the last act, if it was with it: whoever loses sight of it at once
            may have seen no more than how it began.
    """

    now: str | None = None
    seen: list[str | None] = field(default_factory=list)
    glimpsed: set[int] = field(default_factory=set)
    fresh: set[int] = field(default_factory=set)

    def watch(self, text: str) -> str | None:
        """Return what is last seen in the belief after a whole story; None: it is not clear.

        Raises:
            UnreadError: Somebody says something that hearers may believe.
        """
        self.seen = ["" for _ in range(len(self.path) + 1)]
        watching: set[int] = set()
        for sentence in story_sentences(text):
            if self.takes_up and re.search(r"\b(said|whispered to .*): “", sentence):
                raise UnreadError(sentence)
            before = watching
            is_known = self._beginning(sentence) or self._sight(sentence)
            watching = set(self._watching())
            if not is_known:
                self.fresh = set()
                self._change(sentence, watching)
            for depth in self.fresh & before - watching:
                self.seen[depth] = None
            if is_known and not sentence.startswith(("At first", "All of them")):
                self.glimpsed |= watching - before
            for depth in watching:
                self.seen[depth] = self.now
            self._imagine(watching)
        return self.seen[-1]

    def _imagine(self, watching: set[int]) -> None:
        """Give up what an agent in sight may be believed to see where the thing was last seen."""
        for depth, name in enumerate(self.path[1:], 2):
            in_sight = all(name == other or name in self.sees[other] for other in self.path[:depth])
            before = self.seen[depth - 1]
            if depth - 1 not in watching and in_sight and before not in ("", self.seen[depth]):
                self.seen[depth] = None

    def _watching(self) -> Iterator[int]:
        """Yield the depths along the path at which the thing is seen; 0 is reality."""
        yield 0
        yield from self._depths(self._seeing({self.item}), is_common=False)

    def _change(self, sentence: str, watching: set[int]) -> None:
        """Read a sentence that may be about an act with the thing."""
        first = f"[{re.escape(self.item[0])}{re.escape(self.item[0].upper())}]"
        thing = f"{first}{re.escape(self.item[1:])}"
        is_person = self.item in self.people
        inert = rf"{thing} (?:said|thought|made a gesture|whispered)\b.*|.* heard it"
        mention = rf"{thing}\b.*" if is_person else rf"(?:.*\W)?{thing}\b.*"
        if not re.fullmatch(mention, sentence) or (is_person and re.fullmatch(inert, sentence)):
            return
        match = re.fullmatch(
            rf"{thing} (?:stood at|stood near|walked to) (.*)"
            if is_person
            else rf"(?:On {thing} was written|{thing} now said|(?:{self._who}) wrote on {thing})"
            ": “(.*)”",
            sentence,
        )
        blank = rf"Nothing was written on {thing}|{self._who} wiped {thing} clean"
        self.now = match[1] if match else "nothing" if re.fullmatch(blank, sentence) else None
        # Not told is what the thing was like at a glimpse before, or what an act shows of it.
        actors = {name for name in self.people if sentence.startswith(f"{name} ")}
        unclear = self.glimpsed | set(self._depths(self._seeing(actors), is_common=False))
        for depth in unclear - watching:
            self.seen[depth] = None
        self.glimpsed, self.fresh = set(), watching


def story_sentences(text: str) -> Iterator[str]:
    """Yield the sentences of a story without their full stops."""
    return filter(None, (each.strip().removesuffix(".") for each in _SENTENCE.findall(text)))


def _bare(thing: str) -> str:
    """Return the name of a thing without its article, in small letters."""
    return thing.removeprefix("the ").casefold()


def read_places(text: str, path: Sequence[str], item: str, testimony: Testimony) -> frozenset[str]:
    """Return where an agent believes an item, as far as a story alone says it; empty: nowhere.

    Args:
        text: The story of a narrator, with its beginning.
        path: Agents of the belief path; empty: reality.
        item: Name of the item.
        testimony: How hearers take claims.

    Raises:
        UnreadError: The story has several such items, or this reader does not understand it.
    """
    if testimony == "informed":
        raise UnreadError("the reader does not weigh claims")
    reader = _Reader(tuple(map(titled, path)), item.replace("_", " "), testimony == "accept")
    return frozenset(reader.read(text))


def read_contents(
    text: str,
    path: Sequence[str],
    container: str,
    items: Iterable[str],
    testimony: Testimony,
) -> frozenset[str]:
    """Return those of some items that an agent believes in a container, as a story alone says it.

    Args:
        text: The story of a narrator, with its beginning.
        path: Agents of the belief path; empty: reality.
        container: The container in the words of the story, with its article.
        items: Names of items.
        testimony: How hearers take claims.

    Raises:
        UnreadError: This reader does not understand what the story says of an item.
    """
    return frozenset(
        item for item in items if container in read_places(text, path, item, testimony)
    )


def read_last_seen(text: str, path: Sequence[str], thing: str, testimony: Testimony) -> str:
    """Return where an agent was last seen, or what a sign was last seen to say, in a belief.

    Args:
        text: The story of a narrator, with its beginning.
        path: Agents of the belief path; empty: reality.
        thing: The agent's name with a capital letter, or the sign in the words of the story.
        testimony: How hearers take claims.

    Returns:
        The place or the text in the words of the story; empty: the belief does not know it.

    Raises:
        UnreadError: The story does not make it clear.
    """
    seen = _Watcher(tuple(map(titled, path)), thing, testimony != "none").watch(text)
    if seen is None:
        raise UnreadError(thing)
    return seen
