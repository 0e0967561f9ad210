"""Right answers that the nest computes."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.errors import ScenarioError
from beliefnest.llm import Answer
from beliefnest.llm.messages import Message, Sampling
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.probing import Asking, resolved, run_probe
from beliefnest.scenarios.records import probe_json
from beliefnest.scenarios.running import run_scenario

LEFT, RIGHT, SIGN = [2, 1, 2], [6, 1, 2], [4, 1, 1]
SCENE: dict[str, Any] = {
    "name": "scene",
    "box": [[0, 0, 0], [16, 3, 10]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [16, 0, 10]]},
        {"block": "bricks", "fill": [[9, 1, 0], [9, 3, 7]]},
    ],
    "containers": [
        {"at": LEFT, "block": "chest"},
        {"at": RIGHT, "block": "chest"},
        {"at": [4, 1, 2], "block": "barrel", "label": "red box", "items": {"apple": 1}},
    ],
    "signs": [{"at": SIGN, "text": "keep\nshut"}],
    "places": {"garden": [13, 1, 2]},
    "agents": {
        "lia": {"position": [3.5, 1, 4.5], "inventory": {"diamond": 1}},
        "wim": {"position": [5.5, 1, 5.5]},
    },
    "static_blocks": ["stone", "bricks"],
    "script": [
        {
            "agent": "lia",
            "program": "await depositItemIntoChest(bot, new Vec3(2, 1, 2), {diamond: 1});",
        },
        {"agent": "wim", "program": "await goToPosition(bot, new Vec3(13, 1, 2), 0);"},
        {
            "agent": "lia",
            "program": "await getItemFromChest(bot, new Vec3(2, 1, 2), {diamond: 1});"
            "await depositItemIntoChest(bot, new Vec3(6, 1, 2), {diamond: 1});",
        },
    ],
}


class _Says:
    """Model that gives one answer to everything and counts its requests."""

    name = "says"

    def __init__(self, text: str) -> None:
        self.text, self.asked = text, 0

    def answer(self, messages: tuple[Message, ...], sampling: Sampling) -> Answer:
        self.asked += 1
        return Answer(self.text)


def scenario(expect: Mapping[str, Any], **probe: Any) -> bn.Scenario:
    return bn.Scenario.from_mapping(
        {**SCENE, "probes": [{"path": "/lia", "expect": expect, **probe}]}
    )


@pytest.fixture(scope="module")
def nest() -> Iterator[bn.Nest]:
    with bn.Nest.open(bn.Scenario.from_mapping(SCENE), "scripted") as opened:
        opened.play()
        yield opened


def expected(nest: bn.Nest, **asked: Any) -> Answers:
    """Return a question with its computed answer."""
    probe = resolved(nest, scenario({"answers": {"question": "What?", **asked}}).probes[0])
    (found,) = probe.questions
    return found


ASKED: list[tuple[dict[str, Any], list[str], list[str]]] = [
    ({"path": "/", "item": "diamond"}, [], ["eastern chest", "(6, 1, 2)"]),
    ({"path": "/lia/wim", "item": "diamond"}, [], ["western chest", "(2, 1, 2)"]),
    ({"path": "/lia", "item": "apple"}, [], ["unknown"]),
    ({"path": "/", "item": "apple"}, [], ["red box"]),
    ({"path": "/wim", "agent": "wim"}, [], ["garden"]),
    ({"path": "/wim", "container": LEFT}, [], ["diamond", "diamonds"]),
    ({"path": "/lia", "container": LEFT}, [], ["nothing", "empty"]),
    ({"path": "/wim", "container": RIGHT}, [], ["unknown"]),
    ({"path": "/wim", "sign": SIGN}, [], ["keep / shut"]),
    ({"path": "/wim", "block": [0, 0, 0]}, [], ["stone"]),
    (
        {"path": "/lia/wim", "item": "diamond"},
        ["in the eastern chest", "in the western chest"],
        ["in the western chest"],
    ),
    (
        {"path": "/lia", "item": "apple", "unknown": "nobody knows"},
        ["red box", "Nobody knows."],
        ["Nobody knows."],
    ),
]


@pytest.mark.parametrize(("right", "options", "answers"), ASKED)
def test_the_nest_computes_right_answers(nest, right, options, answers):
    entry = expected(nest, right=right, options=options).written()["answers"][0]
    assert (entry["right"], entry["right_from"]) == (answers, right)


def test_computed_answers_are_judged_like_typed_ones(nest):
    where = expected(nest, right={"path": "/lia/wim", "item": "diamond"})
    assert where.judge_text("in the Western chest").ok
    assert not where.judge_text("eastern chest").ok
    unknown = expected(nest, right={"path": "/lia", "item": "apple"})
    assert unknown.judge_text("I do not know").ok
    assert not unknown.judge_text("red box").ok


@pytest.mark.parametrize(("path", "ok", "opens"), [("/lia/wim", True, LEFT), ("/", False, RIGHT)])
def test_programs_are_judged_by_a_believed_place(nest, path, ok, opens):
    said = "```javascript\nawait getItemFromChest(bot, new Vec3(2, 1, 2), {diamond: 1});\n```"
    acting = {"acts_in": "/lia/wim", "agent": "wim", "task": "Get a diamond."}
    given = scenario({"opens": {"path": path, "item": "diamond"}}, **acting)
    found = probe_json(run_probe(nest, 1, given.probes[0], _Says(said), 0, Asking()), "run")
    assert (found["ok"], found["expected"]) == (
        ok,
        {"opens": opens, "opens_from": {"path": path, "item": "diamond"}},
    )


@pytest.mark.parametrize(
    ("right", "message"),
    [
        ({"path": "/wmi", "item": "diamond"}, "right.path: '/wmi' names an unknown agent"),
        ({"path": "/wim", "item": "diamnod"}, "right.item: no item 'diamnod'"),
        ({"path": "/wim", "item": "key"}, "no item 'key' .*; give one of the game, such as"),
        ({"path": "/wim"}, "right: name exactly one of item, agent"),
        ({"path": "/wim", "item": "stick", "agent": "lia"}, "right: name exactly one"),
        ({"path": "/wim", "container": [0, 0, 0]}, "right.container: no container stands"),
    ],
)
def test_an_entry_that_is_wrong_names_its_key(right, message):
    with pytest.raises(ScenarioError, match=message.replace("[", r"\[")):
        scenario({"answers": {"question": "Where?", "right": right}})


@pytest.mark.parametrize(
    ("expect", "message"),
    [
        (
            {"right": {"path": "/wim", "item": "diamond"}, "options": ["a pot", "red box"]},
            "none of the options",
        ),
        (
            {"right": {"path": "/wim", "item": "apple"}, "options": ["pot", "red box"]},
            "'unknown', which is none",
        ),
        (
            {"right": {"path": "/", "item": "diamond"}, "wrong": ["eastern chest"]},
            "which 'wrong' names",
        ),
    ],
)
def test_a_belief_that_gives_no_right_answer_names_its_key(nest, expect, message):
    with pytest.raises(ScenarioError, match=rf"answers\[0\].right: .*{message}"):
        expected(nest, **expect)


def test_no_model_is_asked_if_a_belief_gives_no_right_answer():
    right = {"path": "/wim", "item": "apple"}
    given = scenario({"answers": {"question": "Where?", "options": ["pot", "box"], "right": right}})
    both = replace(given, probes=(replace(given.probes[0], expect=()), *given.probes))
    model = _Says("Answer: pot")
    with bn.Nest.open(both, "scripted") as opened, pytest.raises(ScenarioError):
        run_scenario(opened, both, model, 0, 0.0, lambda *_: None)
    assert model.asked == 0


def test_an_item_in_two_places_has_two_right_answers():
    wim = {"position": [5.5, 1, 5.5], "inventory": {"apple": 1}}
    agents = {"lia": {"position": [3.5, 1, 4.5]}, "wim": wim}
    given = bn.Scenario.from_mapping({**SCENE, "agents": agents, "script": []})
    with bn.Nest.open(given, "scripted") as opened:
        found = expected(opened, right={"path": "/", "item": "apple"})
    assert found.right == ("red box", "wim")
    assert found.judge_text("Wim has one").ok
