"""The checks for plugins of others pass what keeps a protocol, and say what breaks it."""

import itertools

import pytest

from beliefnest.prompts import filter as prompt_filter
from beliefnest.testing import check_filter, check_policy, check_world
from beliefnest.worlds.scripted.nest_world import ScriptedBody, ScriptedNestWorld

TASK, AGENT = "tell-what-is-needed", "nora"


class Hasty(ScriptedBody):
    def step(self, ticks):
        super().step(ticks + 1)


class Deaf(ScriptedBody):
    def set_state(self, snapshot):
        pass


class Lenient(ScriptedBody):
    def run(self, programs, *rest, **rules):
        there = {name: text for name, text in programs.items() if name in self.world.agents}
        return super().run(there, *rest, **rules)


class Otherwise(ScriptedNestWorld):
    """Scripted world with bodies of another class."""

    def __init__(self, kind):
        super().__init__()
        self.kind = kind

    def open_body(self, *arguments):
        body = super().open_body(*arguments)
        body.__class__ = self.kind
        return body


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        (Hasty, r"step\(5\) took 6 ticks"),
        (Deaf, r"tick after set_state: .* but 3 is right"),
        (Lenient, "not there must raise WorldError"),
    ],
)
def test_a_world_that_breaks_its_protocol_is_told_where(kind, message):
    with pytest.raises(AssertionError, match=message):
        check_world(Otherwise(kind))


def test_a_policy_must_decide_the_same_again():
    class Counting:
        numbers = itertools.count()

        def act(self, view):
            return f"await think(bot, '{next(self.numbers)}')"

    class Steady:
        def act(self, view):
            return f"await think(bot, '{view.agent}')"

    check_policy(Steady, TASK, AGENT)
    with pytest.raises(AssertionError, match=r"round 0: .*'0'.* at first, and .*'3'"):
        check_policy(Counting, TASK, AGENT)


def test_a_filter_must_return_the_same_text_again():
    @prompt_filter("ticks")
    def ticks(branch, unit="ticks"):
        return f"{branch.state.tick} {unit}"

    @prompt_filter("bare")
    def bare(branch):
        return branch.state.tick

    numbers = itertools.count()

    @prompt_filter("counting")
    def counting(branch):
        return str(next(numbers))

    check_filter(ticks)
    check_filter(ticks, unit="steps")
    with pytest.raises(AssertionError, match=r"bare returned .* return a text"):
        check_filter(bare)
    with pytest.raises(AssertionError, match="counting returned '0' at first, and then '1'"):
        check_filter(counting)
