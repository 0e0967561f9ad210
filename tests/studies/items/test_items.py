"""Items of a study: texts, right answers, what shortcuts answer; sets, their parts and balance."""

import json
from dataclasses import replace

import msgspec
import pytest
from tests.studies.items.building import invented

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.errors import InputError, ScenarioError
from beliefnest.scenarios.content import ScenarioWarning
from beliefnest.studies.items.item_set import ItemSet
from beliefnest.studies.items.making import balanced_names
from beliefnest.studies.items.record import ItemRecord
from beliefnest.studies.items.report import report_of, shortcut_rows

SCENARIO = """
name: boxes
box: [[-6, -1, -6], [6, 2, 6]]
blocks:
  - {block: smooth_stone, fill: [[-6, -1, -6], [6, -1, 6]]}
  - {block: stone_bricks, fill: [[2, 0, 1], [6, 2, 1]]}
parameters:
  to: {default: right, values: [left, right]}
containers:
  - {label: left box, at: [-2, 0, -4], block: "chest[facing=south]", items: {bone: 1}}
  - {label: right box, at: [2, 0, -4], block: "chest[facing=south]"}
agents:
  sally: {position: [-1.5, 0, -2.5], facing: north}
  anne: {position: [0.5, 0, -0.5], facing: north}
perception: {max_visible_distance: 20}
script:
  - {agent: sally, program: "await getItemFromChest(bot, new Vec3(-2, 0, -4), {bone: 1})"}
  - agent: sally
    program: >
      await depositItemIntoChest(bot, "${to}" === "left" ? new Vec3(-2, 0, -4)
      : new Vec3(2, 0, -4), {bone: 1})
  - label: away
    agent: sally
    program: await goToPosition(bot, new Vec3(5, 0, 4), 0);
  - agent: anne
    program: |
      const places = [new Vec3(-2, 0, -4), new Vec3(2, 0, -4)]
      const [from, into] = "${to}" === "left" ? places : places.reverse()
      await getItemFromChest(bot, from, {bone: 1})
      await depositItemIntoChest(bot, into, {bone: 1})
probes:
  - label: sally
    path: /
    template: story
    expect:
      answers:
        question: Where will Sally look for the bone?
        options: [left box, right box]
        right: {path: /sally, item: bone}
  - label: both
    path: /
    template: story
    expect:
      answers:
        - question: Where is the bone?
          options: [left box, right box]
          right: {path: /, item: bone}
        - question: Where does Anne think that Sally will look for the bone?
          options: [left box, right box]
          right: {path: /anne/sally, item: bone}
        - question: What is in the right box, as Sally believes?
          right: {path: /sally, container: [2, 0, -4]}
conditions:
  1: {description: Sally does not see it.}
  2:
    description: Sally sees it.
    script:
      away: {program: "await goToPosition(bot, new Vec3(5, 0, -5), 0);"}
"""
STUDY = "scenarios: [boxes.yaml]\nvariations: {to: [left, right]}\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("items")
    (place / "boxes.yaml").write_text(SCENARIO, encoding="utf-8")
    (place / "study.yaml").write_text(STUDY, encoding="utf-8")
    return place


@pytest.fixture(scope="module")
def made(folder):
    return bn.Study.load(folder / "study.yaml").items(name="boxes")


def item(made: ItemSet, condition: int, to: str, question: str) -> ItemRecord:
    (found,) = (
        each
        for each in made.items
        if each.condition == condition
        and each.factors["to"] == to
        and each.question.startswith(question)
    )
    return found


@pytest.mark.long
def test_scenes_are_played_again_in_the_embedded_world(folder, made):
    study = bn.Study.load(folder / "study.yaml")
    of_scene = len(made.items) // 4
    assert study.check_items(made, 1) == (1, of_scene, [])
    other = {"left box": "right box", "right box": "left box"}
    wrong = tuple(
        msgspec.structs.replace(each, right=other.get(each.right, "air")) for each in made.items
    )
    _, compared, lines = study.check_items(replace(made, items=wrong), 1)
    assert compared == len(lines) == of_scene
    assert all("in the embedded world: '" in line for line in lines)


def test_items_have_what_their_readers_need(made):
    found = item(made, 1, "right", "Where will Sally")
    assert (found.right, found.order, found.path, found.chain) == (
        "right box",
        1,
        "/sally",
        ("sally",),
    )
    assert sorted(found.options) == ["left box", "right box"]
    assert (found.kind, found.chance, found.family, found.told_by) == ("item", 0.5, "boxes", "/")
    assert found.text.startswith("This is a story about Anne and Sally.")
    assert found.checked == "follows"
    assert len(made.items) == 16
    assert made.dropped == ()
    assert len({each.id for each in made.items}) == 16


