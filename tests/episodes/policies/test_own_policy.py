"""A policy of the user's own that asks a model: counted, limited, and told when it fails."""

import pytest

import beliefnest as bn
from beliefnest.errors import ModelError
from beliefnest.llm import Answer, Sampling, Usage, ask_for_program
from beliefnest.llm.failures import UnavailableModelError

PROGRAM = "```javascript\nawait think(bot, 'x')\n```"


class Priced:
    name = "mine"

    def __init__(self):
        self.asked = 0

    def answer(self, messages, sampling):
        self.asked += 1
        return Answer(PROGRAM, Usage(1, 100, 7, 0.01))


class Gone(Priced):
    def answer(self, messages, sampling):
        raise UnavailableModelError("no server")


class Failing(Priced):
    def answer(self, messages, sampling):
        raise ModelError("dropped the connection")


class Asking:
    def __init__(self, model):
        self.model = model

    def act(self, view):
        model = view.noting(self.model)
        return ask_for_program(model, "Think.", lambda _: None, sampling=Sampling()).program


class Leaving:
    def act(self, view):
        raise SystemExit(3)


class Imagining:
    def act(self, view):
        mind = view.imagine(0)
        trial = mind.fork()
        self.first = trial.run("anne", "await say(bot, 'hello'); throw new Error('no')")
        self.then = mind.run("anne", "await say(bot, Math.random().toString())")
        self.again = view.imagine(0).run("anne", "await say(bot, Math.random().toString())")
        self.happened = [len(each.happened) for each in (trial, mind)]
        return ""


def episode(policy, **options):
    task = bn.Task.load("recipe", seed=3)
    return bn.Episode(task, {"anne": policy, "bob": "search:0"}, **options)


@pytest.mark.parametrize("patience", [None, 60])
def test_the_measures_count_a_model_that_is_noted(patience):
    with episode(Asking(Priced()), patience_s=patience) as played:
        measures = played.play(2).measures
        assert (measures.requests, measures.tokens) == (2, 214)
        assert measures.cost == pytest.approx(0.02)
        assert [prompt.cost for prompt in played.nest.prompts()] == [0.01, 0.01]


def test_the_limits_of_an_episode_hold_within_a_round():
    class Talkative(Asking):
        def act(self, view):
            for _ in range(5):
                super().act(view)
            return ""

    model = Priced()
    with episode(Talkative(model), budget=bn.Budget(cost=0.02)) as played:
        played.play(1)
        assert model.asked == 2
        assert played.is_over
        (failure,) = played.failures
        assert "has cost 0.02 US dollars and may cost 0.02" in failure.reason


def test_a_limit_of_nothing_admits_a_model_that_costs_nothing():
    class Free(Priced):
        def answer(self, messages, sampling):
            return Answer(PROGRAM, Usage(1, 100, 7, 0.0))

    with episode(Asking(Free()), budget=bn.Budget(cost=0)) as played:
        assert played.play(2).measures.requests == 2


def test_a_model_that_cannot_be_asked_ends_the_episode():
    with episode(Asking(Gone())) as played, pytest.raises(ModelError, match="no server"):
        played.play(2)


def test_a_model_without_an_answer_loses_rounds_and_is_kept_in_mind():
    with episode(Asking(Failing())) as played:
        played.play(2)
        assert [str(error) for error in played.model_errors] == ["dropped the connection"] * 2


@pytest.mark.parametrize("patience", [None, 60])
def test_a_policy_that_exits_loses_its_round(patience):
    with episode(Leaving(), patience_s=patience) as played:
        played.play(1)
        assert "SystemExit: 3" in played.failures[0].reason


def test_an_imagination_runs_programs():
    policy = Imagining()
    with episode(policy) as played:
        before = played.nest.tick
        played.play(1)
        assert played.nest.tick > before
        assert played.measures.messages == 0
    assert (policy.first.ok, policy.then.ok) == (False, True)
    assert policy.first.said[0][1] == "hello"
    assert policy.then.said == policy.again.said
    assert policy.happened == [1, 1]
