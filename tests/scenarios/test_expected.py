"""Expectations about a probe, each judged by its program, deeds, words or answers."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.llm.messages import Answer, Finish, Message, Model, Sampling
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.llm.offline import OfflineModel
from beliefnest.llm.option_models import OPTION_MODELS
from beliefnest.scenarios.outcome import ProbeOutcome
from beliefnest.scenarios.probing import Asking
from beliefnest.scenarios.records import probe_json
from beliefnest.scenarios.running import run_scenario
from beliefnest.scenarios.trial import Trial

BLUE, RED, NOWHERE = [1, 1, 5], [7, 1, 5], [4, 1, 1]
WALLED = [4, 1, 8]
pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOM: dict[str, Any] = {
    "name": "room",
    "box": [[0, 0, 0], [8, 3, 9]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [8, 0, 9]]},
        {"block": "bricks", "fill": [[0, 1, 7], [8, 3, 7]]},
    ],
    "containers": [
        {"label": "blue box", "at": BLUE, "items": {"apple": 1}},
        {"label": "red box", "at": RED},
    ],
    "agents": {"ann": {"position": [4.5, 1, 4.5]}, "bob": {"position": [4.5, 1, 6.5]}},
    "static_blocks": ["stone", "bricks"],
    "perception": {"containers": "transparent"},
}


class Parrot:
    """Answers everything with one text."""

    name = "parrot"

    def __init__(self, text: str, finish: Finish = "stop") -> None:
        self.text = text
        self.finish = finish

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        return Answer(self.text, finish=self.finish)


class Hesitant:
    """Gives several answers, one after the other."""

    name = "hesitant"

    def __init__(self, *texts: str) -> None:
        self.texts = list(texts)
        self.asked: list[Sequence[Message]] = []

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        self.asked.append(messages)
        return Answer(self.texts.pop(0))


def programmed(program: str) -> Parrot:
    return Parrot(f"```javascript\n{program}\n```")


def run(
    model: Model, expect: dict[str, Any] | None, world: str = "scripted", retry_unread: int = 0
) -> ProbeOutcome:
    expect = expect and {"within": 2, **expect}
    probe = {"path": "/ann", "acts_in": "/ann", "agent": "ann", "task": "Go.", "expect": expect}
    scenario = bn.Scenario.from_mapping({**ROOM, "probes": [probe]})
    asking = Asking(attempts=1, settings=ModelSettings(retry_unread=retry_unread))
    with bn.Nest.open(scenario, world=world) as nest:
        outcome = run_scenario(nest, scenario, model, 0, 0.0, lambda *_: None, asking)
    return outcome.probes[0]


TAKE = "await getItemFromChest(bot, new Vec3({}), {{apple: 1}});"
GO = "await goToPosition(bot, new Vec3({}), 1);"


@pytest.mark.parametrize(
    ("program", "expect", "outcome"),
    [
        (TAKE.format("1, 1, 5"), {"intends": BLUE, "opens": BLUE, "takes": {"apple": 1}}, "ok"),
        (TAKE.format("7, 1, 5"), {"intends": RED}, "ok"),
        (TAKE.format("7, 1, 5"), {"intends": BLUE}, "wrong"),
        (TAKE.format("7, 1, 5"), {"opens": RED, "takes": {"apple": 1}}, "program_failed"),
        # Told of a box that is not there, it went to look for it.
        (GO.format("4, 1, 1") + TAKE.format("4, 1, 1"), {"intends": NOWHERE}, "ok"),
        (TAKE.format("4, 1, 1"), {"opens": BLUE}, "program_failed"),
        (GO.format("4, 1, 9"), {"intends": WALLED}, "ok"),
        (GO.format("4, 1, 9"), {"arrives": WALLED}, "no_way"),
        (GO.format("2, 1, 2"), {"arrives": WALLED}, "wrong"),
        ("say(bot, 'to (4, 1, 1)')", {"intends": NOWHERE}, "wrong"),
        ("await say(bot, 'It is in the BLUE box.')", {"says": "blue box"}, "ok"),
        ("await say(bot, 'Hm.')", {"says": "blue box"}, "wrong"),
        ("await nothing()", {"says": "blue box"}, "program_failed"),
        (
            TAKE.format("1, 1, 5"),
            {"believes": {"path": "/ann/bob", "container": BLUE, "items": {}}},
            "ok",
        ),
    ],
)
def test_programs_are_judged(program: str, expect: dict[str, Any], outcome: str) -> None:
    found = run(programmed(program), expect)
    assert (found.outcome, found.ok) == (outcome, outcome == "ok")
    assert bool(found.why_not) == (outcome != "ok")


def test_what_a_program_makes_for_is_known_in_minecraft_too() -> None:
    program = GO.format("4, 1, 1") + TAKE.format("4, 1, 1")
    found = run(programmed(program), {"intends": NOWHERE}, world="embedded")
    assert (found.outcome, found.intended) == ("ok", (4, 1, 1))
    assert "no chest" in str(found.error)
    found = run(programmed(GO.format("4, 1, 9")), {"arrives": WALLED}, world="embedded")
    assert found.outcome == "no_way"


def test_no_answer_is_an_outcome_of_its_own() -> None:
    found = run(Parrot("I would rather not."), {"opens": BLUE})
    assert (found.outcome, found.ok, found.program) == ("unread", False, "")
    assert probe_json(found, "here")["why_not"]


def test_a_function_judges() -> None:
    def is_quick(trial: Trial) -> bool | str:
        return trial.result.ticks < 3 or f"it took {trial.result.ticks} ticks"

    assert run(programmed("await doNothing(bot)"), {"function": is_quick}).outcome == "ok"
    found = run(programmed("await bot.waitForTicks(5)"), {"function": is_quick})
    assert (found.outcome, found.why_not) == ("wrong", "it took 5 ticks")
    assert run(programmed("await doNothing(bot)"), {"function": lambda _: 1 / 0}).outcome == "error"


def test_a_function_of_a_file_has_to_be_there() -> None:
    with pytest.raises(bn.InputError, match="no_such_module"):
        run(programmed(""), {"function": "no_such_module:judge"})
    with pytest.raises(bn.ScenarioError, match="module:function"):
        run(programmed(""), {"function": "no function"})


WHERE = {"question": "Where is the apple?", "right": "blue box", "reason": True}
CHOICE = {**WHERE, "options": ["red box", "blue box", "neither"]}


@pytest.mark.parametrize("asked", [WHERE, CHOICE])
def test_the_offline_model_answers_from_its_prompt(asked: dict[str, Any]) -> None:
    found = run(OfflineModel(), {"answers": asked})
    (reply,) = found.replies
    assert (found.outcome, reply.answer) == ("ok", "blue box")
    assert "apple" in reply.reason
    assert "Question: Where is the apple?" in reply.prompt
    assert sorted(reply.options) == sorted(asked.get("options", []))
    assert found.program == ""


def test_what_the_prompt_does_not_tell_is_not_answered() -> None:
    asked = {"question": "Is Bob tired?", "right": "yes", "options": ["yes", "no"]}
    assert run(OfflineModel(), {"answers": asked}).outcome == "unread"


IN_WORDS = {
    "the blue box": "ok",
    "blue": "ok",
    "It's in the blue box, not the red one.": "ok",
    "the red box": "wrong",
    "in the attic": "wrong",
    "not in the blue box": "unread",
    "not in the red box": "unread",
    "in the blue box or the red box": "ambiguous",
    "in the blue box or somewhere else": "ambiguous",
    "I'm sorry, but I can't help with that.": "refused",
    "": "unread",
    "<think>It is in the blue box.": "unread",
}


@pytest.mark.parametrize(("text", "outcome"), IN_WORDS.items())
def test_an_answer_in_words_names_one_thing(text: str, outcome: str) -> None:
    found = run(Parrot(text), {"answers": WHERE})
    assert (found.outcome, found.ok) == (outcome, outcome == "ok")
    assert bool(found.why_not) == (outcome != "ok")


@pytest.mark.parametrize(
    ("text", "finish", "outcome"),
    [
        ("Answer: blue box", "stop", "ok"),
        ("Answer: red box", "stop", "wrong"),
        ("Answer: red box or blue box", "stop", "ambiguous"),
        ("Answer: green box", "stop", "unread"),
        ("Answer: blue box", "length", "cut"),
        ("", "content_filter", "refused"),
    ],
)
def test_each_end_of_an_answer_has_its_outcome(text: str, finish: Finish, outcome: str) -> None:
    found = run(Parrot(text, finish), {"answers": CHOICE})
    assert (found.outcome, found.replies[0].answer is None) == (
        outcome,
        outcome not in ("ok", "wrong"),
    )


@pytest.mark.parametrize("name", ["chance", "first-option"])
def test_baselines_answer_whatever_template_asks(name: str) -> None:
    probe = {"path": "/ann", "acts_in": "/ann", "agent": "ann", "expect": {"answers": CHOICE}}
    scenario = bn.Scenario.from_mapping({**ROOM, "probes": [probe]})
    own = replace(scenario.probes[0], template="{{ task }} One of {{ options | join(', ') }}?")
    asked = replace(scenario, probes=(own,))
    with bn.Nest.open(asked, world="scripted") as nest:
        found = run_scenario(nest, asked, OPTION_MODELS[name], 0, 0.0, lambda *_: None)
    assert found.probes[0].replies[0].answer in CHOICE["options"]


def test_an_unreadable_answer_is_asked_for_again_with_the_form() -> None:
    model = Hesitant("Hm.", "red box or blue box", "Answer: blue box")
    found = run(model, {"answers": CHOICE}, retry_unread=2)
    assert (found.outcome, found.asked_again) == ("ok", 2)
    assert "Answer in this form" in model.asked[-1][-1].text
    model = Hesitant("Hm.", "Hm?", "Answer: blue box")
    assert run(model, {"answers": CHOICE}, retry_unread=1).outcome == "unread"
    # A wrong answer is an answer.
    model = Hesitant("Answer: red box", "Answer: blue box")
    assert run(model, {"answers": CHOICE}, retry_unread=1).outcome == "wrong"


@pytest.mark.parametrize(
    ("expect", "told"),
    [
        ({"takes": {}}, "expect.takes: name at least one item"),
        ({"says": " "}, "expect.says: is empty; give part of an utterance"),
        (
            {
                "answers": {
                    "question": "Where?",
                    "right": ["here", "there"],
                    "options": ["here", "there"],
                }
            },
            "options: are all right",
        ),
        (
            {"answers": {"question": "Where?", "right": "A", "options": ["A", "B"]}},
            "options: 'A' is a single letter, which names an option",
        ),
        (
            {"answers": {"question": "Where?", "right": "here", "wrong": ["here"]}},
            "wrong: 'here' is right as well",
        ),
    ],
)
def test_what_cannot_fail_or_cannot_be_right_is_refused(expect: dict[str, Any], told: str) -> None:
    expect = expect and {"within": 2, **expect}
    probe = {"path": "/ann", "acts_in": "/ann", "agent": "ann", "task": "Go.", "expect": expect}
    with pytest.raises(bn.ScenarioError, match=told):
        bn.Scenario.from_mapping({**ROOM, "probes": [probe]})
