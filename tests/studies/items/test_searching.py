"""Search for what makes items hard: scripted weaknesses are found, and no others."""

import json
from dataclasses import dataclass
from types import MappingProxyType

import pytest
from tests.studies.items.building import invented

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.errors import InputError
from beliefnest.studies.items.search_folder import search_items
from beliefnest.studies.items.searching import ItemSearch, judged_pairs
from beliefnest.studies.items.space import Contrast

SCENARIO = """
name: moves
map:
  legend:
    "#": bricks
    r: {container: barrel, label: red box}
    y: {container: barrel, label: yellow box}
    e: {agent: eva, facing: north, inventory: {"bone": 1}}
    "1": {agent: ann, facing: north}
    "2": {agent: bob, facing: north}
  floors: |
    #########
    #.r...y.#
    #...e...#
    #..1.2..#
    #########
static_blocks: [bricks]
labels: true
parameters:
  moves: {default: 1, values: [1, 2]}
  says: {default: Hello., values: [Hello., Well.]}
script:
  - {agent: eva, program: "await depositItemIntoChest(bot, new Vec3(2, 1, 1), {bone: 1});"}
  - agent: eva
    program: |
      if (${moves} === 2) {
        await getItemFromChest(bot, new Vec3(2, 1, 1), {bone: 1});
        await depositItemIntoChest(bot, new Vec3(6, 1, 1), {bone: 1});
      }
  - {agent: eva, program: "await say(bot, '${says}');"}
probes:
  - path: /
    template: story
    expect:
      answers:
        - question: Where is the bone?
          options: &boxes [red box, yellow box]
          right: {path: /, item: bone}
        - question: Where does Ann think that the bone is?
          options: *boxes
          right: {path: /ann, item: bone}
"""
MODEL = """
from beliefnest.llm import Answer
class Weak:
    name = "weak"
    def answer(self, messages, sampling):
        return Answer("Answer: " + ("b" if '"moves": "2"' in messages[-1].text else "a"))
"""
LEVELS = {"moves": ("0", "1", "2"), "honest": ("true", "false"), "box": ("red", "blue", "green")}
CONTRASTS = [
    *(Contrast("order", str(n + 1), (str(n),)) for n in range(4)),
    *(Contrast("order", str(n), (str(n + 1),)) for n in range(4)),
    *(Contrast("moves", one, (other,)) for one, other in ("10", "01", "21", "12")),
    *(
        Contrast(name, level, tuple(each for each in LEVELS[name] if each != level))
        for name in ("honest", "box")
        for level in LEVELS[name]
    ),
]


@dataclass
class InventedSpace:
    """Space whose items are invented: no script is played."""

    families = ("invented",)
    documents = MappingProxyType({})
    draws = 0

    @property
    def design(self):
        return bn.Study("sally-anne").design

    def contrasts(self, orders):
        return CONTRASTS

    def levels(self, family):
        return {name: dict.fromkeys(levels) for name, levels in LEVELS.items()}

    def surface(self, family, seed):
        self.draws += 1
        return {"name": self.draws}

    def questions(self, family, point, surface):
        return [
            invented(
                id=json.dumps([point, surface, n]),
                text=json.dumps([point, surface]),
                question=str(n),
                options=("a", "b"),
                right="a",
                order=n,
                path="/",
                chain=("ann",) * n,
                family=family,
                factors=point,
            )
            for n in range(5)
        ]


def fails(item):
    return item.order >= 3 or item.factors["moves"] == "2" or item.factors["honest"] == "false"


def weaknesses(seed, judge):
    asked = []

    def ask(items):
        asked.extend(items)
        return [judge(each) for each in items]

    search = ItemSearch(InventedSpace(), CONTRASTS, seed)
    search.run(ask, 100)
    searched = {(each.text, each.question) for each in asked}
    pairs = list(search.fresh(100))
    assert searched.isdisjoint((each.hard.text, each.hard.question) for each in pairs)
    tests = judged_pairs(pairs, ask)
    assert len(asked) <= 200
    return {each.contrast.text for each in tests if each.is_weakness}


