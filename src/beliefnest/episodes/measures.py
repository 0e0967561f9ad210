"""Measures of an episode, as one row of a table."""

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from beliefnest.episodes.agent_view import utterances
from beliefnest.world.event_kinds import EventKind

if TYPE_CHECKING:
    from beliefnest.episodes.episode import Episode


@dataclass(frozen=True, slots=True)
class Measures:
    """Measures of an episode.

    Attributes:
        task: Name of the task.
        task_seed: Number of the instance; None: the task has no instances.
        order: Order of Theory of Mind that the task needs.
        seed: Seed of the episode.
        policies: Policies of agents, as text.
        success: True if the goal was reached.
        ticks: Ticks from the first round to success or the end.
        rounds: Number of rounds played.
        messages: Number of utterances of players, to the end of the last round.
        claims: Number of claims of players.
        true_claims: Number of claims that were true when they were made.
        false_claims: Number of claims that were false when they were made.
        lies: Number of claims that their speaker did not believe.
        taken_up: Number of times that a hearer took up a claim of a player.
        not_taken_up: Number of claims of players that no hearer took up.
        acted_on_false: Number of times that an agent opened a container in which it believed
            more of an item than there was.
        lost_rounds: Number of times that a policy gave no program, or failed.
        not_answered: Outcomes of models' answers without a program (`unread`, `cut`, ...).
        asked_again: Number of answers without a program after which a model was asked again.
        failed_programs: Number of programs that failed, not counting programs that were cut.
        failures: Reasons of failed programs and policies: round (from 1), agent and reason.
        false_beliefs: Number of false beliefs at the end, summed over agents.
        false_beliefs_mean: Mean number of false beliefs over the beginnings of rounds and the end.
        false_beliefs_over_time: Number of false beliefs at each of these ticks.
        requests: Number of requests to models.
        tokens: Tokens sent to models and received.
        cost: US dollars; None if a price is not known.
        help_needed: Number of agents whose share of their goals would not have come true without
            the other players. None, also for the next two: not measured, see `Episode.help`.
        help_given: Number of these agents whose share came true.
        help_superfluous: Number of programs in which players said or gave something and without
            which no agent would be worse off.
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
    not_answered: tuple[str, ...]
    asked_again: int
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
        """Return the measures as a row of a table."""
        return asdict(self)


def measured(episode: "Episode") -> Measures:
    """Return the measures of an episode up to now."""
    nest, task = episode.nest, episode.task
    players, start = set(task.players), episode.start
    said = utterances(nest["/"].state.chat, players, start)
    claims = [each for each in nest.claims() if each.tick > start and each.speaker in players]
    taken = [
        sum(each.taken_up(f"/{name}") for name in nest.agents if name != each.speaker)
        for each in claims
    ]
    wrong = [sum(counts.values()) for _, counts in false_beliefs(episode)]
    ended = [each for part in episode.parts for each in part.ended.values()]
    decisions = [each for part in episode.parts for each in part.decisions.values()]
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
        lost_rounds=sum(bool(each.fault) for each in decisions),
        not_answered=tuple(each.outcome for each in decisions if each.outcome),
        asked_again=sum(each.asked_again for each in decisions),
        failed_programs=sum(each.how in ("failed", "no_way") for each in ended),
        failures=tuple(map(str, episode.failures)),
        false_beliefs=wrong[-1],
        false_beliefs_mean=sum(wrong) / len(wrong),
        false_beliefs_over_time=tuple(wrong),
        requests=episode.spent.requests,
        tokens=episode.spent.tokens,
        cost=episode.spent.cost,
    )


def false_beliefs(episode: "Episode") -> list[tuple[int, dict[str, int]]]:
    """Return the number of false beliefs of each agent at the beginnings of rounds and now.

    Each entry has its tick. Beliefs about the beliefs of others are not counted.
    """
    nest = episode.nest
    return [
        (tick, {name: len(nest.at(tick).false_beliefs(f"/{name}")) for name in nest.agents})
        for tick in (*episode.beginnings, nest.tick)
    ]


def _acted_on_false(episode: "Episode") -> int:
    """Return how often agents opened a container with fewer of an item than they believed."""
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
