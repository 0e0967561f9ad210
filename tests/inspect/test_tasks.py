"""Tasks of Inspect AI, with its mock model and ours, as `inspect eval` finds them."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from tests.llm.conftest import serving
from tests.processes import started
from tests.studies.test_doors import ROOM, SAID

from beliefnest.scenarios.judging import NOT_ANSWERED

pytestmark = pytest.mark.extra("inspect_ai")

GUIDE = Path(__file__).parents[2] / "docs" / "inspect.md"

MODEL = """
from inspect_ai import eval
from inspect_ai.log import read_eval_log
from inspect_ai.model import ModelOutput, ModelUsage, get_model

def mock(answer):
    def output(messages, tools, choice, config):
        said = ModelOutput.from_content("mockllm/model", answer(messages))
        # Else the mock model counts them with a table from the network.
        said.usage = ModelUsage(input_tokens=1, output_tokens=1, total_tokens=2)
        return said
    return get_model("mockllm/model", custom_outputs=output)

def read(logs):
    for log in logs:
        assert log.status == "success", log.error
    return [read_eval_log(log.location) for log in logs]
"""

LEFT_OR_NOWHERE = """
def answer(messages):
    assert messages[0].role == "system"
    x = -2 if "Get a diamond" in messages[-1].text else 0
    code = f"await getItemFromChest(bot, new Vec3({x}, -51, -4), {{diamond: 1}})"
    return f"```javascript\\n{code}\\n```"

task = "beliefnest/sally_anne"
arguments = {"conditions": [1, 2], "world": "scripted"}
(log,) = read(eval(task, task_args=arguments, model=mock(answer), display="none"))
for sample in log.samples:
    score = sample.scores["in_the_belief"]
    print(sample.metadata["condition"], score.value, score.metadata["outcome"])
    assert "/observer/sally" in score.explanation, score.explanation
"""

LIKE_OURS = """
from beliefnest.llm.messages import Message, Sampling
from beliefnest.llm.offline import OfflineModel

def answer(messages):
    asked = [Message(each.role, each.text) for each in messages]
    return OfflineModel().answer(asked, Sampling()).text
"""

VARIED = """
arguments = {"conditions": 2, "variations": 3, "seed": 1}
(log,) = read(
    eval("beliefnest/sally_anne", task_args=arguments, model=mock(answer), display="none")
)
for sample in log.samples:
    score = sample.scores["in_the_belief"]
    told = score.explanation.splitlines()
    path, names = sample.metadata["path"], sample.metadata["variation"]["agents"]
    assert path == f"/{names['observer']}/{names['sally']}"
    assert sample.metadata["world"] == "embedded"
    print(score.value, told[0], any(f"What {path} holds, and why:" == line for line in told))
    assert any(names["anne"] in line for line in told[3:]), told
assert len({str(sample.metadata["variation"]) for sample in log.samples}) == 3
"""

EVERY = """
from beliefnest.scenarios.sources import builtin_names

logs = []
silent = ("red-green-blue", "food-trucks")
asking = [name for name in builtin_names() if name not in silent]
for name in asking:
    arguments = {"world": "scripted"}
    task = "beliefnest/" + name.replace("-", "_")
    logs += read(eval(task, task_args=arguments, model=mock(answer), display="none", limit=1))
assert len(logs) == len(asking) > 9
for log in logs:
    (sample,) = log.samples
    score = sample.scores["in_the_belief"]
    assert score.explanation.splitlines()[0].startswith(score.metadata["outcome"]), score
"""

STORIES = """
def answer(messages):
    text = messages[-1].text
    return "Answer: box" if "Where does Ann think" in text else "Answer: in none of them"

for name, file in FILES.items():
    arguments = {"file": file}
    (log,) = read(
        eval(f"beliefnest/{name}", task_args=arguments, model=mock(answer), display="none")
    )
    for sample in log.samples:
        score = sample.scores["story_answer"]
        print(name, sample.metadata["order"], sample.target, score.answer, score.value)
        assert ", expected the " in score.explanation, score.explanation
"""


MINDS = """
def answer(messages):
    (asked,) = [each.text for each in messages]
    assert "Where you saw student, as (x, z):" in asked
    names = [line for line in asked.splitlines() if line[:7] in ("desire ", "belief ")]
    # Condition 2 is left without an answer.
    if "tick 13: (8, 1)" in asked:
        return "I cannot tell."
    high = ("desire mexican:", "belief mexican:")
    return "\\n".join(f"{name} {7 if name in high else 2}" for name in names)

