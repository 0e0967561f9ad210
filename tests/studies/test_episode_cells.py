"""Studies of episodes: tasks, instances, policies, models, orders, and all that studies have."""

import itertools
import os
import pickle
from pathlib import Path
from typing import Any

import pytest
from tests.llm.conftest import serving
from tests.studies.small import tables_of

import beliefnest as bn
from beliefnest import frames
from beliefnest.cli.app import run_command_line
from beliefnest.studies.study_folder import StudyFolder

TASK = """\
name: bring
description: Ann takes the apple; Eve does nothing.
box: [[0, 0, 0], [8, 3, 6]]
blocks: [{block: stone, fill: [[0, 0, 0], [8, 0, 6]]}]
static_blocks: [stone]
parameters: {spot: {default: [1, 1, 1]}}
containers: [{at: "${spot}", items: {apple: 1}}, {at: [5, 1, 5]}]
agents: {ann: {position: [3.5, 1, 3.5]}, eve: {position: [4.5, 1, 3.5]}}
initial_beliefs: [{path: "/**", containers: [{at: "${spot}", items: {apple: 1}}]}]
episode:
  goal: {reach: [{agent: ann, items: {apple: 1}}], never: [{agent: eve, items: {apple: 1}}]}
  goals: {eve: {}}
  policies: {eve: random}
  rounds: 2
  round_ticks: 10
"""
STUDY = """\
tasks: [bring.yaml]
policies: [search, "program:idle.js", {ann: "program:take.js", eve: random}]
orders: [0, 1]
seeds: [1, 3]
variations: {spot: [[1, 1, 1], [7, 1, 1], [9, 1, 1]]}
"""
TAKE = "await getItemFromChest(bot, new Vec3(1, 1, 1), {apple: 1})"
CELLS = 4 * 2 * 2


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_into(tmp_path)
    return tmp_path


def write_into(folder: Path) -> None:
    (folder / "bring.yaml").write_text(TASK)
    (folder / "study.yaml").write_text(STUDY)
    (folder / "idle.js").write_text("")
    (folder / "take.js").write_text(TAKE)


def files_of(folder: Path) -> list[bytes]:
    cells = sorted(folder.glob("cells/*.json"))
    assert len(cells) == CELLS
    return [*tables_of(folder).values(), *(cell.read_bytes() for cell in cells)]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Play the study by one process on the command line."""
    folder = tmp_path_factory.mktemp("whole")
    write_into(folder)
    before = Path.cwd()
    os.chdir(folder)
    try:
        command = ["study", "study.yaml", "--out", "out", "--jobs", "1"]
        assert run_command_line(command) == 1, "not every episode is a success"
    finally:
        os.chdir(before)
    return folder / "out"


def test_one_row_for_each_episode(whole: Path) -> None:
    result = bn.StudyResult.read(whole)
    frame = result.frame()
    assert len(frame) == CELLS
    right = frame.groupby(["policy", "spot"])["ok"].mean().to_dict()
    assert right[("search:0", "7,1,1")] == right[("search:1", "1,1,1")] == 1
    assert right[("program:idle.js", "1,1,1")] == 0
    taken = "ann=program:take.js,eve=random"
    assert (right[(taken, "1,1,1")], right[(taken, "7,1,1")]) == (1, 0)
    # The same for all players, and another in each variation.
    assert frame.groupby(["spot", "instance"])["seed"].nunique().tolist() == [1, 1, 1, 1]
    assert frame["seed"].nunique() == 4
    # A task that is read from a file is no other for another seed.
    assert frame.groupby("spot")["variation"].nunique().tolist() == [1, 1]
    assert frame["variation"].nunique() == 2
    lost = frame[frame["policy"] == "program:idle.js"]
    told = {"not reached: ann has 1 apple", "not to be: eve has 1 apple"}
    assert set(lost["why_not"]) == told
    # The third place lies outside the box.
    assert [each["variation"] for each in result.invalid] == [{"spot": [9, 1, 1]}]
    assert frames.episodes_df(whole)["cell"].is_unique
    assert set(frames.cells_df(whole)["player"]) == {"search", "program:idle.js", taken}


@pytest.mark.extra("matplotlib")
def test_summaries_have_intervals_and_differences_are_of_pairs(whole: Path) -> None:
    result = bn.StudyResult.read(whole)
    summary = result.summary().set_index("policy")
    assert (summary.loc["search:0", "right"], summary.loc["search:0", "judged"]) == (4, 4)
    assert (summary.loc["search:0", "variations"], summary.loc["search:0", "interval"]) == (
        *(2, "wilson"),
    )
    assert summary.loc["search:0", "low"] == pytest.approx(0.3424, abs=1e-4)  # Wilson, 2 of 2
    ticks = summary.loc["search:0", ["ticks_low", "ticks", "ticks_high"]]
    assert ticks.iloc[0] <= ticks.iloc[1] <= ticks.iloc[2]
    differences = result.differences("policy").set_index(["one", "other"])
    pair = differences.loc[("search:0", "program:idle.js")]
    assert (pair["pairs"], pair["only_one"], pair["only_other"]) == (4, 4, 0)
    none = result.differences("task")
    names = ["player", "one", "other", *differences.columns]
    assert len(none) == 0 and list(none.columns) == names
    by_order = result.differences("order")
    assert list(by_order[["one", "other", "both"]].itertuples(index=False, name=None)) == [
        ("0", "1", 4)
    ]
    apart = result.differences("policy", by=["task", "spot"])
    assert list(apart.columns[:4]) == ["task", "spot", "one", "other"]
    assert set(apart["pairs"]) == {2} and set(apart["spot"]) == {"1,1,1", "7,1,1"}
    assert result.plot().axes[0].get_xlabel() == "task"
    page = (whole / "study.html").read_text("utf-8")
    assert "bring.yaml" in page and "<svg" in page and "search:1" in page


FAR = """
conditions:
  1: {description: As written.}
  2: {parameters: {spot: {default: [7, 1, 1]}}}
