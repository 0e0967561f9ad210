"""Claims that were made, with their hearers, their truth and the verdicts of all beliefs."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from beliefnest.belief.columns import cell_of
from beliefnest.belief.context import BeliefContext
from beliefnest.belief.holdings import Holdings
from beliefnest.belief.node_view import NodeView
from beliefnest.belief.testimony import Verdict
from beliefnest.errors import InputError
from beliefnest.facts.kinds import agrees
from beliefnest.nest.explain.wording import as_known_to
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import EntryFilter, ForkPoint, TimelineKey
from beliefnest.world.claims import Claim, ClaimKind, claims_from_plain, claims_of
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath, normalised, parse_path, path_text
from beliefnest.world.values import Event, Position


class MadeClaim:
    """Claim that was made, with the verdicts of all beliefs, which are computed on demand.

    Attributes:
        tick: Tick of the claim.
        speaker: Name of the speaker or writer; None: the sign had the claim from the start, so its
            writer is unknown.
        addressee: Name of the agent to whom it was whispered; None: it was said aloud.
        text: Text of the utterance or of the sign.
        sign: Position of the sign with the claim; None: it was said.
        claim: The claim.
        claims_from: Name of the model that read the claim out of the text; None: the speaker gave
            the claim beside the text.
        made_in: Path of the simulator in whose world the claim was made.
    """

    def __init__(
        self,
        recording: Recording,
        key: TimelineKey,
        place: tuple[int, int, int],
        until: ForkPoint,
        tick: int,
        event: Event,
        claim: Claim,
    ) -> None:
        self.tick = tick
        self.speaker: str | None = event.actor
        self.addressee: str | None = event.detail.get("to")
        self.text: str = event.detail["text"]
        self.sign: Position | None = event.detail.get("position")
        self.claims_from: str | None = event.detail.get("claims_from")
        self.claim = claim
        self.made_in = path_text(key.path)
        self._recording, self._key, self._until = recording, key, until
        self._entry, self._row, self._index = place
        self._verdicts: dict[BeliefPath, Verdict] = {}

    def __repr__(self) -> str:
        to = "" if self.addressee is None else f" to {self.addressee}"
        who = self.speaker or f"the sign at {self.sign}"
        return f"<tick {self.tick}: {who} claims{to} that {self.claim}>"

    @cached_property
    def hearers(self) -> tuple[str, ...]:
        """The agents other than the speaker that heard the claim or have read it, by name."""
        others = [name for name in self._recording.agents if name != self.speaker]
        return tuple(name for name in others if self._was_perceived((*self._key.path, name)))

    @property
    def about(self) -> Claim:
        """The claim; if it names half of a double chest, the one about the whole chest."""

        def whole(place: Position) -> Position:
            with self._recording.turn:
                history, key = self._recording.history, self._key
                return history.state(key, key.path, self._entry + 1).container_at(place)

        return self.claim.of_whole(whole)

    @cached_property
    def false(self) -> bool:
        """True if the world in which it was made contradicted the claim at its tick."""
        return self._is_contradicted(self._key.path)

    @cached_property
    def lie(self) -> bool:
        """True if the speaker's belief contradicted the claim; False without a known speaker."""
        if self.speaker is None:
            return False
        return self._is_contradicted(normalised((*self._key.path, self.speaker)))

    def taken_up(self, path: str) -> bool:
        """Return True if a simulator believes the claim from then on (semantics, section 8).

        Args:
            path: Path of the simulator; it may be a model of the speaker.

        Raises:
            PathError: The path is malformed or names an unknown agent.
            InputError: The path is not a belief in the world in which the claim was made.
        """
        return self._verdict(path).believed

    def why(self, path: str) -> str:
        """Return in words why a simulator took the claim up or not; raises as `taken_up` does."""
        names = parse_path(path, self._recording.agents)
        grace = self._recording.setting.perception.grace
        verdict, speaker = self._weighed(path)
        unaware = names
        if verdict is Verdict.NOT_HEARD:
            # The outermost simulator on the path that did not perceive it; the last one did not.
            ways = (names[:depth] for depth in range(len(self._key.path) + 1, len(names)))
            unaware = next((way for way in ways if not self._was_perceived(way)), names)
        if unaware == names:
            return _words(verdict, names, speaker, grace, self.sign)
        return f"{as_known_to(unaware[:-1])}{unaware[-1]} does not know of it"

    def condition(self, path: str) -> str | None:
        """Return the rule of semantics, section 8, that decided; raises as `taken_up` does.

        It is one of `0`, `1a`, `1b`, `3`, `4`. None if no such rule had to decide: the claim was
        taken up, was not heard, is about its hearer's own position, or testimony is off.
        """
        return self._verdict(path).condition

    def is_heard(self, path: str) -> bool:
        """Return True if a simulator perceived the claim; raises as `taken_up` does."""
        return self._verdict(path) is not Verdict.NOT_HEARD

    def heard_at(self, path: str) -> int:
        """Return the tick at which a simulator heard or read it; raises as `taken_up` does."""
        names = parse_path(path, self._recording.agents)
        if self.sign is None:
            return self.tick
        with self._recording.turn:
            statement = self._read(names).told.get(self._written)
            return self.tick if statement is None else statement.tick

    def _verdict(self, path: str) -> Verdict:
        return self._weighed(path)[0]

    def _weighed(self, path: str) -> tuple[Verdict, str | None]:
        """Return the verdict of a simulator, and the speaker as far as that simulator knows."""
        names = parse_path(path, self._recording.agents)
        root = self._key.path
        if names[: len(root)] != root or len(names) == len(root):
            raise InputError(
                f"{path!r} is not a belief in {path_text(root)}, where the claim was made; "
                f"give a path such as {path_text((*root, self._recording.agents[0]))}"
            )
        with self._recording.turn:
            if self._recording.setting.perception.testimony == "none":
                return Verdict.OFF, self.speaker
            if self.sign is not None:
                statement = self._read(names).told.get(self._written)
                if statement is None or self._index >= len(statement.verdicts):
                    return Verdict.NOT_HEARD, None
                return Verdict(statement.verdicts[self._index]), statement.speaker
            if names not in self._verdicts:
                paths = self._recording.history.company(self._key, names, self._verdicts)
                forest = self._recording.history.passed(self._key, paths, self._entry)
                verdicts = forest.verdicts[self._row, self._index]
                self._verdicts.update((each, verdicts[forest.node(each)]) for each in paths)
            return self._verdicts[names], self.speaker

    def _read(self, path: BeliefPath) -> Holdings:
        """Return the holdings of a node now, which tell the signs that its owner has read."""
        moment = self._until
        forest = self._recording.history.shared(moment.timeline, path, moment.entries)
        return forest.holdings.of(forest.node(path))

    @property
    def _written(self) -> tuple[int, str]:
        """The cell of the sign with the claim, and its text."""
        if self.sign is None:
            raise AssertionError("the claim was said, not written")
        return cell_of(self._recording.box, self.sign), self.text

    def _was_perceived(self, path: BeliefPath) -> bool:
        with self._recording.turn:
            if self.sign is not None:
                return self._written in self._read(path).read
            recording = self._recording
            forest = recording.history.shared(self._key, path, self._entry + 1)
            first = recording.journal.events_until(self._key, self._entry)
            heard = forest.perceived_events.of(forest.node(path), forest.count_of_events)
            return bool(np.asarray(heard)[first + self._row])

    def _is_contradicted(self, path: BeliefPath) -> bool:
        history = self._recording.history
        with self._recording.turn:
            view = history.state(self._key, path, self._entry + 1)
            return says_otherwise(view, history.context, self.claim)