(log,) = read(eval("beliefnest/minds", model=mock(answer), display="none"))
for sample in log.samples:
    score = sample.scores["like_inference"]
    print(sample.metadata["condition"], score.metadata["outcome"], score.value > 0.6)
metrics = {name: each.value for name, each in log.results.scores[0].metrics.items()}
print(sorted(metrics), metrics["desires_r"] > 0.5)
print(log.samples[1].scores["like_inference"].explanation.partition(",")[0])

arguments = {"file": FILE, "films": 1}
(log,) = read(eval("beliefnest/films", task_args=arguments, model=mock(
    lambda messages: "desire K: 4\\ndesire L: 4\\nbelief L: 3\\nbelief none: 3"
), display="none"))
(sample,) = log.samples
score = sample.scores["like_inference"]
print(sample.id, score.metadata["outcome"], score.metadata["beliefs"][0][1])
(log,) = read(
    eval("beliefnest/films", task_args=arguments, model="beliefnest/offline", display="none")
)
print(log.samples[0].scores["like_inference"].metadata["outcome"])
"""

FILM = {
    "worlds": [{"size": [3, 1], "spot1": [1, 1], "spot2": [3, 1], "possible_spot2": ["L", None]}],
    "parameters": {"reward_levels": [0, 40]},
    "scenarios": [
        {"id": 1, "true_spot1": "K", "true_spot2": "L", "path_xy": [[2, 1], [3, 1]]},
        {"id": 2, "true_spot1": "K", "true_spot2": None, "path_xy": [[2, 1], [1, 1]]},
    ],
}

EPISODES = """
import beliefnest as bn

with bn.Episode(bn.Task.load("help-find", seed=1), {"anne": "search:1"}) as told:
    program = told.play(1).parts[0].decisions["anne"].program

asked = []
def answer(messages):
    assert messages[0].role == "system"
    asked.append(messages)
    code = program if len(asked) == 1 else "await bot.waitForTicks(1)"
    return f"```javascript\\n{code}\\n```"

arguments = {"seed": 1, "seeds": 1, "order": 1}
(log,) = read(
    eval("beliefnest/help_find", task_args=arguments, model=mock(answer), display="none")
)
(sample,) = log.samples
score = sample.scores["goal_reached"]
measures = score.metadata
print(score.value, measures["messages"], measures["requests"] == len(asked))
print(measures["policies"], measures["tokens"] == 2 * len(asked))
print(score.explanation.splitlines()[0])
assert sample.messages[0].role == "system" and sample.messages[-1].role == "assistant"
assert program in score.explanation
"""

LISTENER = """
import contextlib, io, json, os, sys, traceback

for line in sys.stdin:
    folder, code = json.loads(line)
    os.chdir(folder)
    said, failed = io.StringIO(), None
    with contextlib.redirect_stdout(said):
        try:
            exec(code, {"__name__": "__main__"})
        except BaseException:
            failed = traceback.format_exc()
    print(json.dumps([said.getvalue(), failed]), flush=True)