"""


def test_all_conditions_of_a_scenario_are_played_in_all_its_symmetries(here: Path) -> None:
    Path("bring.yaml").write_text(TASK + FAR)
    study = bn.Study(
        tasks=["bring.yaml", "help-find"],
        policies=["search", "program:idle.js", "program:take.js"],
        orders=[0],
        variations={"symmetry": ["as-written", "mirrored"]},
    )
    plan = study.plan()
    searched = [cell for cell in plan.cells if cell.key.player == "search"]
    told = [(cell.key.condition, cell.key.variation["symmetry"]) for cell in searched]
    assert told == list(itertools.product((1, 2), ("as-written", "mirrored")))
    places = [cell.task.form.scenario["containers"][0]["at"] for cell in searched]
    assert places == [[1, 1, 1], [7, 1, 1], [7, 1, 1], [1, 1, 1]]
    why = {each.why for each in plan.invalid}
    assert {each.partition(";")[0] for each in why} == {
        "task help-find has no parameter 'symmetry'",
        "programs of files are not moved or renamed with the scene: program:take.js",
    }


def test_conditions_that_a_task_does_not_have_are_listed(here: Path) -> None:
    Path("bring.yaml").write_text(TASK + FAR)
    plan = bn.Study(tasks=["bring.yaml", "help-find"], policies="random", conditions=[2, 9]).plan()
    assert [(cell.key.task, cell.key.condition) for cell in plan.cells] == [
        ("bring", 2),
        ("help-find", None),
    ]
    (invalid,) = plan.invalid
    assert "there is no condition 9; conditions are 1, 2" in invalid.why


def test_shards_come_to_the_same_bytes(whole: Path, here: Path) -> None:
    command = ["study", "study.yaml", "--jobs", "1"]
    assert run_command_line([*command, "--out", "a", "--shard", "1/2"]) in (0, 1)
    assert run_command_line([*command, "--out", "b", "--shard", "2/2"]) in (0, 1)
    assert run_command_line([*command, "--out", "all", "--merge", "a", "--merge", "b"]) == 1
    assert files_of(here / "all") == files_of(whole)


def test_a_cell_is_the_same_in_another_process(whole: Path, here: Path) -> None:
    for cell in bn.Study.load("study.yaml").plan().cells:
        assert pickle.loads(pickle.dumps(cell)).key.name == cell.key.name
        assert (whole / "cells" / f"{cell.key.name}.json").is_file()


def test_files_of_policies_are_beside_that_of_the_study(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (here / "elsewhere").mkdir()
    monkeypatch.chdir(here / "elsewhere")
    assert len(bn.Study.load("../study.yaml").plan().cells) == CELLS


def test_a_study_goes_on_and_becomes_larger(here: Path) -> None:
    told: list[Any] = []
    for seeds, policies in ((1, ["program:idle.js"]), (2, ["program:idle.js", "program:take.js"])):
        study = bn.Study(tasks="bring.yaml", policies=policies, seeds=seeds)
        study.run("out", jobs=1, on_progress=told.append)
    assert [(each.done, each.total) for each in told] == [(0, 1), (1, 1)] + [
        (done, 4) for done in range(1, 5)
    ]
    Path("take.js").write_text("")
    changed = bn.Study(tasks="bring.yaml", policies=["program:idle.js", "program:take.js"])
    changed.run("out", jobs=1, on_progress=told.append)
    # Another program in the file is another policy.
    assert [each.done for each in told[-2:]] == [1, 2]


def test_help_is_measured_where_it_is_asked_for_and_runs_are_kept(here: Path) -> None:
    study = bn.Study(tasks="help-find", policies="search:1", seeds=[1], help=True)
    result = study.run("out", jobs=1, record=True)
    (row,) = result.rows
    assert (row["help_needed"], row["help_given"], row["help_superfluous"]) == (1, 1, 0)
    with bn.Episode.resume(here / "out" / row["run"]) as episode:
        assert episode.policies == {"anne": "search:1", "sally": "search:0"}
        assert episode.success


def test_a_model_that_cannot_be_asked_is_no_result(here: Path, monkeypatch: Any) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "none")
    study = bn.Study(
        tasks="bring.yaml", models=["offline", "openai:gpt-4o-mini"], orders=[0], max_cost=0
    )
    with serving() as server:
        monkeypatch.setenv("OPENAI_BASE_URL", server.url)
        result = study.run("out", jobs=1)
    assert server.requests == []
    outcomes = {row["player"]: row["outcome"] for row in result.rows}
    assert outcomes == {"model:offline": "wrong", "model:openai:gpt-4o-mini": "error"}
    assert "may cost 0.00" in result.rows[1]["why_not"]
    folder = StudyFolder.existing("out")
    assert sum(folder.cell(name)["error"] is None for name in folder.names()) == 1


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("policies: [search]", "orders is empty"),
        ("policies: [serach]", "no policy 'serach'"),
        ("models: [offline]", "orders is empty"),
        ("orders: [0]", "needs policies"),
        ("policies: [random]\norders: [one]", "orders"),
        ("policies: [random]\nseeds: 0", "study.yaml:3: seeds: seeds is 0"),
        ("policies: [random]\nseeds: [1, 1]", "study.yaml:3: seeds: seeds: 1 is named twice"),
        ("policies: [random]\nmax_tokens: 0", "study.yaml:3: max_tokens: max_tokens is 0"),
        ("policies: [random]\nmax_cost: -1", "study.yaml:3: max_cost: max_cost is -1"),
        ("policies: [{}]", "study.yaml:2: policies: policies has {}"),
        ("policies: [random]\ntemplates: [paper]", "templates cannot stand beside tasks"),
        ("policies: [random]\nvariations: 3", "variations of tasks must be lists"),
        ("policies: [random, random]", "'random' is named twice"),
        ("policies: ['program:none.js']", "none.js cannot be read"),
        ("policies: [{ours: {ann: random}}, {ours: {bob: random}}]", "two of the policies have"),
        (
            "policies: [{ours: {ann: {bob: random}}}]",
            "study.yaml:2: policies[0].ours.ann: expected a text, got {'bob': 'random'}",
        ),
    ],
)
def test_a_wrong_study_is_told_in_one_line(
    here: Path, capsys: pytest.CaptureFixture[str], more: str, told: str
) -> None:
    Path("study.yaml").write_text(f"tasks: [bring.yaml]\n{more}\n")
    assert run_command_line(["study", "study.yaml", "--out", "out", "--jobs", "1"]) == 2
    shown = capsys.readouterr().err.splitlines()
    assert told in shown[-1]
    assert not list(itertools.chain(Path("out").glob("cells/*.json")))


def test_policies_of_a_study_are_names(here: Path) -> None:
    for policies in ([bn], [{"ann": 5}], [None]):
        with pytest.raises(bn.InputError, match="policies has"):
            bn.Study(tasks="bring.yaml", policies=policies)  # type: ignore[arg-type]


def test_policies_by_agent_can_have_a_name_and_lost_rounds_are_told(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("own.py").write_text("class Bad:\n    def act(self, view):\n        return {}['x']\n")
    Path("study.yaml").write_text(
        "tasks: [bring.yaml]\npolicies: [{ours: {ann: 'own.py:Bad'}}, {ann: 'own.py:Bad'}]\n"
    )
    assert run_command_line(["study", "study.yaml", "--out", "out", "--jobs", "1"]) == 1
    rows = bn.StudyResult.read("out").rows
    assert {row["policy"] for row in rows} == {"ours", f"ann={Path('own.py')}:Bad"}
    (ours,) = (row for row in rows if row["policy"] == "ours")
    told = f"ours gave no program in {ours['lost_rounds']} rounds of 1 episode; the first failure"
    shown = " ".join(capsys.readouterr().out.split())
    assert f"{told}: round 1, ann: own.py:3: KeyError: 'x'" in shown
    assert "own.py:Bad" in ours["policies"]


def test_a_name_alone_is_a_list_of_one_in_files_too(here: Path) -> None:
    Path("study.yaml").write_text("tasks: bring.yaml\npolicies: random\n")
    assert len(bn.Study.load("study.yaml").plan().cells) == 1


def test_the_upper_bound_has_the_name_that_the_command_line_takes(here: Path) -> None:
    study = bn.Study(tasks="bring.yaml", policies=["search"], orders=["omniscient"])
    (row,) = study.run("out", jobs=1).rows
    assert row["policy"] == "omniscient:search" == study.plan().cells[0].key.policies["ann"]
