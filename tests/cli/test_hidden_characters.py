"""Hidden characters in texts of agents and models are escaped wherever the texts are shown."""

import base64
import csv
import json
import re
import zlib
from pathlib import Path

import pandas
import pytest
from tests.llm.conftest import FakeOpenAI, serving

import beliefnest as bn
from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")

HIDDEN = "\u202e\u2066\u200f\u200b"
SPOKEN = "\u200b"
"""Hidden character that agents may say; marks of direction are refused."""
FORMULA = '=HYPERLINK("http://there","click")'
SCENARIO = f"""\
name: odd
description: "words {HIDDEN}"
box: [[0, 0, 0], [6, 3, 6]]
blocks: [{{block: stone, fill: [[0, 0, 0], [6, 0, 6]]}}]
containers: [{{label: "box {HIDDEN}", at: [3, 1, 3], items: {{apple: 1}}}}]
agents: {{ann: {{position: [1.5, 1, 1.5]}}, bob: {{position: [5.5, 1, 5.5]}}}}
script:
  - label: "step {HIDDEN}"
    agent: ann
    program: "await say(bot, 'hello {SPOKEN}'); await think(bot, 'hm {SPOKEN}')"
probes:
  - label: "probe {HIDDEN}"
    path: /bob
    acts_in: /bob
    agent: bob
    task: "Get an apple {HIDDEN}."
    expect: {{opens: [3, 1, 3]}}
"""
ANSWER = f"""{FORMULA} {HIDDEN}
```javascript
{FORMULA} // {HIDDEN}
```"""


def shown(file: Path) -> str:
    """All that a page can show: its own text, and its data unpacked."""
    text = file.read_text("utf-8")
    packed = re.search(r'"packed": ?"([^"]*)"', text)
    return text if packed is None else text + zlib.decompress(base64.b64decode(packed[1])).decode()


def test_nothing_hidden_reaches_models_or_pages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("odd.yaml").write_text(SCENARIO, "utf-8")
    Path("study.yaml").write_text("scenarios: [odd.yaml]\nmodels: ['vllm:m']\n")
    with serving() as served:
        served.will(FakeOpenAI.says(ANSWER))
        monkeypatch.setenv("VLLM_BASE_URL", served.url)
        run = ["run", "odd.yaml", "--model", "vllm:m", "--out", "run"]
        assert run_command_line(run) == 1
        study = ["study", "study.yaml", "--jobs", "1", "--record", "--out", "st"]
        assert run_command_line(study) == 1
        asked = json.dumps([each.body for each in served.requests], ensure_ascii=False)
    assert r"hello \\u200b" in asked
    assert r"Get an apple \\u202e" in asked
    assert not set(HIDDEN) & set(asked)
    assert run_command_line(["show", "run", "--html", "page.html"]) == 0
    for file in map(Path, ("run/report.html", "st/study.html", "page.html")):
        told = shown(file)
        assert "u202e" in told, file
        assert not set(HIDDEN) & set(told), file
    with bn.Nest.read(next(Path("run").rglob("run.bn"))) as nest:
        told = nest["/bob"].explain(agent="ann")._repr_html_() + nest.view().page
        assert not set(HIDDEN) & set(told)
    told = capfd.readouterr()
    assert not set(HIDDEN) & set(told.out + told.err)


@pytest.fixture
def played(tmp_path: Path) -> Path:
    """Play a study whose texts are formulas; return its folder."""
    scenario = {
        "name": "odd",
        "box": [[0, 0, 0], [6, 3, 6]],
        "agents": {"ann": {"position": [1.5, 1, 1.5]}},
        "containers": [{"at": [3, 1, 3], "items": {"apple": 1}}],
        "probes": [
            {
                "label": FORMULA,
                "path": "/ann",
                "acts_in": "/ann",
                "agent": "ann",
                "task": "@SUM(1+1)",
                "expect": {"opens": [3, 1, 3]},
            }
        ],
    }
    file = tmp_path / "odd.yaml"
    file.write_text(json.dumps(scenario))
    study = tmp_path / "study.yaml"
    study.write_text("scenarios: [odd.yaml]\nmodels: [offline]\nworld: scripted\n")
    out = tmp_path / "st"
    run_command_line(["study", str(study), "--out", str(out), "--jobs", "1"])
    return out


def test_no_cell_of_a_csv_file_is_a_formula(played: Path) -> None:
    with (played / "rows.csv").open(newline="", encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert row["probe"] == f"'{FORMULA}"
    assert row["task"] == "'@SUM(1+1)"
    assert all(not value.startswith(("=", "@", "+")) for value in row.values())


@pytest.mark.extra("pyarrow")
def test_texts_in_a_parquet_file_are_as_they_are(played: Path) -> None:
    raw = pandas.read_parquet(played / "rows.parquet").iloc[0]
    assert (raw["probe"], raw["task"]) == (FORMULA, "@SUM(1+1)")
