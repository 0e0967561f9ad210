"""Rows of studies as statistical packages take them, and summed up by variation."""

import csv
import json
from pathlib import Path

import pandas as pd
import pytest
from tests.studies.small import SMALL, small_in, study_in

import beliefnest as bn
from beliefnest import frames
from beliefnest.cli.app import run_command_line
from beliefnest.studies.file import naming_other_kinds
from beliefnest.studies.study_folder import StudyFolder

# Two questions, one of them about what Bob believes of Ann.
SEVERAL = (
    SMALL.replace("agents:\n", "agents:\n  bob: {position: [3.5, 1, 4.5]}\n")
    + """\
  - label: other
    path: /bob/ann
    acts_in: /bob
    agent: ann
    task: Get a ${item} from a chest.
    expect: {opens: "${spot}"}
"""
)
PLAIN = {"object", "bool", "int64", "float64"}


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> bn.StudyResult:
    folder = tmp_path_factory.mktemp("several")
    study = bn.Study(
        small_in(folder, SEVERAL),
        variations={"spot": [[1, 1, 1], [5, 1, 1], [1, 1, 5]], "count": [1, 2]},
        repeats=2,
        world="scripted",
    )
    return study.run(folder / "out", jobs=1)


def test_rows_name_their_variation_and_the_order_of_the_question(result: bn.StudyResult) -> None:
    frame = result.frame()
    assert len(frame) == 6 * 2 * 2
    assert frame["variation"].nunique() == 6
    assert (frame.groupby("variation")[["spot", "count"]].nunique() == 1).all(axis=None)
    assert frame.groupby("probe")["order"].unique().map(list).to_dict() == {
        "fetch": [1],
        "other": [2],
    }


def test_orders_are_summed_up_apart_and_variations_counted(result: bn.StudyResult) -> None:
    summary = result.summary()
    assert list(summary["order"]) == [1, 2]
    assert list(summary["variations"]) == [6, 6]
    whole = result.summary(by=["model"]).iloc[0]
    assert (whole["judged"] + whole["copies"], whole["variations"]) == (24, 6)
    each = result.summary(by=["variation"])
    assert list(each["variations"]) == [1] * 6
    assert list(result.differences("spot").columns[:5]) == [
        *("order", "one", "other", "pairs", "variations"),
    ]
    assert list(result.differences("spot", by=[]).columns[:2]) == ["one", "other"]
    page = result.write_page(result.folder.path / "page.html").read_text("utf-8")
    assert "6 independent variations" in page


def test_templates_are_compared_within_each_order_and_variation(tmp_path: Path) -> None:
    study = bn.Study(
        small_in(tmp_path, SEVERAL),
        variations={"count": [1, 2]},
        templates=["default", "paper"],
        world="scripted",
    )
    result = study.run(tmp_path / "out", jobs=1)
    differences = result.differences("template")
    assert differences[["order", "pairs", "variations"]].to_numpy().tolist() == [
        *([1, 2, 2], [2, 2, 2]),
    ]
    (pooled,) = result.differences("template", by=[]).to_dict("records")
    assert (pooled["pairs"], pooled["variations"]) == (4, 2)
    page = result.write_page(tmp_path / "page.html").read_text("utf-8")
    assert "<th>variations</th><th>pairs</th>" in page and "<td>order 2</td>" in page


@pytest.mark.extra("statsmodels")
@pytest.mark.filterwarnings("ignore::FutureWarning")
def test_models_of_statsmodels_are_fitted_to_the_frame(result: bn.StudyResult) -> None:
    from statsmodels import api
    from statsmodels.formula import api as models

    frame = result.frame()
    # Not every value of a column decides about the result.
    frame["right"] = frame["ok"].astype(float).where(frame.index % 5 > 0, 1 - frame["ok"])
    logit = models.logit("right ~ C(probe) + C(order == 1)", frame[frame["order"] == 1].assign())
    assert logit.endog.shape == (12,)
    gee = models.gee(
        "right ~ C(probe)", "variation", data=frame, family=api.families.Binomial()
    ).fit()
    assert gee.model.num_group == 6
    assert gee.params.notna().all()
    fitted = models.logit("right ~ order", frame).fit(disp=False)
    assert fitted.nobs == 24 and fitted.params.notna().all()


def test_all_data_frames_have_plain_types(result: bn.StudyResult) -> None:
    found = {
        "frame": result.frame(),
        "summary": result.summary(),
        "differences": result.differences("spot"),
        "seconds": result.seconds(),
        "cells": frames.cells_df(result),
        "probes": frames.probes_df(result),
    }
    for name, frame in found.items():
        assert {str(kind) for kind in frame.dtypes} <= PLAIN, name
    frame = found["frame"]
    assert {frame[name].dtype.kind for name in ("ok", "beliefs_ok")} == {"b", "f"}
    assert frame["beliefs_ok"].isna().all() and frame["condition"].isna().all()
    assert frame["copy_of"].iloc[0] is None


@pytest.mark.extra("pyarrow")
def test_files_keep_types_and_are_read_as_plain_ones(result: bn.StudyResult) -> None:
    table, parquet = result.write_tables()
    with table.open(encoding="utf-8", newline="") as opened:
        first = next(csv.DictReader(opened))
    assert (first["condition"], first["ticks"].isdecimal(), first["ok"]) == ("", True, "True")
    read = pd.read_parquet(parquet)
    assert list(read.columns) == list(result.frame().columns)
    assert not any("pyarrow" in str(kind).lower() for kind in read.dtypes if kind != "str")


