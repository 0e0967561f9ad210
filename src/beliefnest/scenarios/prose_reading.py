"""Reading of narrated stories: what their sentences alone say of beliefs about an item.

The reader knows the sentences of `prompts.story_filters`, and nothing of the nest. It follows one
item along one belief path: an agent knows of an act if the text lets it see the actor, and credits
another with that if the text lets it see the other as well.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

__all__ = ["UnreadError", "read_places"]

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
        sentences = [each.strip().removesuffix(".") for each in _SENTENCE.findall(text)]
        for sentence in filter(None, sentences):
            told = re.fullmatch(r"(?:.* )?(heard it|knew that)", sentence)
            if told is None:
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
        if told := re.fullmatch(r"This is a story about (.*)", sentence):
            self.people = tuple(re.split(r", | and ", told[1]))
            self.sees = {name: set() for name in self.people}
        elif told := re.fullmatch(r"There (?:was|were) (?!only one )(.*)", sentence):
            self.things = tuple(re.split(r", | and ", told[1]))
        elif told := re.fullmatch(r"There was only (.*)", sentence):
            self.is_only = self.is_only or f"one {self.item}" in re.split(r", | and ", told[1])
        elif told := re.fullmatch(rf"({self._who}) had (.*)", sentence):
            self.had = told[1] if self._names_item(told[2]) else None
            if self.had is not None:
                self._put(self.had, self._knowing({self.had}))
        elif told := re.fullmatch(r"(.*) knew that", sentence):
            if self.had is not None:
                knowing = self._those(told[1], self.had)
                known = self._knowing({self.had, *knowing}, is_common=told[1] == "Everybody else")
                self._put(self.had, known)
        elif told := re.fullmatch(r"In (.*?) (?:was|were) (.*)", sentence):
            if self._names_item(told[2]):
                self.places[0].add(self._thing(told[1]))
        else:
            return False
        return True

    def _sight(self, sentence: str) -> bool:
        """Read a sentence about who sees whom; False: it is none."""
        who = self._who
        if told := re.fullmatch(r"All of them could see one another(.*)", sentence):
            for name in self.people:
                self.sees[name] = {*self.people, *(self.things if told[1] else ())}
        elif told := re.fullmatch(rf"At first ({who}) could see (.*)", sentence):
            self.sees[told[1]] |= self._listed(told[2])
        elif told := re.fullmatch(
            rf"({who}) could now see (.*?)(?:, and (.*) could see {who})?", sentence
        ):
            self.sees[told[1]] |= self._listed(told[2])
            for name in self._listed(told[3] or ""):
                self.sees[name].add(told[1])
        elif told := re.fullmatch(
            rf"({who}) could no longer see (.*?)(?:, nor could (.*) see {who})?", sentence
        ):
            lost = self._listed(told[2])
            lost |= set(self.things) if "any of the things there" in told[2] else set()
            self.sees[told[1]] -= lost
            for name in self._listed(told[3] or ""):
                self.sees[name].discard(told[1])
        else:
            return False
        return True

    def _act(self, sentence: str) -> None:
        """Read a sentence about an act.

        Raises:
            UnreadError: It is about the item and has an unknown form.
        """
        who = self._who
        if told := re.fullmatch(
            rf"({who}) opened (.*?)(?: and (put|took) (.*) (?:into|out of) it)?", sentence
        ):
            self.it = self._thing(told[2])
            self._look(told[1], self.it)
            if told[3] and self._names_item(told[4]):
                self._move(told[1], told[3], self.it)
        elif told := re.fullmatch(rf"({who}) (put|took) (.*) (?:into|out of) (.*)", sentence):
            self.it = self.it if told[4] == "it" else self._thing(told[4])
            self._look(told[1], self.it)
            if self._names_item(told[3]):
                self._move(told[1], told[2], self.it)
        elif told := re.fullmatch(rf"({who}) gave (.*) to ({who})", sentence):
            if self._names_item(told[2]):
                # An onlooker may see only one of the two.
                for depth in self._witnesses({told[1]}):
                    self.places[depth].discard(told[1])
                self._put(told[3], self._witnesses({told[3]}))
        elif told := re.fullmatch(rf"({who}) said: “(.*)”", sentence):
            self._say(told[1], told[2])
        elif told := re.fullmatch(r"(.*) heard it", sentence):
            if self.said is not None:
                heard = {self.said[0], *self._those(told[1], self.said[0])}
                self._hear(frozenset(heard), is_common=False)
        elif re.search(rf"(?<!\w){re.escape(self.item)}s?(?!\w)", sentence) and not re.search(
            "(thought|whispered|wrote|written|now said|looks as if)", sentence
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
        known = {*self.people, *self.things}
        return {each for each in re.split(r", | and | or ", words) if each in known}

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


def _bare(thing: str) -> str:
    """Return the name of a thing without its article, in small letters."""
    return thing.removeprefix("the ").casefold()


def read_places(
    text: str, path: Sequence[str], item: str, testimony: Literal["none", "accept", "informed"]
) -> frozenset[str]:
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
    titled = tuple(name[:1].upper() + name[1:] for name in path)
    reader = _Reader(titled, item.replace("_", " "), testimony == "accept")
    return frozenset(reader.read(text))