def claims_made(recording: Recording, path: BeliefPath, tick: int | None) -> list[MadeClaim]:
    """Return all claims made in a simulator, or in what it follows, up to a tick (None: all)."""
    moment = recording.moment(path)
    if tick is not None:
        # A future tick is allowed: it gives the claims made so far.
        moment = ForkPoint(*recording.place_of(moment.timeline, tick), tick)
    return [
        claim
        for stretch in recording.stretches(moment)
        if stretch.timeline.path == moment.timeline.path
        for claim in _told(recording, stretch.timeline, stretch.entries, moment)
    ]


def _told(
    recording: Recording, key: TimelineKey, count: int, until: ForkPoint
) -> Iterator[MadeClaim]:
    world = recording.setting.snapshot
    # Signs of the beginning belong to the timeline that begins where the real world does.
    is_first = not key.path and recording.journal.info(key).base is None
    for place in sorted(world.sign_claims) if is_first else ():
        detail = {"position": place, "text": world.signs[place]}
        event = Event(EventKind.BLOCK_UPDATE, None, detail)
        for index, claim in enumerate(claims_from_plain(world.sign_claims[place])):
            yield MadeClaim(recording, key, (-1, -1, index), until, world.tick, event, claim)
    for number, entry in recording.journal.filtered(key, 0, count, EntryFilter.EVENTS):
        if isinstance(entry, Frame):
            for row, event in enumerate(entry.events):
                # An event without text, such as a sign that was turned, makes no new claim.
                for index, claim in enumerate(claims_of(event) if "text" in event.detail else ()):
                    place_of = (number, row, index)
                    yield MadeClaim(recording, key, place_of, until, entry.tick, event, claim)