@pytest.mark.parametrize("seed", [1, 2])
def test_three_weaknesses_are_found_and_no_other(seed):
    assert weaknesses(seed, lambda item: not fails(item)) == {
        "order 3 rather than 2",
        "moves 2 rather than 1",
        "honest false rather than true",
    }


def test_a_model_that_is_always_right_or_wrong_has_no_weakness():
    assert weaknesses(1, lambda item: True) == set()
    assert weaknesses(1, lambda item: False) == set()


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "moves.yaml").write_text(SCENARIO, encoding="utf-8")
    (tmp_path / "study.yaml").write_text("scenarios: [moves.yaml]\nvariations: 9\n", "utf-8")
    (tmp_path / "weak.py").write_text(MODEL, encoding="utf-8")
    return tmp_path


def searched(folder, **options):
    models = {"model": "weak.py:Weak", "transfer": "first-option"}
    return search_items(InventedSpace(), folder, budget=60, **models, **options).plain()


def cells_in(folder):
    return {each.name: each.read_bytes() for each in (folder / "cells").iterdir()}


def test_an_interrupted_search_continues_to_the_same_report(place):
    first = searched(place / "out")
    assert [each["factor"] for each in first["tested"] if each["weakness"]] == ["moves"]
    assert not any(each["weakness"] for each in first["transfer"]["first-option"])
    cells = cells_in(place / "out")
    for name in sorted(cells)[20:]:
        (place / "out" / "cells" / name).unlink()
    assert searched(place / "out") == first
    assert cells_in(place / "out") == cells
    with pytest.raises(InputError, match="holds no search with this seed; name another"):
        searched(place / "out", seed=1)


@pytest.mark.long
def test_questions_asked_in_parallel_give_the_same_search(place):
    """By day, the interrupted search holds that no order of answers changes anything."""
    assert searched(place / "several", jobs=2) == searched(place / "one")
    assert cells_in(place / "several") == cells_in(place / "one")
    plans = [(place / each / "study.json").read_bytes() for each in ("several", "one")]
    assert plans[0] == plans[1]


def test_twins_tell_the_same_story_but_for_one_factor(place):
    space = bn.Study.load("study.yaml").item_space()
    (family,) = space.families
    assert {name: list(own) for name, own in space.levels(family).items()} == {
        "moves": ["1", "2"],
        "says": ["Hello.", "Well."],
    }
    assert Contrast("moves", "2", ("1",)) in space.contrasts({0, 1})
    drawn = space.surface(family, "seed")
    one, two = (
        space.questions(family, {"moves": moves, "says": "Well."}, drawn)[1] for moves in "12"
    )
    assert (one.right, two.right, one.order) == ("red box", "yellow box", 1)
    assert one.text.split(" put ")[0] == two.text.split(" put ")[0]
    assert one.question == two.question
    assert {name for name in one.factors if one.factors[name] != two.factors[name]} == {"moves"}


@pytest.mark.parametrize(
    ("options", "fault"),
    [
        (["--budget", "0"], "budget is 0; give at least 40"),
        (["--model", "nobody"], "no model 'nobody'"),
        (["--model", "offline"], "name another model"),
        (["--transfer", "offline"], "name another model"),
        (["--budget", "40", "-o", "study.yaml"], "study.yaml is no folder; name another folder"),
        (["--budget", "40", "-o", "."], "is not empty and holds no study"),
    ],
)
def test_wrong_input_is_refused(place, capsys, options, fault):
    command = ["search-items", "study.yaml", "-o", "out", "--model", "chance", *options]
    assert run_command_line(command) == 2
    assert fault in capsys.readouterr().err
    assert not (place / "out").exists()


def test_a_study_in_which_nothing_varies_is_refused(place, capsys):
    one = SCENARIO.replace("[1, 2]", "[1]").replace("[Hello., Well.]", "[Hello.]")
    one = one.partition("        - question: Where does Ann")[0]
    (place / "moves.yaml").write_text(one, encoding="utf-8")
    assert run_command_line(["search-items", "study.yaml", "--model", "chance", "-o", "out"]) == 2
    assert "nothing varies in this study" in capsys.readouterr().err