"""

Run = Callable[[str, Path], list[str]]


@pytest.fixture(scope="module")
def run() -> Iterator[Run]:
    """Yield a function that runs programs in one process, as cells of a notebook run."""
    # Inspect has an event loop, threads and a log of its own: a process of its own as well.
    with started(
        [sys.executable, "-c", LISTENER], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as listener:
        assert listener.stdin is not None and listener.stdout is not None

        def told(code: str, folder: Path) -> list[str]:
            print(json.dumps([str(folder), code]), file=listener.stdin, flush=True)
            answer = listener.stdout.readline()
            assert answer, f"the process ended with {listener.wait()}"
            said, failed = json.loads(answer)
            assert failed is None, failed
            return said.splitlines()

        yield told
        listener.stdin.close()


def test_answers_of_the_mock_model_are_run_in_the_belief_and_explained(run, tmp_path):
    assert sorted(run(MODEL + LEFT_OR_NOWHERE, tmp_path)) == ["1 C ok", "2 I wrong"]


def test_variations_in_minecraft_are_samples_with_explanations_of_their_own(run, tmp_path):
    assert run(MODEL + LIKE_OURS + VARIED, tmp_path) == ["C ok True"] * 3


def test_every_built_in_scenario_that_asks_is_a_task_whose_samples_are_scored(run, tmp_path):
    run(MODEL + LIKE_OURS + EVERY, tmp_path)


def test_suites_are_tasks_whose_answers_are_scored_and_explained(run, tmp_path):
    story = "1 Ann and Bob entered the den.\n2 The ball is in the box.\n3 Ann exited the den.\n"
    story += "4 Bob moved the ball to the jar."
    asked = {"Where does Ann think the ball is?": "box", "Where is the ball really?": "jar"}
    rows = [{"story": story, "question": each, "answer": asked[each]} for each in asked]
    files = {
        name: str(tmp_path / file)
        for name, file in {"hi_tom": "hi.json", "tomi": "to.txt", "stories": "own.jsonl"}.items()
    }
    questions = [f"{n} {each}\t{asked[each]}\t1" for n, each in enumerate(asked, 5)]
    Path(files["tomi"]).write_text("\n".join([story, *questions]), encoding="utf-8")
    Path(files["hi_tom"]).write_text(json.dumps(rows), encoding="utf-8")
    events = [line.partition(" ")[2] for line in story.splitlines()]
    own = {
        "events": events,
        "questions": [{"question": each, "answer": asked[each]} for each in asked],
    }
    Path(files["stories"]).write_text(json.dumps(own) + "\n", encoding="utf-8")
    found = run(f"FILES = {files!r}\n{MODEL}{STORIES}", tmp_path)
    assert found == [
        line
        for name in files
        for line in (f"{name} 1 box box C", f"{name} 0 jar in none of them I")
    ]


def test_ratings_of_desires_and_beliefs_are_scored_against_exact_inference(run, tmp_path):
    file = tmp_path / "films.json"
    file.write_text(json.dumps(FILM), encoding="utf-8")
    assert run(f"FILE = {str(file)!r}\n{MODEL}{MINDS}", tmp_path) == [
        "1 rated True",
        "2 unread False",
        "3 rated True",
        "['ambiguous', 'beliefs_r', 'cut', 'desires_r', 'mean', 'no_answer', 'rated', 'refused', "
        "'stderr', 'unread'] True",
        "unread: no number from 1 to 7 for desire korean",
        "1 rated 0.5",
        "unread",
    ]


EPOCHS = """
import math, re
import numpy as np

count = [0]
def answer(messages):
    count[0] += 1
    names = re.findall(r"^(desire \\w+|belief \\w+):", messages[-1].text, re.M)
    return "\\n".join(f"{n}: {1 + (count[0] * 5 + k * 3) % 7}" for k, n in enumerate(names))

(log,) = read(eval("beliefnest/minds", model=mock(answer), epochs=3, display="none"))
(scores,) = log.results.scores
assert len(log.samples) == 9
told = [each.scores["like_inference"] for each in log.samples]
for about in ("desires", "beliefs"):
    pairs = np.array([pair for each in told for pair in each.metadata[about]])
    by_hand = np.corrcoef(pairs.T)[0, 1]
    print(about, len(pairs), math.isclose(scores.metrics[f"{about}_r"].value, by_hand))
values = [each.value for each in told]
by_sample = {}
for each in log.samples:
    by_sample.setdefault(each.id, []).append(each.scores["like_inference"].value)
sums = [sum(v - np.mean(values) for v in each) for each in by_sample.values()]
error = math.sqrt(sum(each**2 for each in sums) * 3 / 2) / 9
print(math.isclose(scores.metrics["mean"].value, np.mean(values)))
print(math.isclose(scores.metrics["stderr"].value, error))
"""


def test_metrics_are_about_all_epochs(run, tmp_path):
    assert run(MODEL + EPOCHS, tmp_path) == ["desires 27 True", "beliefs 27 True", "True", "True"]


SCENES = """
from inspect_ai.scorer import SampleScore, Score
from beliefnest.inspect.metrics import stderr_of_epochs, stderr_of_scenes

def scores(scenes):
    return [
        SampleScore(score=Score(value=value), sample_id=str(n), sample_metadata={"cluster": scene})
        for n, (scene, value) in enumerate(scenes)
    ]

for error in (stderr_of_scenes(), stderr_of_epochs()):
    print(error(scores([("a", 1), ("a", 0), ("a", 1)])), error(scores([("a", 1), ("b", 0)])))
