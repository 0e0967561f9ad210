"""A small real model plays a scenario, a study and a policy; each of its answers is accounted for.

At night only: `tools/real_model/prepare.sh FOLDER` prepares the model, and `BELIEFNEST_REAL_MODEL`
names that folder. What the model answers does not matter: it may be wrong or nonsense.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.processes import started

import beliefnest as bn
from beliefnest.scenarios.judging import OUTCOMES

FOLDER = os.environ.get("BELIEFNEST_REAL_MODEL", "")
MODEL = "compatible:small"

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not FOLDER, reason="BELIEFNEST_REAL_MODEL names no folder of a model"),
]


@pytest.fixture(scope="module")
def address():
    folder = Path(FOLDER)
    command = ["node", str(folder / "serve.mjs"), str(folder / "model.gguf"), "0"]
    with started(command, stdout=subprocess.PIPE) as server:
        assert server.stdout is not None
        yield server.stdout.readline().strip()


@pytest.fixture(autouse=True)
def reached(address, monkeypatch):
    monkeypatch.setenv("COMPATIBLE_BASE_URL", address)


def test_sally_anne(tmp_path):
    command = [sys.executable, "-m", "beliefnest", "run", "sally-anne", "--world", "scripted"]
    command += ["--model", MODEL, "--attempts", "1", "--max-output-tokens", "60", "--json"]
    command += ["--skills", "names", "--out", str(tmp_path / "run")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1, 3), done.stderr
    report = json.loads((tmp_path / "run" / "run.json").read_text(encoding="utf-8"))
    conditions = len(bn.Scenario.load_all("sally-anne"))
    assert len(report["runs"]) + len(report.get("failures", [])) == conditions
    answers = (tmp_path / "run" / "model.jsonl").read_text(encoding="utf-8").splitlines()
    assert len(answers) == conditions


def test_a_study(tmp_path):
    study = bn.Study(
        ["sally-anne"],
        models=[MODEL],
        conditions=[1, 3],
        world="scripted",
        attempts=1,
        max_output_tokens=60,
        skills="names",
    )
    result = study.run(tmp_path / "out", jobs=1)
    assert len(result.rows) == len(study.plan().cells) == 2
    for row in result.rows:
        assert row["outcome"] in OUTCOMES
        assert row["outcome"] != "error", row["why_not"]
        assert row["tokens"] > 0


def test_a_policy():
    task = bn.Task.load("recipe", seed=3)
    policy = f"model:{MODEL}:1?max_output_tokens=60&skills=none"
    with bn.Episode(task, {"anne": policy}) as episode:
        episode.play(2)
        prompts = episode.nest.prompts()
        assert episode.model_errors == ()
        assert all(prompt.answer is not None for prompt in prompts)
        assert episode.measures.requests == len(prompts) >= 2
        decided = [part.decisions["anne"] for part in episode.parts if "anne" in part.decisions]
        assert all(each.program or each.fault for each in decided)
