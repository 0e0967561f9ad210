"""Measures of an episode, as one row of a table."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Protocol

from beliefnest.episodes.decided import Failure, Part, Spent
from beliefnest.episodes.task import Task
from beliefnest.nest.face.nest import Nest
from beliefnest.world.values import EventKind

__all__ = ["Measures", "false_beliefs", "measured"]


@dataclass(frozen=True, slots=True)
class Measures:
    """What an episode came to.

    Attributes:
        task: Name of the task.
        task_seed: Which instance; None: none.
        order: The order of Theory of Mind that it needs.
        seed: What the episode was played with.
        policies: Who played whom, in words.
        success: Whether the goal was reached.
        ticks: Ticks from the first round to success or the end.
        rounds: Rounds played.
        messages: Utterances of players.
        claims: Claims of players.
        true_claims: Those that were so in reality when they were made.
        false_claims: Those that were not.
        lies: Those that their speaker did not believe.
        taken_up: Times a hearer took up a claim of a player.
        not_taken_up: Claims of players that nobody took up.
        acted_on_false: Times somebody opened a container in which it believed something that was
            not in it.
        lost_rounds: Times a policy gave no program, or failed.
        failed_programs: Programs that failed, other than by being cut.
        failures: Why programs failed, or policies gave none: round (from 1), agent and reason.
        false_beliefs: Things that agents hold wrongly in the end, each agent's counted.
        false_beliefs_mean: The same, as mean over the beginnings of rounds and the end.
        false_beliefs_over_time: The same at each of them.
        requests: Requests to models.
        tokens: Sent to models and received.
        cost: US dollars; None where a price is not known.
        help_needed: Agents whose share of their goals would not have come true without the other
            players; None, as for the next two: it was not asked for, see `Episode.help`.
        help_given: Those of them whose share came true.
        help_superfluous: What players said or gave without which nobody would be worse off.
    """

    task: str
    task_seed: int | None
    order: int
    seed: int
    policies: str
    success: bool
    ticks: int
    rounds: int
    messages: int
    claims: int
    true_claims: int
    false_claims: int
    lies: int
    taken_up: int
    not_taken_up: int
    acted_on_false: int
    lost_rounds: int
    failed_programs: int
    failures: tuple[str, ...]
    false_beliefs: int
    false_beliefs_mean: float
    false_beliefs_over_time: tuple[int, ...]
    requests: int
    tokens: int
    cost: float | None
    help_needed: int | None = None
    help_given: int | None = None
    help_superfluous: int | None = None

    def row(self) -> dict[str, Any]:
        """As a row of a table."""
        return asdict(self)


class Played(Protocol):
    """What is measured of an episode."""

    task: Task
    seed: int

    @property
    def nest(self) -> Nest:
        """Where it is played."""

    @property
    def start(self) -> int:
        """The tick at which the first round began."""

    @property
    def parts(self) -> Sequence[Part]:
        """What was decided and how it ended."""

    @property
    def policies(self) -> Mapping[str, str]:
        """Who plays whom, in words."""

    @property
    def success(self) -> bool:
        """True if the goal was reached."""

    @property
    def beginnings(self) -> Sequence[int]:
        """The ticks at which rounds began."""

    @property
    def ticks(self) -> int:
        """Ticks until success or now."""

    @property
    def rounds(self) -> int:
        """Rounds played."""

    @property
    def failures(self) -> Sequence[Failure]:
        """Programs that failed, and rounds in which a policy gave none, with the reasons."""

    @property
    def spent(self) -> Spent:
        """What policies have spent on models."""


def measured(episode: Played) -> Measures:
    """What an episode has come to by now."""
    nest, task = episode.nest, episode.task
    players, start = set(task.players), episode.start
    said = [line for line in nest["/"].state.chat if line[0] > start and line[1] in players]
    claims = [each for each in nest.claims() if each.tick > start and each.speaker in players]
    taken = [
        sum(each.taken_up(f"/{name}") for name in nest.agents if name != each.speaker)
        for each in claims
    ]
    wrong = [sum(counts.values()) for _, counts in false_beliefs(episode)]
    ended = [each for part in episode.parts for each in part.ended.values()]
    return Measures(
        task=task.name,
        task_seed=task.seed,
        order=task.order,
        seed=episode.seed,
        policies=",".join(f"{name}={policy}" for name, policy in episode.policies.items()),
        success=episode.success,
        ticks=episode.ticks,
        rounds=episode.rounds,
        messages=len(said),
        claims=len(claims),
        true_claims=sum(not each.false for each in claims),
        false_claims=sum(each.false for each in claims),
        lies=sum(each.lie for each in claims),
        taken_up=sum(taken),
        not_taken_up=taken.count(0),
        acted_on_false=_acted_on_false(episode),
        lost_rounds=sum(bool(d.fault) for p in episode.parts for d in p.decisions.values()),
        failed_programs=sum(each.how in ("failed", "no_way") for each in ended),
        failures=tuple(map(str, episode.failures)),
        false_beliefs=wrong[-1],
        false_beliefs_mean=sum(wrong) / len(wrong),
        false_beliefs_over_time=tuple(wrong),
        requests=episode.spent.requests,
        tokens=episode.spent.tokens,
        cost=episode.spent.cost,
    )


def false_beliefs(episode: Played) -> list[tuple[int, dict[str, int]]]:
    """How many things each agent held wrongly at the beginnings of rounds and now, with the ticks.

    What an agent holds of others' beliefs is not counted.
    """
    nest = episode.nest
    return [
        (tick, {name: len(nest.at(tick).false_beliefs(f"/{name}")) for name in nest.agents})
        for tick in (*episode.beginnings, nest.tick)
    ]


def _acted_on_false(episode: Played) -> int:
    """How often somebody opened a container and believed more of an item in it than there was."""
    nest, count = episode.nest, 0
    opened = [
        event
        for event in nest["/"].state.events
        if event.kind is EventKind.OPEN_CONTAINER and event.tick > episode.start
    ]
    for event in opened:
        before, place = nest.at(event.tick - 1), event.detail["position"]
        believed = before[f"/{event.actor}"].state.containers.get(place)
        real = before["/"].state.containers[place].items
        if believed is not None:
            count += any(n > real.get(item, 0) for item, n in believed.items.items())
    return count