@pytest.mark.parametrize(
    ("condition", "question", "right", "shortcuts"),
    [
        (1, "Where will Sally", "right box", {"reality": "left box", "lower_order": "left box"}),
        (2, "Where will Sally", "left box", {"reality": "left box", "lower_order": "left box"}),
        (1, "Where does Anne", "right box", {"reality": "left box", "lower_order": "right box"}),
        (1, "Where is", "left box", {"reality": "left box"}),
    ],
)
def test_shortcuts_answer_from_lower_beliefs_and_mentions(
    made, condition, question, right, shortcuts
):
    """Sally puts the bone into the right box, and Anne moves it into the left one."""
    found = item(made, condition, "right", question)
    assert found.right == right
    told = {
        name: found.shortcuts[name]
        for name in ("reality", "lower_order")
        if name in found.shortcuts
    }
    assert told == shortcuts
    mentioned = [found.text.rfind(option) for option in ("left box", "right box")]
    last = ("left box", "right box")[mentioned.index(max(mentioned))]
    assert (found.shortcuts["first"], found.shortcuts["last"]) == ("left box", last)


def test_shortcuts_answer_from_events(made):
    """Sally has the bone out of the left box and into the right one, leaves, and misses a move."""
    found = item(made, 1, "right", "Where does Anne").shortcuts
    events = ("first_event", "last_event", "most_event", "first_leaving", "own_event", "outermost")
    assert [found[each] for each in events] == [
        *("left box", "left box", None),
        *("right box", "right box", "left box"),
    ]
    assert "outermost" not in item(made, 1, "right", "Where will").shortcuts


SAY = """
  - agent: anne
    program: await say(bot, 'WORDS', [located('bone', new Vec3(2, 0, -4))])
probes:"""


def items_where_somebody_says(folder, words, change=lambda text: text):
    text = change(SCENARIO.replace("\nprobes:", SAY.replace("WORDS", words), 1))
    (folder / "boxes.yaml").write_text(text, encoding="utf-8")
    return bn.Study([str(folder / "boxes.yaml")], variations={"to": ["right"]}).items()


def weighing(text):
    return text.replace("perception: {", "perception: {testimony: informed, ")


def test_words_are_events_if_they_are_about_what_is_asked_for(tmp_path):
    for words, last in (("The bone is in the right box.", "right"), ("The right box!", "left")):
        made = items_where_somebody_says(tmp_path, words, weighing)
        found = item(made, 1, "right", "Where will").shortcuts
        assert found["last_event"] == f"{last} box"


def without_claims(text):
    return text.replace(", [located('bone', new Vec3(2, 0, -4))]", "")


@pytest.mark.parametrize("change", [without_claims, lambda text: text])
def test_words_that_change_no_belief_leave_the_answer_open(tmp_path, change):
    """Only what is so, and who heard nothing, is beyond such words."""
    made = items_where_somebody_says(tmp_path, "The bone is in the right box.", change)
    dropped = [each for each in made.dropped if each.condition == 1]
    assert [each.question[:8] for each in dropped] == ["Where wi", "Where do", "What is "]
    assert "Sally heard Anne say 'The bone is in the right box.'" in dropped[0].why
    assert "give the utterance a claim" in dropped[0].why
    assert not any(each.is_unanswerable for each in dropped)
    assert item(made, 1, "right", "Where is").checked == "follows"


@pytest.mark.parametrize("words", ["The bone is mine.", "The right box is red.", "Hello."])
def test_words_that_name_no_place_of_the_thing_leave_the_answer_as_it_is(tmp_path, words):
    assert items_where_somebody_says(tmp_path, words, without_claims).dropped == ()


def test_answers_in_words_have_no_options_and_no_chance(made):
    found = item(made, 2, "left", "What is in")
    assert (found.options, found.chance, found.right) == ((), None, "bone")
    assert found.shortcuts["reality"] == "bone"


def test_models_and_worlds_change_no_item(made, folder):
    more = bn.Study(
        [str(folder / "boxes.yaml")],
        models=["offline", "oracle"],
        variations={"to": ["left", "right"]},
        world="scripted",
        repeats=1,
    ).items()
    assert [each.text for each in more.items] == [each.text for each in made.items]


