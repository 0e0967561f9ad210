"""Effect of claims on nodes (semantics, section 8).

`Forest` folds an entry with claims level by level: the kernel, the holdings and then the claims,
for all nodes of one depth. A node of the next depth perceives inside its parent's state (section
5.3), so it must see what its parent has just come to believe. This also gives rule 8.6: "does j
think that i took the claim up?" is the same question one level deeper. The kernel counts the ticks
of condition 1b, in `Nodes`.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from typing import NamedTuple, Self

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import NOBODY, READ, UNKNOWN, Nodes
from beliefnest.belief.columns import cell_of
from beliefnest.belief.context import BeliefContext
from beliefnest.belief.grounds import Basis
from beliefnest.belief.holdings import Content, Holdings, SignTold, changed_items, replaced_block
from beliefnest.belief.holdings_table import HoldingsTable
from beliefnest.belief.node_table import NodeTable
from beliefnest.world.array_types import Flags
from beliefnest.world.claims import Claim, ClaimKind, claims_of
from beliefnest.world.double_chests import believed_container_at
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.registry import parse_state
from beliefnest.world.signs import plain_state, text_of
from beliefnest.world.values import Event, Items, Sign

Numbers = npt.NDArray[np.int64]


class Verdict(StrEnum):
    """Verdict of a node on a claim: taken up or not, and by which rule of semantics, section 8.

    Attributes:
        condition: The number of the rule in section 8 that decided; None: no such rule did.
    """

    condition: str | None

    def __new__(cls, name: str, condition: str | None = None) -> Self:
        """Return a member with the rule that decides so."""
        verdict = str.__new__(cls, name)
        verdict._value_, verdict.condition = name, condition
        return verdict

    NOT_HEARD = "not heard"
    OFF = "off"
    TAKEN_UP = "taken up"
    OWN_PLACE = "own place"
    SEES_OTHERWISE = "0", "0"
    SEES_KNOWN = "1a known", "1a"
    SEES_CLAIMED = "1a claimed", "1a"
    NO_CHANCE = "1b", "1b"
    WORD = "3", "3"
    LEARNT_NOTHING = "3 grace", "3"
    NOT_SINCERE = "3 sincere", "3"
    SPEAKER = "4", "4"

    @property
    def believed(self) -> bool:
        """True if the node believes the claim from now on."""
        return self in (Verdict.TAKEN_UP, Verdict.WORD)


_VERDICTS = tuple(Verdict)
_CODES = {verdict: code for code, verdict in enumerate(_VERDICTS)}


class _Told(NamedTuple):
    """A claim that nodes perceive in the entry.

    Attributes:
        key: Number of the event in the entry and of the claim in it; None: the claim was written
            on a sign in an earlier entry.
        perceived: By node, whether its owner perceived the claim.
        speaker: Number of the speaker; `NOBODY`: the writer of the sign is unknown.
        claim: The claim.
    """

    key: tuple[int, int] | None
    perceived: Flags
    speaker: int
    claim: Claim


class EntryTestimony:
    """Claims of one entry, which the nodes of a forest weigh level by level.

    The owner of a node perceives claims on a sign when it first perceives that text on that sign
    (semantics, section 8.5).

    Args:
        table: The nodes.
        holdings: Contents, possessions and dropped items of the nodes.
        tick: Tick of the entry.
        events: Events of the entry.
        perceived: bool (events, nodes), whether a node perceived an event; the kernel fills the
            columns of a level before `hear` is called for it.
    """

    def __init__(
        self,
        table: NodeTable,
        holdings: HoldingsTable,
        tick: int,
        events: Sequence[Event],
        perceived: Flags,
    ) -> None:
        self._table, self._holdings = table, holdings
        self._context = table.context
        self._tick, self._perceived = tick, perceived
        self._writings = [
            (row, cell_of(self._context.box, event.detail["position"]), event)
            for row, event in enumerate(events)
            if event.kind is EventKind.BLOCK_UPDATE and event.detail.get("text")
        ]
        self._told = [
            _Told((row, index), perceived[row], self._context.numbers[str(event.actor)], claim)
            for row, event in enumerate(events)
            if event.kind is EventKind.CHAT
            for index, claim in enumerate(claims_of(event))
        ]
        self._utterances = len(self._told)
        self._codes = [self._nothing_heard() for _ in self._told]
        # Numbers of the claims in `_told`, by cell, block number and writer of a sign read now.
        self._read: dict[tuple[int, int, int], range] = {}

    def hear(self, level: Flags) -> None:
        """Let the nodes of a level weigh the claims one after the other, and believe some.

        All shallower levels must have heard before. Node 0 reads signs but believes nothing by
        hearsay. Utterances come first, in the order of events, then signs by cell.
        """
        which = np.flatnonzero(level)
        if len(which) == 0:
            return
        self._read_signs(which)
        which = which[which > 0]
        signs = [number for sign in sorted(self._read) for number in self._read[sign]]
        for number in [*range(self._utterances), *signs]:
            statement = self._told[number]
            self._codes[number][which] = self._weighed(number, which, statement)
            believed = _IS_BELIEVED[self._codes[number][which]]
            self._believe(which[believed], statement)
        for (cell, sign, writer), numbers in self._read.items():
            self._keep_verdicts(which, (cell, text_of(self._context.block(sign))), writer, numbers)

    def verdicts(self) -> Mapping[tuple[int, int], Sequence[Verdict]]:
        """Return the verdicts of all nodes on each claim that was uttered in the entry.

        The key is the number of the event in the entry and of the claim in the event.
        """
        return {
            statement.key: [_VERDICTS[code] for code in self._codes[number].tolist()]
            for number, statement in enumerate(self._told)
            if statement.key is not None
        }

    def _nothing_heard(self) -> npt.NDArray[np.int8]:
        return np.full(self._table.count, _CODES[Verdict.NOT_HEARD], dtype=np.int8)

    def _read_signs(self, which: Numbers) -> None:
        """Let owners of nodes note writers that they perceive, and read the signs that they see."""
        for row, cell, event in self._writings:
            for node in which[self._perceived[row, which]].tolist() if event.actor else ():
                writers = self._holdings.of(node).writers
                writers[cell, event.detail["text"]] = str(event.actor)
        nodes = self._table.nodes()
        for cell in self._context.sign_cells:
            spot = self._table.spot(cell)
            shown = self._table.blocks_at(np.maximum(nodes.parent[which], 0), cell)
            sees = (shown >= self._context.registry.states) & (
                (which == 0) | nodes.watched[which, spot]
            )
            for node, number in zip(which[sees].tolist(), shown[sees].tolist(), strict=True):
                self._read_sign(node, cell, number)

    def _read_sign(self, node: int, cell: int, number: int) -> None:
        holdings, text = self._holdings.of(node), text_of(self._context.block(number))
        if (cell, text) in holdings.read:
            return
        holdings.read[cell, text] = self._tick
        claims = self._context.claims_on(number)
        writer = holdings.writers.get((cell, text))
        speaker = NOBODY if writer is None else self._context.numbers[writer]
        if claims and (cell, number, speaker) not in self._read:
            first, flags = len(self._told), np.zeros(self._table.count, dtype=np.bool_)
            row = next((r for r, at, e in self._writings if (at, e.actor) == (cell, writer)), None)
            for index, claim in enumerate(claims):
                key = None if row is None else (row, index)
                self._told.append(_Told(key, flags, speaker, claim))
                self._codes.append(self._nothing_heard())
            self._read[cell, number, speaker] = range(first, len(self._told))
        if claims:
            first = self._read[cell, number, speaker][0]
            self._told[first].perceived[node] = True

    def _keep_verdicts(
        self, which: Numbers, sign: tuple[int, str], writer: int, numbers: range
    ) -> None:
        speaker = None if writer == NOBODY else self._context.agents[writer]
        for node in which.tolist():
            codes = [int(self._codes[number][node]) for number in numbers]
            verdicts = tuple(_VERDICTS[code] for code in codes)
            if any(verdict is not Verdict.NOT_HEARD for verdict in verdicts):
                self._holdings.of(node).told[sign] = SignTold(self._tick, speaker, verdicts)

    def _weighed(self, number: int, which: Numbers, statement: _Told) -> npt.NDArray[np.int8]:
        """Return the codes of some nodes' verdicts on a claim (semantics, 8.0, 8.1 and 8.3).

        Conditions are listed in order of precedence; the first that holds decides. Under
        `informed`, 1a is asked before 0: both keep the belief, and 1a is the more precise reason.
        """
        options, nodes = self._context.options, self._table.nodes()
        claim, speaker = statement.claim, statement.speaker
        subject = self._context.numbers.get(claim.agent or "", UNKNOWN)
        owner, parent = nodes.agent[which], nodes.parent[which]
        is_speaker = owner == speaker
        heard = np.where(is_speaker, statement.perceived[parent], statement.perceived[which])
        sees_matter, sees_claimed = self._sees(which, claim, nodes)
        beaten = [(sees_matter | sees_claimed, Verdict.SEES_OTHERWISE)]
        if options.testimony == "accept":
            words = [(~is_speaker, Verdict.TAKEN_UP), (is_speaker, Verdict.WORD)]
            conditions = beaten + words
        else:
            needless = (~is_speaker & sees_claimed, Verdict.SEES_CLAIMED)
            weighed = self._informed(number, which, speaker, claim, nodes)
            conditions = [*weighed[:1], needless, *beaten, *weighed[1:]]
        is_reality = not self._table.path(0)
        unknown = claim.agent is not None and subject == UNKNOWN
        first = [
            (~heard | unknown, Verdict.NOT_HEARD),
            (~is_speaker & (owner == subject), Verdict.OWN_PLACE),
            (is_speaker & (parent == 0) & is_reality, Verdict.SPEAKER),
        ]
        codes = np.zeros(len(which), dtype=np.int8)
        # Written from the last to the first, so that the first that holds remains.
        for condition, verdict in reversed([*first, *conditions]):
            codes[condition] = _CODES[verdict]
        return codes

    def _informed(
        self, number: int, which: Numbers, speaker: int, claim: Claim, nodes: Nodes
    ) -> list[tuple[Flags, Verdict]]:
        """Return the conditions under `informed` in the order in which they decide."""
        options = self._context.options
        is_speaker = nodes.agent[which] == speaker
        is_known, sees_known, missed = self._known(which, speaker, claim, nodes)
        # Condition 1b holds at once if the writer of a sign is unknown (8.5).
        is_short = is_known & (missed <= options.grace) & (speaker != NOBODY)
        up = self._codes[number][nodes.parent[which]] == _CODES[Verdict.TAKEN_UP]
        others = ~is_speaker
        return [
            (others & sees_known, Verdict.SEES_KNOWN),
            (is_speaker & is_short, Verdict.LEARNT_NOTHING),
            (is_speaker & ~up & (not options.sincere), Verdict.NOT_SINCERE),
            (is_speaker, Verdict.WORD),
            (others & is_short, Verdict.NO_CHANCE),
            (others, Verdict.TAKEN_UP),
        ]

    def _known(
        self, which: Numbers, speaker: int, claim: Claim, nodes: Nodes
    ) -> tuple[Flags, Flags, npt.NDArray[np.int64]]:
        """Return what condition 1 needs of the known place of a claim's matter, by node.

        Returns:
            Three arrays by node: a place is known; the owner perceives the matter there; number of
            ticks without the speaker since the owner last watched that place.
        """
        weighing = self._table.weighing()
        if weighing is None:
            raise AssertionError("hearers weigh claims under `informed` only")
        now = weighing.missed[which, speaker].astype(np.int64)
        if claim.agent is not None:
            subject = self._context.numbers[claim.agent]
            is_known = weighing.met[which, subject] != UNKNOWN
            seen = weighing.meets[which, subject]
            return is_known, is_known & seen, now - weighing.met_missed[which, subject, speaker]
        spots = self._known_spots(which, claim)
        watched = weighing.watch_missed[which, spots, speaker]
        is_known = (spots >= 0) & (watched >= 0)
        if claim.kind is ClaimKind.BLOCK:
            seen = nodes.watched[which, spots]
        else:
            seen = self._perceives(which, self._found(which, claim), claim)
        return is_known, is_known & seen, now - watched

    def _known_spots(self, which: Numbers, claim: Claim) -> Numbers:
        """Return by node the tracked cell (its index) of the known place; -1: none."""
        if claim.kind is ClaimKind.BLOCK:
            here = self._table.spot(cell_of(self._context.box, claim.cell))
            return np.full(len(which), here, dtype=np.int64)
        spots = {cell: spot for spot, cell in enumerate(self._table.tracked.tolist())}
        cells_of_nodes = self._found(which, claim)
        return np.array([spots.get(cell, UNKNOWN) for cell in cells_of_nodes], dtype=np.int64)

    def _found(self, which: Numbers, claim: Claim) -> list[int]:
        """Return by node the cell of the container where the item was last perceived; -1: none."""
        item = str(claim.item)
        return [self._holdings.of(node).found.get(item, UNKNOWN) for node in which.tolist()]

    def _containers(self, which: Numbers, claim: Claim) -> list[int]:
        """Return by node the cell of the container that a claim is about.

        If the node believes the claimed block to be half of a double chest, it is that chest.
        """
        box, registry, place = self._context.box, self._context.registry, claim.cell
        x, y, z = place
        steps = ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))
        near = [at for i, k in steps if (at := (x + i, y, z + k)) in box]
        numbers = np.stack([self._table.blocks_at(which, cell_of(box, at)) for at in near])
        numbers[numbers >= registry.states] = registry.air  # signs with a text
        cells: dict[tuple[int, ...], int] = {}
        for states in dict.fromkeys(map(tuple, numbers.T.tolist())):
            blocks = defaultdict(lambda: UNKNOWN, zip(near, states, strict=True))
            whole = believed_container_at(registry, blocks.__getitem__, place)
            cells[states] = cell_of(box, whole)
        return [cells[tuple(states)] for states in numbers.T.tolist()]

    def _perceives(self, which: Numbers, cells: Iterable[int], claim: Claim) -> Flags:
        """Return by node if its owner perceives now whether the item is in a container."""
        item, nodes = str(claim.item), which.tolist()
        seen = [
            self._holdings.perceives(node, cell, item)
            for node, cell in zip(nodes, cells, strict=True)
        ]
        return np.array(seen, dtype=np.bool_)

    def _sees(self, which: Numbers, claim: Claim, nodes: Nodes) -> tuple[Flags, Flags]:
        """Return by node what its owner perceives of a claim's matter in this tick (section 8.0).

        Returns:
            Two flags by node: the owner perceives the matter elsewhere, or that the claimed place
            holds no container; the owner perceives the claimed place.
        """
        from beliefnest.belief import seeing

        nowhere = np.zeros(len(which), dtype=np.bool_)
        cell = cell_of(self._context.box, claim.cell)
        match claim.kind:
            case ClaimKind.POSITION:
                subject = self._context.numbers.get(str(claim.agent), UNKNOWN)
                has_pose = nodes.pose[nodes.parent[which], subject] != UNKNOWN
                there = nodes.sees[which, subject] | (nodes.agent[which] == subject)
                x, y, z = claim.place
                pose = self._table.poses.add_pose((x, y, z), 0.0, 0.0)
                poses, space = self._table.poses.arrays(), self._context.space
                at_place = seeing.sees_place(space, poses, nodes, which, pose)
                return has_pose & there & (nodes.eye[which] != UNKNOWN), at_place
            case ClaimKind.BLOCK:
                seen = [
                    nodes.eye[node] != UNKNOWN and bool(self._table.sees_cells(node, (cell,)))
                    for node in which.tolist()
                ]
                return nowhere, np.array(seen, dtype=np.bool_)
            case ClaimKind.LOCATED | ClaimKind.ABSENT:
                item, cells = str(claim.item), self._containers(which, claim)
                at_place = self._perceives(which, cells, claim)
                if claim.kind is ClaimKind.ABSENT:
                    return nowhere, at_place
                elsewhere = [
                    self._holdings.perceives_elsewhere(node, whole, item)
                    or self._holdings.sees_no_container(node, whole)
                    for node, whole in zip(which.tolist(), cells, strict=True)
                ]
                return np.array(elsewhere, dtype=np.bool_), at_place

    def _believe(self, which: Numbers, statement: _Told) -> None:
        """Let nodes believe a claim (semantics, section 8.2)."""
        if len(which) == 0:
            return
        claim = statement.claim
        basis = self._context.heard_from(self._tick, statement.speaker)
        match claim.kind:
            case ClaimKind.POSITION:
                x, y, z = claim.place
                subject = self._context.numbers[str(claim.agent)]
                speaker = READ if statement.speaker == NOBODY else statement.speaker
                pose = self._table.poses.add_pose((x, y, z), 0.0, 0.0, speaker)
                for node in which.tolist():
                    self._table.set_pose(node, subject, pose, self._tick, current=False)
            case ClaimKind.BLOCK:
                self._believe_block(which, claim, basis)
            case ClaimKind.LOCATED | ClaimKind.ABSENT:
                item, cells = str(claim.item), self._containers(which, claim)
                is_there = claim.kind is ClaimKind.LOCATED
                believe = believe_located if is_there else believe_absent
                for node, cell in zip(which.tolist(), cells, strict=True):
                    believe(self._holdings.of(node), cell, item, basis)
                    if is_there:
                        self._holdings.believe_only(node, item, cell, basis)
                for cell in dict.fromkeys(cells) if is_there else ():
                    self._holdings.doubt_all(which[np.equal(cells, cell)], cell)

    def _believe_block(self, which: Numbers, claim: Claim, basis: Basis) -> None:
        context = self._context
        cell, text = cell_of(context.box, claim.cell), str(claim.state)
        old = [self._table.block(node, cell) for node in which.tolist()]
        new = [stated(context, text, number) for number in old]
        self._table.tell(which, cell, new, basis)
        for node, before, after in zip(which.tolist(), old, new, strict=True):
            names = context.block_name(before), context.container_name(after)
            replaced_block(self._holdings.of(node), cell, *names, basis)
            self._holdings.doubt(node, cell)


_IS_BELIEVED = np.array([verdict.believed for verdict in _VERDICTS])


def stated(context: BeliefContext, text: str, believed: int) -> int:
    """Return the number of a claimed block. Properties without a claim stay as they are believed.

    Args:
        context: Names and numbers of the blocks.
        text: A block, `name` or `name[property=value,...]`.
        believed: Number of the block believed so far; -1: unknown.
    """
    registry, old = context.registry, context.block(believed)
    state = registry.state_id(text)
    if believed < 0 or context.block_name(believed) != registry.name(state):
        return state
    _, claimed = parse_state(text)
    state = registry.changed(plain_state(old), **claimed)
    if not isinstance(old, Sign):
        return state
    return context.number(Sign(state, old.text), context.claims_on(believed))


def believe_located(holdings: Holdings, cell: int, item: str, basis: Basis) -> None:
    """Put one such item into a container and take one out of where it was believed (section 8.2).

    If several containers are believed to hold the item, the container that was observed last loses
    it; among several such containers, the one with the lowest cell. Items left there keep their
    basis: the claim was not about them. Nothing moves if the claimed container is believed to hold
    the item already.
    """
    content = holdings.containers.get(cell)
    items = {} if content is None else content.items
    if item not in items:
        donor, last = -1, 0
        for at, store in holdings.containers.items():
            seen = store.basis.observed_at
            if item in store.items and (donor < 0 or seen > last or (seen == last and at < donor)):
                donor, last = at, seen
        if donor >= 0:
            source = holdings.containers[donor]
            left = changed_items(source.items, {item: 1}, -1)
            _hold(holdings, donor, left, source.basis if left else basis)
        items = {**items, item: 1}
    _hold(holdings, cell, items, basis)


def believe_absent(holdings: Holdings, cell: int, item: str, basis: Basis) -> None:
    """Remove an item from a container, if it is believed to be in it."""
    content = holdings.containers.get(cell)
    if content is not None and item in content.items:
        left = {name: count for name, count in content.items.items() if name != item}
        _hold(holdings, cell, left, basis)


def _hold(holdings: Holdings, cell: int, items: Items, basis: Basis) -> None:
    old = holdings.containers.get(cell)
    holdings.containers[cell] = Content(items, old is not None and old.complete, basis)
