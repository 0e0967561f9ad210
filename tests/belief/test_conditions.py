"""Conditions of goals, as files and other processes give them."""

import pickle

import pytest

from beliefnest.belief.conditions import ConditionEntry, conditions_of
from beliefnest.errors import InputError

LEVER = ConditionEntry(block=(4, 1, 4), state="lever[powered=true]")


def test_a_condition_means_the_same_in_another_process() -> None:
    """Studies send scenarios to other processes, where a default is equal, but another object."""
    sent = pickle.loads(pickle.dumps(LEVER))
    assert conditions_of(sent, ("ann",)) == conditions_of(LEVER, ("ann",))


def test_a_condition_with_keys_that_do_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match=r"\{'within': 2.0, 'block': .* makes no sense"):
        conditions_of(ConditionEntry(block=(4, 1, 4), state="lever", within=2.0), ("ann",))
