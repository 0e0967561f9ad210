"""Trials: policies that go on from one beginning end as in episodes of their own."""

from typing import Any

import pytest

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.policies.search import Omniscient
from beliefnest.episodes.policies.simple import Program
from beliefnest.episodes.task import Task
from beliefnest.episodes.trials import Trials, wins_of

FULL = (1, 1, 3)
TAKE = "await getItemFromChest(bot, new Vec3({}, 1, 3), {{apple: 1}});"


def task(rounds: int, round_ticks: int) -> Task:
    """Return a task in which Ann takes an apple, which is in one of two boxes."""
    content: dict[str, Any] = {
        "name": "take",
        "players": ["ann"],
        "policies": {"bob": "search:0"},
        "goal": {"reach": [{"agent": "ann", "items": {"apple": 1}}]},
        "goals": {"bob": {}},
        "rounds": rounds,
        "round_ticks": round_ticks,
        "scenario": {
            "name": "take",
            "box": [[0, 0, 0], [10, 3, 6]],
            "blocks": [{"block": "stone", "fill": [[0, 0, 0], [10, 0, 6]]}],
            "containers": [{"at": FULL, "items": {"apple": 1}}, {"at": [9, 1, 3]}],
            "agents": {"ann": {"position": [7.5, 1, 3.5]}, "bob": {"position": [5.5, 1, 5.5]}},
            "initial_beliefs": [
                {"path": "/**", "containers": [{"at": FULL, "items": {"apple": 1}}]}
            ],
            "script": [
                {"agent": "bob", "program": "await goToPosition(bot, new Vec3(5, 1, 4), 0);"}
            ],
        },
    }
    return Task.from_mapping(content)


# In 3 ticks, Ann does not get to the box; she goes on in the next round.
@pytest.mark.parametrize(
    ("rounds", "round_ticks", "wins"), [(1, 20, True), (1, 3, False), (3, 3, True)]
)
def test_policies_end_as_in_episodes_of_their_own(rounds, round_ticks, wins):
    played = task(rounds, round_ticks)
    policies: list[str | Policy] = [
        Program(TAKE.format(1)),
        Program(""),
        Program(TAKE.format(9)),
        "search:0",
        Omniscient(),
        Program(TAKE.format(1)),
    ]
    with Trials(played, seed=7) as trials:
        won = trials.won(policies)
        # Independence of what was played before.
        assert trials.won(reversed(policies)) == won[::-1]
    own = []
    for policy in policies:
        with Episode(played, {"ann": policy}, seed=7) as episode:
            own.append(episode.play().success)
    assert won == own
    assert (won[0], won[1], won[2], won[5]) == (wins, False, False, wins)


def test_policies_that_decide_alike_are_played_once(monkeypatch):
    played = []
    play = Episode.forked
    monkeypatch.setattr(Episode, "forked", lambda *given: played.append(0) or play(*given))
    course = Program(TAKE.format(1))
    with Trials(task(1, 20)) as trials:
        assert trials.won([course, Program(""), course]) == [True, False, True]
    assert len(played) == 2


def test_instances_are_counted_by_policy():
    won = wins_of(lambda seed: task(1, (3, 20)[seed]), ["search:0", "rule:nearest"], range(2))
    assert won == [1, 1]
