"""Policies that ask models: what they are told by order, and what comes of bad answers."""

import threading

import pytest
from tests.llm.conftest import FakeOpenAI, fake

import beliefnest as bn
from beliefnest.episodes.episode import Budget
from beliefnest.episodes.policies import resolve_policy

__all__ = ["fake"]

GOOD = "```javascript\nawait say(bot, 'hello')\n```"


@pytest.fixture
def server(fake: FakeOpenAI, monkeypatch: pytest.MonkeyPatch) -> FakeOpenAI:
    monkeypatch.setenv("OPENAI_API_KEY", "sk-test")
    monkeypatch.setenv("OPENAI_BASE_URL", f"{fake.url}/v1")
    return fake


def prompt_of(order: str) -> str:
    with bn.Episode(
        bn.Task.load("help-find", seed=1), {"anne": f"model:offline:{order}"}
    ) as played:
        played.play(1)
        (record,) = played.nest.prompts()
    return record.messages[-1][1]


def test_the_order_decides_what_a_model_is_told() -> None:
    told = [prompt_of(order) for order in ("0", "1", "2")]
    believed = "<What you take sally to believe>"
    assert [believed in each for each in told] == [False, True, True]
    assert ["that you believe>" in each for each in told] == [False, False, True]
    assert "<What sally believes>" in prompt_of("omniscient")


def test_nobody_is_told_what_the_task_is_about() -> None:
    task = bn.Task.load("help-find", seed=1)
    for order in ("0", "1", "2", "omniscient"):
        assert "moved while she was away" in task.form.description
        assert "moved while she was away" not in prompt_of(order)


def test_the_offline_model_plays(tmp_path) -> None:
    task = bn.Task.load("help-find", seed=1)
    policies = dict.fromkeys(task.agents, "model:offline:1")
    with bn.Episode(task, policies, store=tmp_path / "e.bn") as episode:
        row = episode.play(3).measures
        assert row.lost_rounds == row.requests == 0
    with bn.Episode.replay(tmp_path / "e.bn") as replayed:
        replayed.play(3)
        assert replayed.nest.prompts() == ()
        assert replayed.measures == row


def test_answers_are_counted(server: FakeOpenAI) -> None:
    server.will(server.says(GOOD))
    with bn.Episode(bn.Task.load("help-find"), {"anne": "model:openai:gpt-4o-mini:1"}) as episode:
        measures = episode.play(2).measures
        assert [line[2] for line in episode.nest["/"].state.chat] == ["hello", "hello"]
    assert (measures.requests, measures.tokens, measures.messages) == (2, 300, 2)


def test_a_model_that_answers_nonsense_costs_its_own_rounds(server: FakeOpenAI) -> None:
    server.will(server.says("I would rather not."), server.says("```javascript\nawait await(\n```"))
    with bn.Episode(bn.Task.load("help-find"), {"anne": "model:openai:gpt-4o-mini:0"}) as episode:
        episode.play(2)
        ended = [part.ended["anne"].how for part in episode.parts]
        others = [part.ended["sally"].how for part in episode.parts]
    assert ended == ["failed", "failed"]
    assert others == ["cut", "cut"]


def test_a_model_that_says_nothing_in_time_costs_its_own_round(server: FakeOpenAI) -> None:
    server.will(server.says_nothing)
    task = bn.Task.load("help-find")
    policies = {"anne": "model:openai:gpt-4o-mini:0"}
    with bn.Episode(task, policies, patience_s=3.0) as episode:
        episode.play(1)
        (part,) = episode.parts
        server.closing.set()
    assert "more than 3 s" in part.decisions["anne"].fault
    assert part.ended["sally"].how == "cut"


def test_what_cannot_be_used_is_paid_for(server: FakeOpenAI) -> None:
    server.will(server.says("I would rather not."), server.says(""))
    with bn.Episode(bn.Task.load("help-find"), {"anne": "model:openai:gpt-4o-mini:0"}) as episode:
        measures = episode.play(1).measures
    assert (measures.lost_rounds, measures.requests, measures.tokens) == (1, 2, 300)


def test_what_comes_too_late_is_paid_for(server: FakeOpenAI) -> None:
    server.will(server.says(GOOD))
    model, asked, released = resolve_policy("model:openai:gpt-4o-mini:0"), [0], threading.Event()

    class Slow:
        """Asks once, and is a round late."""

        @property
        def spent(self) -> object:
            return model.spent  # type: ignore[attr-defined]

        def act(self, view: bn.AgentView) -> str:
            asked[0] += 1
            if asked[0] > 1:
                return ""
            released.wait()
            return model.act(view)

    with bn.Episode(bn.Task.load("help-find"), {"anne": Slow()}, patience_s=3.0) as episode:
        assert episode.play(1).spent.requests == 0
        released.set()
        for thread in threading.enumerate():
            if thread.name == "policy of anne":
                thread.join()
        assert episode.play(1).spent.requests == 1


def test_an_episode_ends_when_its_tokens_are_spent(server: FakeOpenAI) -> None:
    server.will(server.says("```javascript\nawait think(bot, 'hm')\n```"))
    task, policies = bn.Task.load("help-find"), {"anne": "model:openai:gpt-4o-mini:0"}
    with bn.Episode(task, policies, budget=Budget(tokens=301)) as episode:
        assert episode.play().rounds == 3
        assert episode.is_over


def test_names_of_models_are_checked() -> None:
    with pytest.raises(bn.InputError, match="not complete"):
        resolve_policy("model:offline")
    with pytest.raises(bn.InputError, match="no order"):
        resolve_policy("model:offline:x")
    with pytest.raises(bn.UnknownNameError, match="no model"):
        resolve_policy("model:nobody:gpt:1")
