"""Requests to models, their answers and the programs are kept in the run as it happens."""

import pytest
from tests.nest.places import BOX, GAP, MEETING, WEST

import beliefnest as bn
from beliefnest.errors import ModelError
from beliefnest.llm import Answer, Message, Sampling, Usage, ask_for_program
from beliefnest.nest.face import opening
from beliefnest.timeline.journal import TimelineKey

AGENTS = {"observer": WEST, "sally": MEETING, "anne": GAP}
MAIN = TimelineKey((), "main")
PLAN = TimelineKey(("observer",), "plan")


class Told:
    """Gives answers in turn, or fails where one is an error; calls back before each."""

    name = "told"

    def __init__(self, answers, before=lambda: None):
        self._answers = list(answers)
        self._before = before

    def answer(self, messages, sampling):
        self._before()
        answer = self._answers.pop(0)
        if isinstance(answer, ModelError):
            raise answer
        return Answer(answer, Usage(1, 20, 3, 0.25), cached=answer == "kept")


def open_in(store):
    return bn.Nest(bn.ScriptedWorld(BOX, agents=AGENTS), store=store)


def ask(simulator, *answers, before=lambda: None, **detail):
    """Hold a conversation of as many requests as there are answers."""
    model = simulator.noting(Told(answers, before), **detail)
    assert model.name == "told"
    for number in range(len(answers)):
        model.answer([Message("system", "be brief"), Message("user", f"{number}?")], Sampling())


@pytest.fixture(params=["memory", "file"])
def nest(request, tmp_path):
    with open_in(None if request.param == "memory" else tmp_path / "run.bn") as opened:
        yield opened


def test_every_request_is_kept_with_its_answer(nest):
    nest.scripted_world.step(7)
    ask(nest["/observer/sally"], "first", "kept", task="Go.")
    one, other = nest.prompts()
    assert (one.path, one.timeline, one.branch, one.tick) == (
        ("observer", "sally"),
        MAIN,
        "follow",
        7,
    )
    assert (one.model, one.attempt, one.answer, one.error) == ("told", 1, "first", None)
    assert one.messages == (("system", "be brief"), ("user", "0?"))
    assert one.sampling == {"temperature": 0.0, "seed": None, "max_output_tokens": None}
    assert (one.requests, one.input_tokens, one.output_tokens, one.cost) == (1, 20, 3, 0.25)
    assert (one.cached, other.cached) == (False, True)
    assert one.detail == {"task": "Go."}
    assert (other.attempt, other.answer) == (2, "kept")


def test_each_conversation_counts_for_itself_on_the_branch_it_is_on(nest):
    belief = nest["/observer"]
    ask(nest["/observer/sally"], "a")
    belief.switch("plan")
    belief.step(4)
    ask(belief, "b")
    ask(nest["/observer/sally"], "c")
    told = [(p.timeline, p.branch, p.tick, p.attempt) for p in nest.prompts()]
    assert told == [(MAIN, "follow", 0, 1), (PLAN, "plan", 4, 1), (PLAN, "follow", 4, 1)]


def test_what_a_model_could_not_answer_is_kept_too(nest):
    with pytest.raises(ModelError, match="no such model"):
        ask(nest["/sally"], ModelError("no such model"))
    (asked,) = nest.prompts()
    assert (asked.answer, asked.error, asked.requests) == (None, "no such model", 0)


def test_answers_sent_back_for_a_fault_are_kept_in_their_order(nest):
    answers = ["I cannot.", "```javascript\nawait bot.one()\n```"]
    model = nest["/anne"].noting(Told(answers))
    given = ask_for_program(model, "Go.", check=lambda program: None)
    assert [p.answer for p in nest.prompts()] == answers
    assert [p.messages for p in nest.prompts()] == [
        tuple((m.role, m.text) for m in each.messages) for each in given.attempts
    ]


def test_what_was_asked_is_renamed_and_deleted_with_the_branch_it_was_asked_on(nest):
    belief = nest["/observer"]
    ask(nest["/sally"], "reality")
    belief.switch("plan")
    ask(nest["/observer/anne"], "believed")
    belief.rename("plan", "better")
    assert [p.timeline.branch for p in nest.prompts()] == ["main", "better"]
    belief.switch("follow")
    belief.delete("better")
    assert [p.answer for p in nest.prompts()] == ["reality"]


def test_an_answer_can_be_read_before_the_next_is_there(tmp_path):
    store = tmp_path / "run.bn"
    seen = []

    def look():
        with bn.Nest.read(store) as reading:
            seen.append([p.answer for p in reading.prompts()])

    with open_in(store) as nest:
        ask(nest["/sally"], "one", "two", "three", before=look)
    look()
    assert seen == [[], ["one"], ["one", "two"], ["one", "two", "three"]]
    with bn.Nest.resume(store) as nest:
        ask(nest["/sally"], "four")
        assert [p.answer for p in nest.prompts()] == ["one", "two", "three", "four"]


@pytest.mark.parametrize("stored", [True, False])
def test_versions_of_what_runs_are_kept(tmp_path, stored):
    with open_in(tmp_path / "run.bn" if stored else None) as nest:
        (versions,) = nest.versions()
    assert {"beliefnest", "python", "sqlite", "numpy", "numba"} <= versions.keys()


def test_a_run_that_goes_on_with_other_versions_says_so(tmp_path, monkeypatch):
    store = tmp_path / "run.bn"
    with open_in(store) as nest:
        (first,) = nest.versions()
    with bn.Nest.resume(store) as nest:
        assert nest.versions() == (first,)
    monkeypatch.setattr(opening, "own_versions", lambda: {"numpy": "99.0"})
    for _ in range(2):
        with bn.Nest.resume(store) as nest:
            assert nest.versions() == (first, {**first, "numpy": "99.0"})
    with bn.Nest.read(store) as reading:
        assert len(reading.versions()) == 2