def test_questions_with_several_right_options_are_dropped(tmp_path):
    """Two more bones stay in the left box."""
    more = SCENARIO.replace("items: {bone: 1}", "items: {bone: 3}", 1)
    text = more.replace("[left box, right box]", "[left box, right box, barrel]")
    (tmp_path / "boxes.yaml").write_text(text, encoding="utf-8")
    study = bn.Study([str(tmp_path / "boxes.yaml")], variations={"to": ["left"]}, conditions=[1])
    with pytest.warns(ScenarioWarning):
        made = study.items()
    (why,) = (each.why for each in made.dropped if each.question == "Where is the bone?")
    assert why == "several options are right: 'left box' and 'right box'"
    assert not any(each.question == "Where is the bone?" for each in made.items)


def test_a_set_is_made_again_byte_by_byte(folder, tmp_path, capsys):
    command = ["items", str(folder / "study.yaml"), "-o", str(tmp_path / "set")]
    assert run_command_line([*command, "--held-out", "0.5"]) == 0
    lines = (tmp_path / "set" / "items.jsonl").read_text(encoding="utf-8").splitlines()
    hidden = tmp_path / "set" / "held-out" / "items.jsonl"
    kept = hidden.read_text(encoding="utf-8").splitlines()
    seeds = [{json.loads(line)["seed"] for line in part} for part in (lines, kept)]
    assert seeds[0].isdisjoint(seeds[1])
    assert len(lines) + len(kept) == 16
    assert run_command_line([*command, "--verify"]) == 0
    assert "made again with the same bytes" in capsys.readouterr().out
    changed = [*kept[:2], kept[2].replace("box", "bag"), *kept[3:]]
    hidden.write_text("".join(f"{line}\n" for line in changed), "utf-8")
    (tmp_path / "set" / "items.jsonl").write_text("".join(f"{each}\n" for each in lines[1:]))
    (tmp_path / "set" / "notes.txt").write_text("mine", encoding="utf-8")
    assert run_command_line([*command, "--verify"]) == 1
    told = capsys.readouterr().out
    assert "held-out/items.jsonl: line 3 differs" in told
    assert f"items.jsonl: lines 1, 2, 3, 4, 5 and {len(lines) - 5} more differ" in told
    assert "notes.txt: is not of the set" in told


def test_what_was_held_out_stays_so(folder, tmp_path, capsys, made):
    command = ["items", str(folder / "study.yaml"), "-o", str(tmp_path / "set")]
    assert run_command_line([*command, "--held-out", "0.5"]) == 0
    public = (tmp_path / "set" / "items.jsonl").read_bytes()
    for share in ([], ["--held-out", "0.4"]):
        assert run_command_line([*command, *share]) == 2
        assert "holds a set with held_out 0.5" in capsys.readouterr().err
    assert (tmp_path / "set" / "items.jsonl").read_bytes() == public
    kept = {each.seed for each in replace(made, held_out=0.5).parts["held-out"]}
    fewer = [each for each in made.items if each.factors["to"] == "left"]
    more = replace(made, items=(*made.items, *(copied(each, each.seed + 1) for each in fewer)))
    assert kept <= {each.seed for each in replace(more, held_out=0.5).parts["held-out"]}


def copied(item: ItemRecord, seed: int) -> ItemRecord:
    return msgspec.structs.replace(item, seed=seed)


def test_a_version_names_one_content(folder, made, tmp_path):
    made.write(tmp_path / "set")
    made.write(tmp_path / "set")
    other = replace(made, items=made.items[1:])
    with pytest.raises(InputError, match=r"holds version 1\.0\.0 with other items \(items\.jsonl"):
        other.write(tmp_path / "set")
    assert made.differences(tmp_path / "set") == []
    replace(other, version="1.1.0").write(tmp_path / "set")
    for version in ("1.0.0", "1.0.9", "v1"):
        with pytest.raises(InputError, match=rf"holds version 1\.1\.0, and {version} is below"):
            replace(made, version=version).write(tmp_path / "set")
    replace(made, version="1.10").write(tmp_path / "set")


def test_items_that_differ_in_names_stay_together(made):
    """Were they not, each of the seeds would be in either part."""
    copies = [copied(each, seed) for each in made.items for seed in range(20)]
    alike = [msgspec.structs.replace(each, skeleton="s") for each in copies if each.seed < 5]
    apart = [msgspec.structs.replace(each, skeleton=str(each.seed)) for each in copies]
    parts = replace(made, items=tuple(apart), held_out=0.5).parts
    assert {each.seed < 5 for each in parts["held-out"]} == {True, False}
    assert {each.seed < 5 for each in parts["public"]} == {True, False}
    mixed = (*alike, *(each for each in apart if each.seed >= 5))
    parts = replace(made, items=mixed, held_out=0.5).parts
    skeletons = [{each.skeleton for each in part} for part in parts.values()]
    assert skeletons[0].isdisjoint(skeletons[1])


