"""Every run folder gets a page with all that came of it, which needs nothing else."""

import html
import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.cli.folder import store_in
from beliefnest.errors import BodyError
from beliefnest.worlds.scripted.nest_world import ScriptedNestWorld

pytestmark = pytest.mark.usefixtures("kept_worlds")

TWICE = """\
name: twice
description: "Ann <b>& Bob</b>"
box: [[0, 0, 0], [8, 3, 8]]
blocks: [{block: stone, fill: [[0, 0, 0], [8, 0, 8]]}]
containers: [{at: [4, 1, 2], block: barrel, label: "</svg><script>alert(1)</script>"}]
agents: {ann: {position: [2.5, 1, 2.5], inventory: {apple: 1}}, bob: {position: [6.5, 1, 6.5]}}
places: {"<i>": [1, 1, 1]}
script:
  - label: Ann says something
    agent: ann
    program: "await depositItemIntoChest(bot, new Vec3(4, 1, 2), {apple: 1});"
probes:
  - path: /bob
    acts_in: /
    agent: bob
    task: "Get an apple from a chest. <script>alert(2)</script>"
    expect: {opens: [4, 1, 2]}
expectations:
  - {path: /bob, label: "<u>", container: [4, 1, 2], items: {apple: 1}}
  - {path: /bob, label: "nothing", container: [4, 1, 2], items: {}}
conditions: {1: {description: "<em>one</em>"}, 2: {}}
"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("report")
    scenario = folder / "twice.yaml"
    scenario.write_text(TWICE, encoding="utf-8")
    run_command_line(["run", str(scenario), "--out", str(folder / "run"), "--seed", "7"])
    return (folder / "run" / "report.html").read_text(encoding="utf-8")


def test_all_text_of_others_is_escaped(page: str) -> None:
    assert "<script" not in page
    for tag in ("<b>", "<i>", "<u>", "<em>"):
        assert tag not in page
    assert "Ann <b>& Bob</b>" in html.unescape(page)


def test_the_page_needs_nothing_else(page: str) -> None:
    assert not re.findall(r"(?:src|href)=", page)
    assert set(re.findall(r"https?://[^\"' )]+", page)) <= {"http://www.w3.org/2000/svg"}
    for drawing in re.findall(r"<svg.*?</svg>", page, re.DOTALL):
        ElementTree.fromstring(drawing)


def test_each_probe_has_its_prompt_answer_program_and_reasons(page: str) -> None:
    said = html.unescape(page)
    assert said.count("Task: Get an apple from a chest.") >= 2
    assert said.count("<h4>Program</h4>") == 2
    assert said.count("getItemFromChest") >= 2
    assert "Judged by the container that Bob opens first" in said
    assert "bob believes that" in said
    assert "--seed 7" in said
    assert "mineflayer" in said
    assert said.count("<svg") == 2


def test_what_happened_is_told_in_words(page: str) -> None:
    told = html.unescape(page)
    assert "bob opens </svg><script>alert(1)</script>" in told
    assert "bob takes 1 apple out of </svg>" in told
    assert "open container" not in told
    # The report leaves out the lid of a barrel.
    assert "is now at" not in told


def test_that_nothing_is_expected_in_a_container_is_said(page: str) -> None:
    assert "items: none<" in page


def test_a_run_that_cannot_begin_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse(*_: object) -> None:
        raise BodyError("there is no room for it")

    monkeypatch.setattr(ScriptedNestWorld, "open_body", refuse)
    arguments = ["--condition", "1", "--world", "scripted", "--out", str(tmp_path / "run")]
    assert run_command_line(["run", "sally-anne", *arguments]) != 0
    assert capsys.readouterr().err.endswith("there is no room for it\n")


ASK = """\
name: ask
box: [[0, 0, 0], [8, 3, 6]]
blocks: [{block: stone, fill: [[0, 0, 0], [8, 0, 6]]}]
static_blocks: [stone]
containers: [{at: [7, 1, 5], label: red box, items: {apple: 1}}, {at: [1, 1, 5], label: blue box}]
agents: {wim: {position: [4.5, 1, 5.5]}}
initial_beliefs: [{path: /wim, containers: [{at: [7, 1, 5], items: {apple: 1}}]}]
probes:
  - path: /wim
    expect:
      answers: {question: "Where is the apple?", options: [red box, blue box], right: red box}
"""
PULL = """\
  - {path: /wim, acts_in: /, agent: wim, task: Turn on the lever.}
"""


def test_a_question_is_told_with_its_answer_and_no_program(tmp_path: Path) -> None:
    (tmp_path / "ask.yaml").write_text(ASK)
    command = ["run", str(tmp_path / "ask.yaml"), "--world", "scripted"]
    assert run_command_line([*command, "--out", str(tmp_path / "out")]) == 0
    page = html.unescape((tmp_path / "out" / "report.html").read_text("utf-8"))
    assert "acted out" not in page
    assert "<h4>Program</h4>" not in page
    assert "Where is the apple? Options: " in page
    assert "Answer: red box" in page
    assert (
        "Judged by the model's answer to the question; right is 'red box'; that is as expected."
        in page
    )
    with bn.Nest.read(store_in(tmp_path / "out")) as nest:
        (prompt,) = nest.prompts()
    assert prompt.detail["task"] == "Where is the apple?"


def test_why_a_program_failed_is_told_by_the_run_its_report_and_its_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "ask.yaml").write_text(ASK.partition("probes:")[0] + "probes:\n" + PULL)
    answer = "```javascript\nawait turnOnLever(bot, new Vec3(5, 1, 1))\n```"
    (tmp_path / "says.json").write_text(json.dumps([answer]))
    command = ["run", str(tmp_path / "ask.yaml"), "--world", "scripted"]
    command += ["--model", f"scripted:{tmp_path / 'says.json'}", "--out", str(tmp_path / "out")]
    assert run_command_line(command) == 0
    why = "line 1: turnOnLever: there is no lever at (5, 1, 1), but air. "
    why += "Give the position of a lever."
    assert f"probe 1: the program failed: {why}" in capsys.readouterr().out
    page = html.unescape((tmp_path / "out" / "report.html").read_text("utf-8"))
    assert f"the program failed: {why}; it ran from tick 0 to tick 1" in page
    report = json.loads((tmp_path / "out" / "run.json").read_text("utf-8"))
    assert report["runs"][0]["probes"][0]["error"] == why


def test_the_table_shows_block_states_with_their_brackets(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A terminal takes words in brackets for styles unless they are escaped."""
    (tmp_path / "lit.yaml").write_text(
        "name: lit\nbox: [[0, 0, 0], [4, 3, 4]]\n"
        "blocks:\n  - {block: stone, fill: [[0, 0, 0], [4, 0, 4]]}\n"
        "  - {block: 'redstone_lamp[lit=true]', at: [3, 1, 3]}\n"
        "agents: {ann: {position: [1.5, 1, 1.5]}}\n"
        "expectations:\n  - {path: /ann, block: [3, 1, 3], state: 'redstone_lamp[lit=true]'}\n",
        "utf-8",
    )
    command = [
        "run",
        str(tmp_path / "lit.yaml"),
        "--world",
        "scripted",
        "--out",
        str(tmp_path / "r"),
    ]
    assert run_command_line(command) == 0
    assert "redstone_lamp[lit=true]" in capsys.readouterr().out
