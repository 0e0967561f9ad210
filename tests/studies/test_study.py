"""A study in a folder: the same rows whatever happened on the way, and what went wrong in rows."""

import importlib.util
import json
import os
import random
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from joblib.externals.loky.process_executor import TerminatedWorkerError
from tests.children import children
from tests.profiles import at_night
from tests.studies.small import SMALL, small_in, study_in, tables_of

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.llm.budget import RunLimits
from beliefnest.llm.messages import Usage
from beliefnest.plan.jobs import _engine
from beliefnest.plan.spending import SharedBudget, spent_in
from beliefnest.studies.kinds import SCENARIO_KIND
from beliefnest.studies.study_folder import StudyFolder

pytestmark = pytest.mark.usefixtures("kept_worlds")

STUDY = """\
scenarios: [small.yaml]
variations:
  spot: [[1, 1, 1], [5, 1, 1], [5, 1, 5]]
  count: [1, 2, 3]
"""
CELLS = 6


def cells_of(folder):
    return {file.name: file.read_bytes() for file in Path(folder, "cells").glob("*.json")}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Run a study in one process, by the command line; return its folder and its file."""
    folder = tmp_path_factory.mktemp("whole")
    file = study_in(folder, STUDY)
    assert run_command_line(["study", str(file), "--out", str(folder / "out"), "--jobs", "1"]) == 0
    return folder / "out", file


def test_one_row_for_each_probe_of_each_cell(whole):
    frame = bn.StudyResult.read(whole[0]).frame()
    assert len(frame) == CELLS
    assert set(frame["spot"]) == {"1,1,1", "5,1,1"}
    assert list(frame["opened"]) == list(frame["spot"])
    assert frame["ok"].all()
    assert set(frame["outcome"]) == {"ok"}
    assert frame["seed"].nunique() == CELLS
    assert str(frame["ticks"].dtype) == "int64"


def test_conditions_that_are_not_there_are_listed_and_alone_are_refused(tmp_path):
    told = "there is no condition 9; conditions are 1, 2, 3"
    plan = bn.Study("sally-anne", conditions=[1, 9]).plan()
    assert len(plan.cells) == 1
    assert [(each.condition, told in each.why) for each in plan.invalid] == [(9, True)]
    for variations in (None, 2):
        study = bn.Study("sally-anne", variations=variations, conditions=[9])
        with pytest.raises(bn.InputError, match=told):
            study.run(tmp_path / "out", jobs=1)


def test_several_templates_are_told_apart_everywhere(tmp_path):
    study = bn.Study(small_in(tmp_path), templates=["default", "paper"])
    result = study.run(tmp_path / "out", jobs=1)
    assert list(result.summary()["template"]) == ["default", "paper"]
    assert result.write_page(tmp_path / "page.html").read_text("utf-8").count("<td>paper</td>") >= 2
    one = bn.Study(small_in(tmp_path)).run(tmp_path / "one", jobs=1)
    assert "template" not in one.summary()


def test_invalid_combinations_are_listed(whole):
    invalid = bn.StudyResult.read(whole[0]).invalid
    assert [each["variation"]["count"] for each in invalid] == [1, 2, 3]
    assert all("'spot[0] + spot[2] < 10' does not hold" in each["why"] for each in invalid)


BACKENDS = [pytest.param("loky"), pytest.param("dask", marks=pytest.mark.extra("distributed"))]
if importlib.util.find_spec("ray") is not None:  # at night only
    BACKENDS.append(pytest.param("ray", marks=pytest.mark.extra("ray")))


# One process would play as few cells as these.
IN_PROCESSES = """
import sys
from beliefnest.cli import main
from beliefnest.plan import jobs
jobs._FEW = {}
sys.argv[0] = "beliefnest"
main()
"""
COMMAND = [sys.executable, "-c", IN_PROCESSES]


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_same_bytes_with_two_jobs(whole, backend, tmp_path):
    out, file = tmp_path / "out", whole[1]
    command = [*COMMAND, "study", str(file), "--out", str(out)]
    subprocess.run([*command, "--jobs", "2", "--backend", backend], check=True)
    assert cells_of(out) == cells_of(whole[0])
    assert tables_of(out) == tables_of(whole[0])


def test_shards_merge(whole, tmp_path):
    file = str(whole[1])
    for number in (1, 2):
        out = str(tmp_path / f"shard-{number}")
        shard = ["--shard", f"{number}/2", "--jobs", "1"]
        assert run_command_line(["study", file, "--out", out, *shard]) == 0
    parts = [cells_of(tmp_path / f"shard-{number}") for number in (1, 2)]
    assert not parts[0].keys() & parts[1].keys()
    merged = [f"--merge={tmp_path / 'shard-1'}", f"--merge={tmp_path / 'shard-2'}"]
    assert run_command_line(["study", file, "--out", str(tmp_path / "all"), *merged]) == 0
    assert tables_of(tmp_path / "all") == tables_of(whole[0])


def test_different_results_of_one_cell_do_not_merge(whole, tmp_path):
    own = StudyFolder.existing(whole[0])
    other = StudyFolder.open(tmp_path / "other", own.kind)
    other.write_plan(own.plan())
    name = sorted(own.names())[0]
    content = own.cell(name)
    other.write_cell(name, {**content, "ticks": 7})
    with pytest.raises(bn.InputError, match=f"different results of the cell {name}"):
        own.take_over([tmp_path / "other"], [name])


@pytest.mark.long
def test_a_killed_study_goes_on_to_the_same_rows(whole, tmp_path):
    chance = random.Random(0)
    out, file = tmp_path / "out", whole[1]
    command = [*COMMAND, "study", str(file), "--out", str(out)]
    for _ in range(at_night(50, 2)):
        process = subprocess.Popen(
            [*command, "--jobs", "2"], stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        for _ in range(chance.randint(1, 4)):
            process.stderr.readline()
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        for content in cells_of(out).values() if out.exists() else ():
            assert json.loads(content)["error"] is None
    subprocess.run([*command, "--jobs", "1"], check=True)
    assert cells_of(out) == cells_of(whole[0])
    assert tables_of(out) == tables_of(whole[0])


def test_a_folder_of_another_study_is_neither_gone_on_in_nor_merged(whole, tmp_path, capsys):
    name = small_in(tmp_path, SMALL.replace("name: small", "name: other"))
    bn.Study(name, world="scripted").run(tmp_path / "other", jobs=1)
    command = ["study", str(whole[1]), "--jobs", "1", "--out"]
    assert run_command_line([*command, str(tmp_path / "other")]) == 2
    told = "other holds a study of other, and this one is of small; name another folder"
    assert told in capsys.readouterr().err
    merge = ["--merge", str(tmp_path / "other")]
    assert run_command_line([*command, str(tmp_path / "out"), *merge]) == 2
    shown = capsys.readouterr().err
    assert "study: checking all variations\n" in shown
    assert "holds no cell of this study" in shown
    assert not cells_of(tmp_path / "out")


def test_a_study_that_has_ended_can_become_larger(tmp_path):
    name = small_in(tmp_path)
    seen = []
    for repeats, counts in ((1, [1]), (2, [1]), (2, [1, 2])):
        study = bn.Study(name, repeats=repeats, variations={"count": counts})
        told = []
        result = study.run(tmp_path / "out", jobs=1, on_progress=told.append)
        seen.append((told[0].done, told[-1].done))
        assert len(result.frame()) == repeats * len(counts)
    assert seen == [(0, 1), (1, 2), (2, 4)]


def test_a_scenario_that_was_changed_is_played_again(tmp_path):
    name = small_in(tmp_path)
    bn.Study(name).run(tmp_path / "out", jobs=1)
    small_in(tmp_path, SMALL.replace("3.5, 1, 3.5", "4.5, 1, 4.5"))
    told = []
    bn.Study(name).run(tmp_path / "out", jobs=1, on_progress=told.append)
    assert (told[0].done, told[-1].done) == (0, 1)


def test_recorded_runs_are_where_the_rows_say(tmp_path):
    result = bn.Study(small_in(tmp_path)).run(tmp_path / "out", jobs=1, record=True)
    with bn.Nest.read(tmp_path / "out" / result.rows[0]["run"]) as nest:
        assert nest["/ann"].state.containers[(1, 1, 1)].items == {"diamond": 1}


def test_a_world_that_fails_is_a_row_that_says_why(tmp_path):
    broken = SMALL + "script: [{agent: ann, program: 'throw new Error(\"no ${item}\")'}]\n"
    study = bn.Study(small_in(tmp_path, broken), variations={"item": ["bone", "diamond"]})
    result = study.run(tmp_path / "out", jobs=1)
    assert [row["outcome"] for row in result.rows] == ["error", "error"]
    assert "no bone" in result.rows[0]["why_not"]
    assert not result.frame()["ok"].any()
    assert result.summary().loc[0, ["judged", "right", "error"]].tolist() == [2, 0, 2]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("scenarios: []\n", "study.yaml:1: scenarios: a study without scenarios has no cells"),
        ("scenarios: [small.yaml]\nrepeats: 0\n", "study.yaml:2: repeats: repeats is 0"),
        (
            "scenarios: [small.yaml]\nrepeats: 1000000000\n",
            "study.yaml:2: repeats: there would be more than 200,000 cells",
        ),
        (
            f"scenarios: [small.yaml]\nvariations: {{a: {[*range(500)]}, b: {[*range(500)]}}}\n",
            "study.yaml:2: variations: there would be more than 200,000 cells",
        ),
        ("scenarios: [small.yaml]\nrepeat: 2\n", "study.yaml:2: repeat: unknown key"),
        (
            "scenarios: small.yaml\nmodels: 3\n",
            "study.yaml:2: models: expected a list such as [text], or a text, got 3",
        ),
        (
            "scenarios: [small.yaml]\nvariations: {spot: 3}\n",
            "yaml:2: variations.spot: variations of",
        ),
        ("scenarios: [small.yaml]\nvariations: {spot: []}\n", "variations of 'spot' are []"),
        (
            "scenarios: [small.yaml]\nvariations:\n  item: [bone]\n  spto: [1]\n",
            "study.yaml:4: variations.spto: there is no parameter 'spto'; did you mean 'spot'?",
        ),
        (
            "scenarios: [small.yaml]\nvariations: {agents: [{an: tom}]}\n",
            "study.yaml:2: variations: no combination is valid; the reason of the first: there is",
        ),
        (
            "scenarios: [small.yaml]\nvariations: 2\nconstraints: [spto == 1]\n",
            "study.yaml:3: constraints[0]: there is no parameter 'spto'; did you mean 'spot'?",
        ),
        (
            "scenarios: [small.yaml]\nconstraints: [spot ==]\n",
            "study.yaml:2: constraints[0]: 'spot ==' is no expression",
        ),
        (
            "scenarios: [small.yaml]\nvariations: 2\nconstraints: [spot * 2 > 1]\n",
            "study.yaml:3: constraints[0]: 'spot * 2 > 1' cannot be computed",
        ),
        ("scenarios: [small.yaml]\nworld: moon\n", "there is no world 'moon'"),
        (
            "scenarios: [small.yaml]\nmodels:\n- offline\n- ofline\n",
            "study.yaml:4: models[1]: no model 'ofline'; did you mean offline?",
        ),
        (
            "scenarios: [small.yaml]\nmodels:\n- offline\n- 3\n",
            "study.yaml:4: models[1]: expected a text, got 3",
        ),
        (
            "scenarios: [small.yaml]\nclaims_from: ofline\n",
            "study.yaml:2: claims_from: no model 'ofline'",
        ),
        (
            "scenarios:\n- small.yaml\n- sally-ann\n",
            "study.yaml:3: scenarios[1]: there is no file",
        ),
        ("scenarios:\n- sally-ann\n", "did you mean 'sally-anne'?"),
        (
            "scenarios:\n- label: one\n  scenarios:\n  - small.yaml\n  - smal.yaml\n",
            "study.yaml:5: scenarios[0].scenarios[1]: there is no file",
        ),
        ("tasks:\n- help-find\n- recip\npolicies: random\n", "study.yaml:3: tasks[1]: there is no"),
        (
            "tasks: help-find\npolicies:\n- random\n- {anne: serch}\n",
            "study.yaml:4: policies[1]: ",
        ),
        (
            "tasks: help-find\nmodels:\n- ofline\norders: [1]\n",
            "study.yaml:3: models[0]: ",
        ),
        (
            "scenarios: [small.yaml]\ntemplates:\n- story\n- none.txt\n",
            "study.yaml:4: templates[1]: there is no template file",
        ),
        ("- small.yaml\n", "study.yaml: is not a mapping of keys to values"),
        ("scenarios: small.yaml\nmax_cost: .nan\n", "study.yaml:2: max_cost: max_cost is nan"),
    ],
)
def test_a_wrong_study_is_told_in_one_line(text, told, tmp_path, capsys):
    file = study_in(tmp_path, text)
    status = run_command_line(["study", str(file), "--out", str(tmp_path / "out"), "--jobs", "1"])
    shown = capsys.readouterr().err.splitlines()
    assert status == 2
    assert told in shown[-1]
    assert "Traceback" not in "".join(shown)


def test_a_template_that_fails_is_named_with_its_line_before_anything_is_played(tmp_path, capsys):
    (tmp_path / "mine.txt").write_text("{{ task }}\n{{ branch }} {{ tsk }} {{ other }}\n")
    file = study_in(tmp_path, "scenarios: [small.yaml]\ntemplates: [mine.txt]\nworld: scripted\n")
    command = ["study", str(file), "--out", str(tmp_path / "out"), "--jobs", "1"]
    assert run_command_line(command) == 2
    last = capsys.readouterr().err.splitlines()[-1]
    assert "no combination is valid" in last
    assert last.endswith(
        f"{tmp_path / 'mine.txt'}, line 2: there is no variable 'tsk'; did you mean task?"
    )
    assert not (tmp_path / "out" / "study.json").exists()


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--jobs", "0"], "'--jobs'"),
        (["--backend", "threads"], "there is no backend 'threads'; there are loky, dask, ray"),
        (["--shard", "3/2"], "there is no shard 3 of 2"),
        (["--shard", "half"], "give it as I/N, such as 1/4"),
        (["--merge", "nowhere"], "there is no study at nowhere"),
    ],
)
def test_wrong_options_are_told_in_one_line(options, told, tmp_path, capsys):
    command = ["study", str(study_in(tmp_path, STUDY)), "--out", str(tmp_path / "out"), *options]
    assert run_command_line(command) == 2
    assert told in capsys.readouterr().err.splitlines()[-1]


def test_a_folder_of_something_else_stays_as_it_is(tmp_path, capsys):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.txt").write_text("mine")
    file = study_in(tmp_path, STUDY)
    assert run_command_line(["study", str(file), "--out", str(tmp_path / "out")]) == 2
    assert "holds no study" in capsys.readouterr().err
    assert [each.name for each in (tmp_path / "out").iterdir()] == ["thesis.txt"]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"scenarios": None}, "scenarios is None; give a name, or a list of names"),
        ({"models": [None]}, "models is [None]"),
        ({"templates": 3}, "templates is 3"),
        ({"templates": ["paper", "paper"]}, "templates: 'paper' is named twice"),
        ({"balance": ["first", "first"]}, "balance: 'first' is named twice"),
        ({"conditions": []}, "conditions is []"),
        ({"conditions": ["one"]}, "'one' is no condition"),
        ({"constraints": [3]}, "constraints has 3"),
        ({"variations": {"count": [1, 1]}}, "variations of 'count': '1' is named twice"),
        ({"variations": {"count": [float("nan")]}}, "variations of 'count' have nan"),
        ({"world": 3}, "world is 3"),
        ({"temperature": -1}, "temperature is -1"),
        ({"max_tokens": -1}, "max_tokens is -1"),
        ({"max_cost": "5"}, "max_cost is '5'"),
        ({"claims_from": 3}, "claims_from is 3"),
        ({"seeds": 3}, "policies, orders, seeds and help are for tasks"),
    ],
)
def test_a_wrong_argument_is_told_by_its_name(tmp_path, arguments, told):
    with pytest.raises(bn.BeliefNestError) as caught:
        bn.Study(**{"scenarios": small_in(tmp_path), **arguments})
    assert told in str(caught.value)


def test_conditions_may_be_one_and_texts():
    for conditions in (2, "2", ["2"]):
        plan = bn.Study("sally-anne", conditions=conditions).plan()
        assert [cell.key.condition for cell in plan.cells] == [2]


def test_a_constraint_that_breaks_is_listed_with_its_error(tmp_path):
    def far(values):
        return values["distance"] > 3

    (invalid,) = bn.Study(small_in(tmp_path), constraints=far).plan().invalid
    assert invalid.why == "the constraint 'far' raised KeyError: 'distance'"


def test_what_rows_could_not_tell_apart_is_refused(tmp_path):
    own = SMALL.replace("parameters:\n", "parameters:\n  task: {default: 1, values: [1, 2]}\n")
    with pytest.raises(bn.InputError, match="'task' has the name of a column of the table"):
        bn.Study(small_in(tmp_path, own), variations={"task": [1, 2]}).plan()
    one, other = tmp_path / "one", tmp_path / "other"
    for folder in (one, other):
        folder.mkdir()
    with pytest.raises(bn.InputError, match="are both called 'small'"):
        bn.Study([small_in(one), small_in(other)]).plan()


def test_wide_ranges_take_no_room(tmp_path):
    wide = SMALL.replace(
        "parameters:\n", "parameters:\n  any: {default: 0, range: [0, 10000000000]}\n"
    )
    plan = bn.Study(small_in(tmp_path, wide), variations=3, seed=1).plan()
    assert len({cell.key.variation["any"] for cell in plan.cells}) == 3
    endless = wide.replace("range: [0, 10000000000]", "range: [0.0, 1.0], step: 1.0e-9")
    with pytest.raises(bn.ScenarioError, match=r"more than 1,000,000 values; give a greater step"):
        bn.Study(small_in(tmp_path, endless), variations=3).plan()


def test_merged_runs_and_times_come_along(tmp_path):
    study = bn.Study(small_in(tmp_path))
    study.run(tmp_path / "part", jobs=1, record=True)
    assert study.take_over(tmp_path / "all", [tmp_path / "part"]) == 1
    result = study.run(tmp_path / "all", jobs=1)
    assert (tmp_path / "all" / result.rows[0]["run"]).is_file()
    assert len(result.seconds()) == 1


def test_a_line_that_was_cut_off_spoils_no_other(tmp_path):
    folder = StudyFolder.open(tmp_path / "out", SCENARIO_KIND)
    for file in (folder.ledger, folder.path / "seconds.jsonl"):
        file.write_text('{"cell": "on', "utf-8")
    SharedBudget(RunLimits(), file=folder.ledger).add(Usage(1, 10, 5, 0.5))
    folder.note_seconds("one", 1.5)
    assert spent_in(folder.ledger) == Usage(1, 10, 5, 0.5)
    assert folder.seconds() == {"one": 1.5}


def test_a_few_quick_cells_are_played_by_one_process(whole, tmp_path, monkeypatch):
    def no_processes(max_workers):
        raise AssertionError("a process was started")

    monkeypatch.setattr("joblib.externals.loky.ProcessPoolExecutor", no_processes)
    bn.Study.load(whole[1]).run(tmp_path / "one", jobs=2)
    assert cells_of(tmp_path / "one") == cells_of(whole[0])
    monkeypatch.setattr("beliefnest.plan.jobs._FEW", {"embedded": CELLS - 1})
    with pytest.raises(AssertionError, match="a process was started"):
        bn.Study.load(whole[1]).run(tmp_path / "two", jobs=2)


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs /proc")
def test_cells_of_a_process_that_is_killed_are_played_later(whole, tmp_path, monkeypatch):
    monkeypatch.setattr("beliefnest.plan.jobs._FEW", {})
    before = children()

    def kill(progress):
        # As the operating system does if memory runs out: the worker is killed, not its helpers.
        for pid in children() - before:
            if b"loky.backend.popen_loky_posix" in Path(f"/proc/{pid}/cmdline").read_bytes():
                os.kill(pid, signal.SIGKILL)

    study = bn.Study.load(whole[1])
    with pytest.raises(bn.BodyError, match="finished cells are kept"):
        study.run(tmp_path / "out", jobs=2, on_progress=kill)
    monkeypatch.undo()
    study.run(tmp_path / "out", jobs=1)
    assert cells_of(tmp_path / "out") == cells_of(whole[0])


def test_a_process_that_is_ended_is_told_of():
    with pytest.raises(bn.BodyError, match="finished cells are kept"), _engine("loky", 2):
        raise TerminatedWorkerError


def test_labels_make_groups_of_scenarios_a_factor(tmp_path):
    small_in(tmp_path)
    other = tmp_path / "other.yaml"
    other.write_text(SMALL.replace("name: small", "name: other"), encoding="utf-8")
    text = "- {label: near, scenarios: small.yaml}\n- {label: far, scenarios: [other.yaml]}\n"
    file = tmp_path / "study.yaml"
    file.write_text(f"scenarios:\n{text}models: [offline]\nworld: scripted\n", encoding="utf-8")
    study = bn.Study.load(file)
    bare = bn.Study([str(tmp_path / "small.yaml"), str(other)], world="scripted")
    assert [c.key.name for c in study.plan().cells] == [c.key.name for c in bare.plan().cells]
    result = study.run(tmp_path / "out", jobs=1)
    assert [row["label"] for row in result.rows] == ["near", "far"]
    assert [row["label"] for row in result.counted(["label"])] == ["near", "far"]
    assert result.where("label == 'far'").rows[0]["scenario"] == "other"
    assert result.reproduce().differences == ()
    wrong = (
        ("- small.yaml\n- {label: x, scenarios: other.yaml}\n", "small.yaml has no label"),
        ("- {label: x}\n", "give a name, or a mapping"),
        ("- {label: '', scenarios: small.yaml}\n", "give a name, or a mapping"),
        ("- {scenario: small.yaml, label: x}\n", "give a name, or a mapping"),
    )
    for entries, told in wrong:
        file.write_text(f"scenarios:\n{entries}", encoding="utf-8")
        with pytest.raises(bn.ScenarioError, match=told):
            bn.Study.load(file)