def says_otherwise(view: NodeView, context: BeliefContext, claim: Claim) -> bool:
    """Return True if a state contradicts a claim. An unknown value contradicts nothing."""
    match claim.kind:
        case ClaimKind.POSITION:
            believed = view.agents[str(claim.agent)].position
            return believed is not None and _cell(believed) != claim.cell
        case ClaimKind.BLOCK:
            there = _block(view, context, claim.cell)
            return there is not None and not agrees(there, str(claim.state))
        case ClaimKind.ABSENT:
            content = view.containers.get(claim.cell)
            return content is not None and claim.item in content.items
        case ClaimKind.LOCATED:
            return _is_elsewhere(view, context, claim)


def _block(view: NodeView, context: BeliefContext, place: Position) -> str | None:
    state = view.terrain[context.box.index(place)]
    return None if state < 0 else context.registry.text(state)


def _cell(point: tuple[float, float, float]) -> tuple[int, ...]:
    return tuple(int(np.floor(value)) for value in point)


def _is_elsewhere(view: NodeView, context: BeliefContext, claim: Claim) -> bool:
    """Return True if an item is known not to be in the claimed container.

    Its content is complete and lacks the item, the block is known and is no container, or the item
    is believed to be somewhere else.
    """
    content = view.containers.get(claim.cell)
    if content is not None and claim.item in content.items:
        return False
    if content is not None and content.complete:
        return True
    if content is None and _block(view, context, claim.cell) is not None:
        return True
    others = any(claim.item in other.items for other in view.containers.values())
    return others or any(claim.item in agent.inventory for agent in view.agents.values())


def _words(
    verdict: Verdict, path: BeliefPath, speaker: str | None, grace: int, sign: Position | None
) -> str:
    """Return a verdict in words, with the rule that decided, as the believers know it."""
    me, believers = path[-1], path[:-1]
    what = f"what {speaker} said" if sign is None else f"what the sign at {sign} says"
    unheard = f"{me} did not hear it" if sign is None else f"{me} has not read it"
    outer = believers[-1] if believers else None
    words = {
        Verdict.TAKEN_UP: f"{me} believes {what}; nothing contradicts it",
        Verdict.NOT_HEARD: unheard,
        Verdict.OFF: "testimony is 'none': hearers know the text only",
        Verdict.OWN_PLACE: f"{me} knows where {me} is",
        Verdict.SEES_OTHERWISE: f"{me} perceives how it is, and seeing beats hearing (0)",
        Verdict.SEES_KNOWN: f"{me} sees the place where it last perceived it, and relies on "
        "that (1a)",
        Verdict.SEES_CLAIMED: f"{me} sees the claimed place, and relies on that (1a)",
        Verdict.NO_CHANCE: f"{me} did not lose sight of {speaker} for more than {grace} ticks "
        f"since it last watched the place, so {speaker} cannot know better (1b)",
        Verdict.WORD: f"{speaker} believes what {speaker} says (3)",
        Verdict.LEARNT_NOTHING: f"{outer} lost sight of {speaker} for at most {grace} ticks since "
        f"{speaker} last watched the place, so {speaker} can have learnt nothing new (3)",
        Verdict.NOT_SINCERE: f"{outer} does not believe it, nor that {speaker} does "
        "(3, sincere: false)",
        Verdict.SPEAKER: f"what {speaker} says changes nothing of what {speaker} believes (4)",
    }[verdict]
    if verdict is Verdict.OFF:
        return words
    if verdict is Verdict.NOT_SINCERE:
        return as_known_to(believers[:-1]) + words
    return as_known_to(believers) + words