"""


def test_samples_of_one_scene_have_no_standard_error(run, tmp_path):
    assert run(SCENES, tmp_path) == ["nan 0.5"] * 2


CHOICES = """
name: {name}
box: [[0, 0, 0], [6, 3, 6]]
blocks:
  - {{block: stone, fill: [[0, 0, 0], [6, 0, 6]]}}
parameters:
  item: {{default: apple, values: [apple, bone, bowl]}}
agents:
  uma: {{position: [3.5, 1, 3.5]}}
  bob: {{position: [4.5, 1, 3.5]}}
probes:
  - label: where
    path: /bob/uma
    expect:
      answers: {{question: "Where is ${{item}}?", options: [red, blue, green, grey], right: red}}
"""

MANY = """
def told(log):
    # Inspect lists the counts of answers that are none as scores of their own.
    every = [found.metrics for found in log.results.scores]
    return {name: each.value for metrics in every for name, each in metrics.items()}

arguments = {"file": ["one.yaml", "two.yaml"], "world": "scripted", "variations": 3}
models = {name: [] for name in ("beliefnest/chance", "beliefnest/scripted:answers.json")}
for name in models:
    (log,) = read(eval("beliefnest/scenario", task_args=arguments, model=name, display="none"))
    found = told(log)
    about = {(s.metadata["order"], s.metadata["chance"]) for s in log.samples}
    print(len(log.samples), len({s.metadata["cluster"] for s in log.samples}), about)
    rights = [s.scores["in_the_belief"].value == "C" for s in log.samples]
    assert found["accuracy"] == sum(rights) / 6, found
    print(found["chance"], 0 <= found["low"] <= found["accuracy"] <= found["high"] <= 1)
try:
    eval("beliefnest/scenario", task_args={**arguments, "file": ["one.yaml", "one.yaml"]},
         model="beliefnest/chance", display="none")
except Exception as error:
    print(error)
"""


def test_one_task_has_the_samples_of_many_files_and_our_models_answer(run, tmp_path):
    for name in ("one", "two"):
        (tmp_path / f"{name}.yaml").write_text(CHOICES.format(name=name), encoding="utf-8")
    (tmp_path / "answers.json").write_text(json.dumps(["Answer: red"] * 6), encoding="utf-8")
    assert run(MODEL + MANY, tmp_path) == [
        *["6 6 {(2, 0.25)}", "0.25 True"] * 2,
        "file names one.yaml twice; name it once",
    ]


def test_episodes_are_samples_whose_players_a_model_plays(run, tmp_path):
    assert run(MODEL + EPISODES, tmp_path) == [
        "C 1 True",
        "anne=model:inspect:1,sally=search:0 True",
        "sally has 1 apple: at tick 23",
    ]


def test_the_guide_does_what_it_says(run, tmp_path):
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


def test_a_question_of_a_suite_is_a_sample_with_its_container_as_target(run, tmp_path):
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


def test_why_a_program_failed_stands_in_the_explanation_of_an_episode():
    from beliefnest.inspect.episodes import _line

    done = {"agent": "ann", "program": "x()", "ended": "failed", "reason": "line 1: no x"}
    assert _line(0, done) == "round 1, ann: x() (failed: line 1: no x)"


DOORS = """
import os
os.environ["VLLM_BASE_URL"] = URL
arguments = {"file": FILE, "world": "scripted"}
(log,) = read(eval("beliefnest/scenario", task_args=arguments, model="beliefnest/vllm:m",
                   epochs=7, max_connections=1, display="none"))
metrics = {name: each.value for found in log.results.scores for name, each in found.metrics.items()}
print("accuracy" in log.results.scores[0].metrics, round(7 * metrics["accuracy"]))
print([int(metrics[name]) for name in NAMES])
print(sorted(each.scores["in_the_belief"].metadata["outcome"] for each in log.samples))
"""


def test_answers_without_an_option_and_requests_without_an_answer_are_scored(run, tmp_path):
    file = tmp_path / "room.yaml"
    file.write_text(ROOM, encoding="utf-8")
    with serving() as server:
        server.will(*SAID.values())
        given = f"URL = {server.url!r}\nFILE = {str(file)!r}\nNAMES = {NOT_ANSWERED!r}\n"
        found = run(given + MODEL + DOORS, tmp_path)
    assert found == ["True 1", "[1, 1, 1, 1, 1]", str(sorted(SAID))]
