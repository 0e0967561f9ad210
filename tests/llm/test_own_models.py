"""Models of the user's own, by file, module and entry point."""

import pytest
from tests.installing import install

from beliefnest.errors import InputError, ModelError, UnknownNameError
from beliefnest.llm import (
    Connection,
    Message,
    RunLimits,
    RunSpending,
    Sampling,
    model_names,
    open_model,
    resolve_model,
)
from beliefnest.llm.resolve import can_vary, is_free, is_own

ASK = (Message("user", "Get a diamond."),)
SOURCE = """
import sys
from beliefnest.llm import Answer, Usage

class Mine:
    def answer(self, messages, sampling):
        return Answer(f"heard {messages[-1].text}", Usage(1, 100, 7, 0.25))

class Broken(Mine):
    def answer(self, messages, sampling):
        raise KeyError("key")

class Leaving(Mine):
    def answer(self, messages, sampling):
        sys.exit(4)

class Wordy(Mine):
    def answer(self, messages, sampling):
        return "heard"

class Needy(Mine):
    def __init__(self, key): ...

def made():
    return Mine()

ready = Mine()
number = 3
nothing = list
"""


@pytest.fixture
def own(tmp_path, monkeypatch):
    file = tmp_path / "own_models_here.py"
    file.write_text(SOURCE, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    return file


@pytest.mark.parametrize("made", ["Mine", "made", "ready"])
@pytest.mark.parametrize("by", ["file", "module"])
def test_a_model_is_found_by_file_and_by_module(own, made, by):
    name = f"{own if by == 'file' else own.stem}:{made}"
    model = resolve_model(name, {})
    assert (model.name, model.answer(ASK, Sampling()).text) == (name, "heard Get a diamond.")
    assert is_own(name)
    assert can_vary(name)
    assert not is_free(name, {})


def test_a_model_is_found_by_the_name_of_an_entry_point(own):
    install(own.parent, "parrots", "[beliefnest.models]\nparrot = own_models_here:Mine\n")
    assert resolve_model("parrot", {}).answer(ASK, Sampling()).text == "heard Get a diamond."
    assert "parrot" in model_names()
    with pytest.raises(UnknownNameError, match="did you mean parrot"):
        resolve_model("parot", {})


@pytest.mark.parametrize(
    ("made", "told"),
    [
        ("Gone", "has no model 'Gone'"),
        ("number", "is no class and no function"),
        ("nothing", "makes no model: list has no method answer"),
        ("Needy", "cannot be called without arguments"),
    ],
)
def test_what_makes_no_model_is_refused(own, made, told):
    with pytest.raises(InputError, match=told):
        resolve_model(f"{own}:{made}", {})


@pytest.mark.parametrize(
    ("made", "told"),
    [
        ("Broken", "raised KeyError: 'key'"),
        ("Leaving", "raised SystemExit: 4"),
        ("Wordy", "gave str and no answer; return"),
    ],
)
def test_a_model_that_fails_says_what_it_raised(own, made, told):
    with pytest.raises(ModelError, match=told):
        resolve_model(f"{own}:{made}", {}).answer(ASK, Sampling())


def test_the_limits_of_a_run_hold_for_it(own):
    connection = Connection(budget=RunSpending(RunLimits(tokens=None, cost=0.5)))
    model = open_model(f"{own}:Mine", {}, connection)
    for _ in range(2):
        model.answer(ASK, Sampling())
    with pytest.raises(ModelError, match=r"has cost 0\.50 US dollars"):
        model.answer(ASK, Sampling())


def test_a_limit_of_nothing_admits_free_models_only(fake, own):
    fake.will(fake.says("go();"))
    nothing = Connection(budget=RunSpending(RunLimits(cost=0)))
    free = open_model("vllm:m", {"VLLM_BASE_URL": fake.url}, nothing)
    assert [free.answer(ASK, Sampling()).text for _ in range(2)] == ["go();"] * 2
    for name in (f"{own}:Mine", "openai:gpt-4o-mini"):
        keys = {"OPENAI_API_KEY": "k", "OPENAI_BASE_URL": fake.url}
        with pytest.raises(ModelError, match=r"may cost 0\.00"):
            open_model(name, keys, nothing).answer(ASK, Sampling())
