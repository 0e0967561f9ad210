"""Tasks of Inspect AI, with its mock model and ours, as `inspect eval` finds them."""

import os
import re
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

pytest.importorskip("inspect_ai", reason="the extra `inspect` is not installed")

GUIDE = Path(__file__).parents[2] / "docs" / "inspect.md"

MOCKED = """
from inspect_ai import eval
from inspect_ai.log import read_eval_log
from inspect_ai.model import ModelOutput, ModelUsage, get_model
from beliefnest.inspect.registry import scenario

def answer(messages, tools, choice, config):
    x = -2 if "Get a diamond" in messages[-1].text else 0
    code = f"await getItemFromChest(bot, new Vec3({x}, -51, -4), {{diamond: 1}})"
    output = ModelOutput.from_content("mockllm/model", f"```javascript\\n{code}\\n```")
    # Else the mock model counts them with a table from the network.
    output.usage = ModelUsage(input_tokens=1, output_tokens=1, total_tokens=2)
    return output

task = scenario("sally-anne", conditions=[1, 2], world="scripted")
model = get_model("mockllm/model", custom_outputs=answer)
(log,) = eval(task, model=model, display="none")
assert log.status == "success", log.error
for sample in log.samples:
    score = sample.scores["in_the_belief"]
    print(sample.metadata["condition"], score.value, score.metadata["outcome"])
    assert "/observer/sally" in score.explanation, score.explanation
    assert sample.messages[0].role == "system"
"""


def run(code, folder):
    # Inspect has an event loop, threads and a log of its own: a process of its own as well.
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_answers_of_the_mock_model_are_run_in_the_belief_and_explained(tmp_path):
    assert sorted(run(MOCKED, tmp_path)) == ["1 C ok", "2 I wrong"]


def test_the_guide_does_what_it_says(tmp_path):
    (code,) = re.findall(r"```python\n(.*?)```", GUIDE.read_text("utf-8"), re.DOTALL)
    assert run(code, tmp_path) == re.findall(r"print\(.*\)  # (.*)", code)


def test_the_installed_package_registers_its_tasks(tmp_path):
    names = {each.name for each in entry_points(group="inspect_ai")}
    assert "beliefnest" in names, "installed before it had tasks; pip install -e . again"
    command = [sys.executable, "-m", "inspect_ai", "eval", "beliefnest/help_sally"]
    command += ["--model", "beliefnest/offline", "-T", "world=scripted", "--limit", "1"]
    done = subprocess.run(
        [*command, "--display", "plain"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, "COLUMNS": "100"},
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"accuracy\s+1\.000", done.stdout)


def test_a_question_of_a_suite_is_a_sample_with_its_container_as_target(tmp_path):
    file = tmp_path / "stories.json"
    file.write_text(
        '[{"story": "1 Ann and Bob entered the den.\\n2 The ball is in the box.\\n'
        '3 Ann exited the den.\\n4 Bob moved the ball to the jar.",'
        ' "question": "Where does Ann think the ball is?", "answer": "box"}]'
    )
    code = (
        "from beliefnest.inspect.registry import hi_tom\n"
        f"(sample,) = hi_tom({str(file)!r}).dataset\n"
        "print(sample.target, sample.metadata['order'], sample.metadata['options'])\n"
    )
    assert run(code, tmp_path) == ["box 1 ['box', 'jar', 'in none of them']"]