def test_columns_to_sum_up_by_are_asked_for_on_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = study_in(tmp_path, "scenarios: [small.yaml]\nworld: scripted\nvariations: 3\n")
    command = ["study", str(file), "--out", str(tmp_path / "out"), "--jobs", "1"]
    assert run_command_line([*command, "--by", "itme", "--json"]) == 2
    assert "there is no column 'itme'; did you mean 'item'?" in capsys.readouterr().err
    assert not list(tmp_path.glob("out/cells/*"))
    assert run_command_line([*command, "--by", "variation", "--by", "order", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)["summary"]
    assert [(each["order"], each["variations"]) for each in summary] == [(1, 1)] * 3
    assert "<th>variation</th><th>order</th>" in Path(tmp_path, "out/study.html").read_text()


def test_a_list_that_is_none_is_told_by_its_own_key(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "scenarios: [small.yaml]\nseed: 1\nvariations:\n  spot: [[1, 1, 1]]\n  agents: 5\n"
    assert run_command_line(["study", str(study_in(tmp_path, text))]) == 2
    told = "study.yaml:5: variations.agents: variations of 'agents' are 5; give a list"
    assert told in capsys.readouterr().err


def test_folders_of_earlier_versions_are_refused(result: bn.StudyResult, tmp_path: Path) -> None:
    old = StudyFolder.open(tmp_path / "old", result.kind)
    old.write_plan(result.plan)
    file = old.path / "study.json"
    content = json.loads(file.read_text(encoding="utf-8"))
    file.write_text(json.dumps({**content, "form": "beliefnest study 2"}), encoding="utf-8")
    with pytest.raises(bn.InputError, match=r"another version of beliefnest.* in a new folder"):
        bn.StudyResult.read(old.path)
    assert run_command_line(["stats", str(old.path)]) == 2
    file.write_text(json.dumps({**content, "kind": "plays"}), encoding="utf-8")
    with pytest.raises(bn.InputError, match=r"study.json is damaged: .* cells of 'plays'; delete"):
        bn.StudyResult.read(old.path)
    file.write_text(json.dumps({**content, "kind": "episodes"}), encoding="utf-8")
    with pytest.raises(bn.InputError, match=r"is damaged: .*delete it and run the study again"):
        bn.StudyResult.read(old.path)


NARRATED = """
  - label: narrated
    path: /
    expect:
      answers:
        question: Where does Ann think the ${item} is?
        options: [box, floor]
        right: {path: /ann, item: "${item}"}
"""


def test_a_narrated_question_has_the_order_of_the_belief_that_answers_it(tmp_path: Path) -> None:
    study = study_in(tmp_path, "{scenarios: [small.yaml], models: [chance], variations: 6}")
    small_in(tmp_path, SMALL + NARRATED.lstrip("\n"))
    played = bn.Study.load(study).run(tmp_path / "out", jobs=1)
    rows = played.frame()
    assert set(rows[rows["probe"] == "narrated"]["path"]) == {"/"}
    assert set(rows["order"]) == {1}
    # Before it is played, too: both probes are in one group.
    (label, _), *others = bn.Study.load(study).power_sources()
    assert label == "2 rows in each variation"
    assert not others


def test_a_wrong_key_of_a_study_names_the_nearest_one(tmp_path: Path) -> None:
    study = study_in(tmp_path, "{scenarios: [small.yaml], variation: 6}")
    with pytest.raises(
        bn.ScenarioError, match=r"variation: unknown key; did you mean 'variations'\?"
    ):
        bn.Study.load(study)


def test_a_scenario_in_place_of_a_study_is_told(tmp_path: Path) -> None:
    with pytest.raises(bn.ScenarioError, match=r"is a scenario, no study; .*`scenarios: \[small"):
        bn.Study.load(small_in(tmp_path))


@pytest.mark.parametrize(
    ("name", "command"), [("sally-anne", "run"), ("joint-lift", "play"), ("t.yaml", "play")]
)
def test_what_is_no_study_names_the_command_that_takes_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, command: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("t.yaml").write_text("scenario: {}\ngoal: {}\n", encoding="utf-8")
    with pytest.raises(
        bn.ScenarioError, match=f"{name} is a .*, no study; .*beliefnest {command}`"
    ):
        bn.Study.load(name)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("conditions: [1]\nscenarios: [sally-anne]", "is a study; .*beliefnest study`"),
        ("tasks: [joint-lift]", "is a study; .*beliefnest study`"),
        ("goal: {}\nscenario: {}", "is a task; .*beliefnest play`"),
        ("name: none", "is missing"),
    ],
)
def test_what_is_no_scenario_names_the_command_that_takes_it(
    tmp_path: Path, text: str, message: str
) -> None:
    file = tmp_path / "other.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(bn.ScenarioError, match=message), naming_other_kinds(str(file)):
        bn.Scenario.load_all(str(file))


def test_a_task_in_place_of_a_scenario_names_the_command_that_takes_it() -> None:
    message = r"joint-lift is a task; .*beliefnest play`"
    with pytest.raises(bn.ScenarioError, match=message), naming_other_kinds("joint-lift"):
        bn.Scenario.load("joint-lift")
