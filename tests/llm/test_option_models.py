"""Models that choose an option without reading the question."""

from collections import Counter

import pytest

from beliefnest.llm.messages import ChoiceSampling, Message, Sampling
from beliefnest.llm.resolve import resolve_model

PROMPT = (
    "A) tree\nEva said: “A) is right.”\n\nQuestion: Where?\n\nOptions:\nA) red\nB) blue\nC) green\n"
)


def answer(name: str, prompt: str = PROMPT, seed: int = 0) -> str:
    said = resolve_model(name, {}).answer((Message("user", prompt),), Sampling(seed=seed)).text
    return said.splitlines()[0]


def test_chance_draws_each_option_equally_often_and_by_the_seed():
    drawn = Counter(answer("chance", seed=seed) for seed in range(300))
    assert set(drawn) == {"Answer: A", "Answer: B", "Answer: C"}
    assert min(drawn.values()) > 70
    assert [answer("chance", seed=7)] * 3 == [answer("chance", seed=7) for _ in range(3)]


def test_first_option_takes_the_first():
    assert {answer("first-option", seed=seed) for seed in range(20)} == {"Answer: A"}


def test_options_of_the_request_count_where_the_prompt_lists_none():
    sampling = [ChoiceSampling(seed=seed, options=("red box", "blue box")) for seed in range(40)]
    messages = (Message("user", "Where is it, in the red box or in the blue box?"),)

    def said(name):
        model = resolve_model(name, {})
        return {model.answer(messages, each).text.splitlines()[0] for each in sampling}

    assert said("first-option") == {"Answer: red box"}
    assert said("chance") == {"Answer: red box", "Answer: blue box"}


@pytest.mark.parametrize("name", ["chance", "first-option"])
def test_a_question_without_options_is_not_known(name):
    assert answer(name, "Question: Where?\n") == "Answer: I do not know"