def test_a_public_copy_is_verified_as_far_as_it_goes(folder, tmp_path, capsys):
    command = ["items", str(folder / "study.yaml"), "-o", str(tmp_path / "set")]
    assert run_command_line([*command, "--held-out", "0.5"]) == 0
    (tmp_path / "set" / "held-out" / "items.jsonl").unlink()
    assert run_command_line([*command, "--verify"]) == 1
    assert "held-out/items.jsonl: is missing" in capsys.readouterr().out
    (tmp_path / "set" / "held-out").rmdir()
    assert run_command_line([*command, "--verify"]) == 0
    assert "the held-out part is not there, and the rest made again" in capsys.readouterr().out
    about = tmp_path / "set" / "set.json"
    about.write_text(about.read_text().replace('"beliefnest": "', '"beliefnest": "9'), "utf-8")
    assert run_command_line([*command, "--verify"]) == 1
    assert "made with beliefnest 9" in capsys.readouterr().out


def test_options_that_give_no_right_answer_end_with_an_error(tmp_path, capsys):
    text = SCENARIO.replace("options: [left box, right box]", "options: [left box, rihgt box]", 1)
    (tmp_path / "boxes.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "study.yaml").write_text("scenarios: [boxes.yaml]\n", encoding="utf-8")
    assert run_command_line(["items", str(tmp_path / "study.yaml"), "-o", str(tmp_path / "s")]) == 1
    out = " ".join(capsys.readouterr().out.split())
    assert "none of the options left box, rihgt box; add it, or mend 'rihgt box'" in out
    assert "1 question of 8 dropped for their options" in out


def test_two_containers_with_one_label_are_named_once_for_each_reason(tmp_path, capsys):
    text = SCENARIO.replace("label: right box", "label: left box")
    (tmp_path / "boxes.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "study.yaml").write_text("scenarios: [boxes.yaml]\n", encoding="utf-8")
    assert run_command_line(["items", str(tmp_path / "study.yaml"), "-o", str(tmp_path / "s")]) == 1
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("dropped: ")]
    hint = "several things are labelled 'left box': give each a label of its own"
    assert all(line.endswith(hint) for line in lines)
    assert lines[0].startswith("dropped: 6 questions of boxes, probe both: ")
    assert len(lines) == len(set(lines)) < 8


def test_a_comparison_says_how_many_scenes_were_played(folder, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(bn.Study, "check_items", lambda self, made, scenes, say: (4, 16, []))
    command = ["items", str(folder / "study.yaml"), "-o", str(tmp_path / "set")]
    assert run_command_line([*command, "--check-embedded", "9"]) == 0
    assert "16 items of all 4 scenes of the set (9 asked for)" in capsys.readouterr().out
    assert run_command_line([*command, "--check-embedded", "4"]) == 0
    assert "16 items of 4 scenes\n" in capsys.readouterr().out


def test_the_offline_model_is_refused_as_it_reads_no_prose(folder, tmp_path, capsys, made):
    made.write(tmp_path / "set")
    asked = ["items", str(tmp_path / "set"), "--models", "offline", "-o", str(tmp_path / "o")]
    assert run_command_line(asked) == 2
    assert "the model offline reads the sections of prompts and no prose" in capsys.readouterr().err
    assert not (tmp_path / "o").exists()
    assert run_command_line(["stats", str(tmp_path / "set")]) == 2
    assert "is a set of items, which has no answers; ask models" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--verify"], "there is no set of items"),
        (
            ["--verify", "--held-out", "0.5"],
            "--held-out belongs to `beliefnest items STUDY -o SET`",
        ),
        (["--held-out", "0.000001"], "holds back none of 2 seeds"),
        (["--held-out", "0.999999"], "holds back all of 2 seeds"),
        (["--set-version", ""], "the version of the set is ''"),
        (["--held-out", "1"], "give a share of at least 0, below 1"),
    ],
)
def test_wrong_use_of_the_command(folder, tmp_path, capsys, arguments, told):
    study = str(folder / "study.yaml")
    assert run_command_line(["items", study, "-o", str(tmp_path / "none"), *arguments]) == 2
    assert told in capsys.readouterr().err


