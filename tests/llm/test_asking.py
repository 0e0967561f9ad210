"""Requests for programs, and faults sent back."""

from collections import deque
from dataclasses import replace

import pytest

from beliefnest.errors import InputError, ModelError
from beliefnest.llm import NoUsableProgramError, Sampling, Usage, ask_for_program
from beliefnest.llm.messages import Answer
from beliefnest.llm.recorded_models import ScriptedModel


class Listening(ScriptedModel):
    """A scripted model that keeps what it was asked."""

    def __init__(self, *answers):
        super().__init__("scripted:test", deque(answers))
        self.asked = []

    def answer(self, messages, sampling):
        self.asked.append((tuple((m.role, m.text) for m in messages), sampling))
        return Answer(super().answer(messages, sampling).text, Usage(1, 10, 5, 0.5))


def fenced(code, language="javascript"):
    return f"```{language}\n{code}\n```"


def no_fault(program):
    return None


def complains_of_a(program):
    return "a is not defined" if program == "a();" else None


def test_a_good_program_at_once():
    model = Listening(fenced("a();"))
    sampling = Sampling(seed=3)
    found = ask_for_program(model, "Do it.", no_fault, system="JS only.", sampling=sampling)
    assert found.program == "a();"
    assert found.usage == Usage(1, 10, 5, 0.5)
    assert model.asked == [((("system", "JS only."), ("user", "Do it.")), sampling)]


def test_faults_are_sent_back_in_the_conversation():
    model = Listening(fenced("a();"), "No.", fenced("b();"))
    found = ask_for_program(model, "Do it.", complains_of_a)
    assert found.program == "b();"
    assert [each.complaint for each in found.attempts] == [
        "a is not defined",
        "the answer holds no program: No.",
        None,
    ]
    assert found.usage.tokens == 45
    last, _ = model.asked[-1]
    assert [role for role, _ in last] == ["user", "assistant", "user", "assistant", "user"]
    assert last[1][1] == fenced("a();")
    assert "a is not defined" in last[2][1]
    assert "no program" in last[4][1]


def test_a_template_is_rendered_anew_with_code_and_error():
    model = Listening(fenced("a();"), fenced("b();"))
    found = ask_for_program(model, lambda code, error: f"{code}|{error}", complains_of_a)
    assert found.program == "b();"
    assert [asked for asked, _ in model.asked] == [
        (("user", "None|None"),),
        (("user", "a();|a is not defined"),),
    ]


def test_attempts_end_with_the_last_fault():
    model = Listening(fenced("a();"), fenced("a();"), fenced("b();"))
    with pytest.raises(ModelError, match=r"scripted:test.*2 attempts: a is not defined"):
        ask_for_program(model, "Do it.", complains_of_a, attempts=2)
    assert len(model.asked) == 2


def test_a_model_s_own_failure_ends_the_asking():
    with pytest.raises(ModelError, match="no answer left"):
        ask_for_program(Listening(), "Do it.", no_fault)


def test_no_attempts_are_refused():
    with pytest.raises(InputError, match="at least 1"):
        ask_for_program(Listening(), "Do it.", no_fault, attempts=0)


@pytest.mark.parametrize(
    ("finish", "complaint"), [("length", "cut the answer off"), ("content_filter", "model refused")]
)
def test_a_program_that_the_model_did_not_finish_is_none(finish, complaint):
    class Cut(Listening):
        def answer(self, messages, sampling):
            return replace(super().answer(messages, sampling), finish=finish)

    with pytest.raises(NoUsableProgramError, match=complaint) as caught:
        ask_for_program(Cut("", fenced("a();")), "Do it.", lambda _: None, attempts=2)
    assert [each.program for each in caught.value.attempts] == [None, None]


def test_an_answer_without_a_program_is_asked_for_again_beyond_the_attempts():
    model = Listening("No.", "Hm.", fenced("a();"))
    found = ask_for_program(model, "Do it.", no_fault, attempts=1, retry_unread=2)
    assert (found.program, found.asked_again) == ("a();", 2)
    with pytest.raises(NoUsableProgramError) as caught:
        ask_for_program(Listening("No.", "Hm."), "Do it.", no_fault, attempts=1, retry_unread=1)
    assert caught.value.outcome == "unread"
    # A program with a fault is an answer.
    with pytest.raises(NoUsableProgramError) as caught:
        ask_for_program(Listening(fenced("a();")), "", complains_of_a, attempts=1, retry_unread=3)
    assert caught.value.outcome == "program_failed"
