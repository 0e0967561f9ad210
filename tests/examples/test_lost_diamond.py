"""The task of the page on training: only a policy that reads Sally's belief always helps her."""

from pathlib import Path

import pytest

import beliefnest as bn

FILE = Path(__file__).parents[2] / "examples" / "lost-diamond.yaml"


@pytest.mark.parametrize(("policy", "won"), [("search:0", 1), ("search:1", 3)])
def test_a_belief_about_a_belief_decides(policy: str, won: int) -> None:
    successes = 0
    for x in (1, 3, 5):
        task = bn.Task.load(str(FILE), believed=[x, 1, 2])
        with bn.Episode(task, {"anne": policy}) as episode:
            successes += episode.play().success
    assert successes == won
