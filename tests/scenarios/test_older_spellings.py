"""Older spellings of facts in scenario files: read, with one line that says what to write."""

import copy
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.scenarios.sources import builtin_names

ROOM: dict[str, Any] = {
    "name": "room",
    "box": [[0, 0, 0], [8, 2, 8]],
    "blocks": [{"block": "oak_sign", "at": [1, 1, 1]}],
    "containers": [{"at": [4, 1, 4]}],
    "places": {"oak": [6, 1, 6]},
    "agents": {"ann": {"position": [2.5, 1, 2.5]}, "bob": {"position": [6.5, 1, 6.5]}},
}
ASKED = {"path": "/ann", "acts_in": "/ann", "agent": "ann", "task": "Go."}
OLD = {
    **ROOM,
    "expectations": [
        {"label": "bob", "path": "/ann", "agent": "bob", "position": [6.5, 1, 5.0]},
        {"label": "near", "path": "/ann", "agent": "bob", "position": [6.5, 1, 6], "within": 0.6},
        {"path": "/ann", "sign": [1, 1, 1]},
        {"path": "/ann", "block": [0, 0, 0], "state": None},
    ],
    "probes": [
        {**ASKED, "label": "walk", "expect": {"arrives": [2.5, 1, 3.5]}},
        {
            **ASKED,
            "label": "ask",
            "expect": {
                "answers": {"question": "Where?", "right": {"believed": "/", "agent": "bob"}},
                "opens": {"believed": "/ann", "item": "apple"},
                "believes": {"path": "/ann", "agent": "bob", "position": None},
            },
        },
    ],
    "conditions": {
        1: {
            "expectations": {"bob": {"position": [1.5, 1, 1.5]}},
            "probes": {"walk": {"expect": {"arrives": [3.5, 1, 3.5]}}},
        }
    },
}
NEW = {
    **ROOM,
    "expectations": [
        {"label": "bob", "path": "/ann", "agent": "bob", "at": [6.5, 1, 5.0], "within": 2},
        {"label": "near", "path": "/ann", "agent": "bob", "at": [6.5, 1, 6], "within": 0.6},
        {"path": "/ann", "sign": [1, 1, 1], "text": None},
        {"path": "/ann", "block": [0, 0, 0], "state": None},
    ],
    "probes": [
        {**ASKED, "label": "walk", "expect": {"arrives": [2.5, 1, 3.5], "within": 2}},
        {
            **ASKED,
            "label": "ask",
            "expect": {
                "answers": {"question": "Where?", "right": {"path": "/", "agent": "bob"}},
                "opens": {"path": "/ann", "item": "apple"},
                "believes": {"path": "/ann", "agent": "bob", "at": None},
            },
        },
    ],
    "conditions": {
        1: {
            "expectations": {"bob": {"at": [1.5, 1, 1.5]}},
            "probes": {"walk": {"expect": {"arrives": [3.5, 1, 3.5]}}},
        }
    },
}


OLD_INFERENCE = {
    **ROOM,
    "signs": [
        {
            "at": [1, 1, 1],
            "text": "over there",
            "claims": [
                {"kind": "located", "item": "apple", "place": [4, 1, 4]},
                {"kind": "absent", "item": "stick", "place": [4, 1, 4]},
                {"kind": "position", "agent": "bob", "place": [1.5, 1, 1.5]},
                {"kind": "block", "state": "stone", "place": [2, 1, 2]},
            ],
        }
    ],
    "probes": [
        {
            "path": "/ann",
            "infer": {
                "agent": "bob",
                "goals": {"there": {"at": [1, 1, 4]}},
                "utilities": {"there": 1},
                "doubt": {
                    "full": {
                        "blocks": [{"at": [0, 0, 0], "block": "stone"}],
                        "containers": [{"at": [4, 1, 4], "items": {"apple": 1}}],
                        "agents": {"ann": [2.5, 1, 4.5]},
                    },
                    "empty": {
                        "blocks": [{"at": [0, 0, 0], "block": "dirt"}],
                        "containers": [{"at": [4, 1, 4]}],
                        "agents": {"ann": [3.5, 1, 4.5]},
                    },
                },
            },
        }
    ],
}
CLAIMED = [
    {"container": [4, 1, 4], "items": {"apple": 1}},
    {"container": [4, 1, 4], "lacks": "stick"},
    {"agent": "bob", "at": [1.5, 1, 1.5]},
    {"block": [2, 1, 2], "state": "stone"},
]
DOUBT = {
    "full": [
        {"block": [0, 0, 0], "state": "stone"},
        {"container": [4, 1, 4], "items": {"apple": 1}},
        {"agent": "ann", "at": [2.5, 1, 4.5]},
    ],
    "empty": [
        {"block": [0, 0, 0], "state": "dirt"},
        {"container": [4, 1, 4], "items": {}},
        {"agent": "ann", "at": [3.5, 1, 4.5]},
    ],
}


def test_older_claims_and_doubts_are_facts() -> None:
    new = copy.deepcopy(OLD_INFERENCE)
    new["signs"][0]["claims"] = CLAIMED
    new["probes"][0]["infer"]["doubt"] = DOUBT
    one, other = (bn.Scenario.from_mapping(each) for each in (OLD_INFERENCE, new))
    assert one.setting.snapshot.sign_claims == other.setting.snapshot.sign_claims
    models = [scenario.probes[0].infer.model for scenario in (one, other)]
    doubts = [[vars_of(each) for each in model.alternatives] for model in models]
    assert doubts[0] == doubts[1]
    assert not other.warnings
    (told,) = one.warnings
    assert "claims as facts" in str(told)
    in_code = bn.MindModel("bob", {"there": {"at": (1, 1, 4)}}, {"there": 1}, DOUBT)
    assert [vars_of(each) for each in in_code.alternatives] == doubts[0]


def vars_of(alternative: Any) -> tuple[Any, ...]:
    return alternative.name, alternative.blocks, alternative.containers, alternative.agents


@pytest.mark.parametrize("condition", [None, 1])
def test_an_older_file_means_what_it_meant(condition: int | None) -> None:
    old, new = (bn.Scenario.from_mapping(each, condition=condition) for each in (OLD, NEW))
    assert old.expectations == new.expectations
    assert [each.written() for probe in old.probes for each in probe.expect] == [
        each.written() for probe in new.probes for each in probe.expect
    ]
    assert new.warnings == ()


def test_one_line_says_what_to_write() -> None:
    (told,) = bn.Scenario.from_mapping(OLD).warnings
    for advice in ("'at' for 'position'", "'path' for 'believed'", "'within: 2'", "'text: null'"):
        assert advice in str(told)
    assert "\n" not in str(told)


@pytest.mark.parametrize("name", builtin_names())
def test_built_in_scenarios_are_in_the_new_spelling(name: str) -> None:
    assert "older spelling" not in " ".join(map(str, bn.Scenario.load(name).warnings))