@pytest.mark.parametrize("options", [[], ["--models", "chance"], ["--verify"]])
def test_a_missing_file_is_told_first(options, capsys):
    assert run_command_line(["items", "nosuch.yaml", *options]) == 2
    assert "there is no file or folder nosuch.yaml" in capsys.readouterr().err


def test_a_folder_with_something_else_is_kept(folder, tmp_path, capsys):
    (tmp_path / "thesis.txt").write_text("mine", encoding="utf-8")
    assert run_command_line(["items", str(folder / "study.yaml"), "-o", str(tmp_path)]) == 2
    assert "holds no set of items" in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == ["thesis.txt"]


def records(*answers: tuple[str, str | None]) -> list[ItemRecord]:
    """Items with the options `a` and `b`; of each the right answer, and that of `reality`."""
    return [
        invented(
            id=str(number),
            text=f"text {number} {right}",
            question="Where?",
            options=("a", "b"),
            right=right,
            family=f"family {number % 2}",
            seed=number,
            skeleton=str(number),
            shortcuts={"reality": reality},
        )
        for number, (right, reality) in enumerate(answers)
    ]


def test_a_shortcut_is_scored_against_chance():
    rows = {row["shortcut"]: row for row in shortcut_rows(records(*[("a", "a")] * 20))}
    assert (rows["reality"]["accuracy"], rows["reality"]["at_chance"]) == (1.0, False)
    assert rows["first_option"]["accuracy"] == 1.0
    assert rows["last_option"]["accuracy"] == 0.0
    # Options of one length say nothing: a guess.
    assert (rows["longest_option"]["answered"], rows["longest_option"]["accuracy"]) == (0, 0.5)
    # Texts name the right option.
    assert rows["words"]["accuracy"] == 1.0
    mixed = [("a", "a"), ("a", "b"), ("b", "b"), ("b", "a")] * 5
    rows = {row["shortcut"]: row for row in shortcut_rows(records(*mixed))}
    assert (rows["reality"]["accuracy"], rows["reality"]["at_chance"]) == (0.5, True)


def test_a_report_counts_places_and_copies():
    found = report_of([*records(("a", "a"), ("b", "a")), *records(("a", "b"))])
    assert found["positions"] == {2: [2, 1]}
    assert found["options"]["a"] == {"asked": 3, "right": 2}
    assert found["same_text"] == [["0", "0"]]
    assert found["by"]["family"] == {"family 0": 2, "family 1": 1}


@pytest.mark.extra("scipy")
def test_scenes_are_chosen_on_which_shortcuts_are_at_chance(folder):
    pytest.importorskip("scipy")
    scenario = str(folder / "boxes.yaml")
    values = {"to": ["left", "right"]}
    balanced = bn.Study([scenario], variations=values, balance=["lower_order"], conditions=[1, 2])
    with pytest.raises(InputError, match=r"lower_order: \d+ of \d+ at order 2 in boxes; draw"):
        balanced.plan()
    reality = bn.Study([scenario], variations=values, balance=["reality"])
    rows = {
        row["shortcut"]: row
        for row in shortcut_rows([i for i in reality.items().items if i.options])
    }
    assert rows["reality"]["accuracy"] == 0.5


def test_unknown_shortcuts_are_refused(folder):
    text = STUDY + "balance: [realty]\n"
    (folder / "wrong.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(
        ScenarioError, match=r"wrong.yaml:3: balance.*'realty'.*did you mean 'reality'"
    ):
        bn.Study.load(folder / "wrong.yaml")


@pytest.mark.extra("scipy")
def test_the_family_in_which_a_shortcut_is_right_too_often_is_named():
    pytest.importorskip("scipy")
    families = ("other", "other", "tip-off", "tip-off", "tip-off")
    made = {
        str(number): [invented(family=family, shortcuts={"last": "box"}, order=2)]
        for number, family in enumerate(families)
    }
    with pytest.raises(InputError, match=r"off: last: 3 of 3 at order 2 in tip-off; draw"):
        balanced_names(made, ["last"], 0)


def test_shortcuts_that_learn_cannot_be_balanced(folder):
    with pytest.raises(InputError, match="words learns from the items themselves"):
        bn.Study([str(folder / "boxes.yaml")], balance=["words"])


def test_the_folder_of_a_study_changes_no_item(folder, monkeypatch):
    there = bn.Study([str(folder / "boxes.yaml")], variations=2).items()
    monkeypatch.chdir(folder)
    assert bn.Study(["boxes.yaml"], variations=2).items().items == there.items
