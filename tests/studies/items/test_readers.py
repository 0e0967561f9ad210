"""A set of items in the libraries that others read it with, on stored answers."""

import json
import subprocess
import sys

import pytest
from tests.studies.items.test_items import SCENARIO, STUDY

import beliefnest as bn

CROISSANT = """
import json, sys
import mlcroissant
read = mlcroissant.Dataset("set/croissant.json").records("questions")
print(json.dumps([[each["questions/id"].decode(), each["questions/order"]] for each in read]))
"""
HUGGING_FACE = """
import json
import datasets
read = datasets.load_dataset("set")["test"]
print(json.dumps([[each["id"], each["right"], each["options"]] for each in read]))
"""
LM_EVAL = """
import json, os
os.chdir("set")
from lm_eval import simple_evaluate
from lm_eval.api.model import LM
from lm_eval.tasks import TaskManager

STORED = json.load(open("../answers.json"))

class Stored(LM):
    def loglikelihood(self, requests, disable_tqdm=False):
        asked = [request.args for request in requests]
        return [(-float(words.strip() != STORED[text]), False) for text, words in asked]

    def generate_until(self, requests, disable_tqdm=False):
        raise NotImplementedError

    loglikelihood_rolling = generate_until

own = TaskManager(include_path=".", include_defaults=False)
found = simple_evaluate(model=Stored(), tasks=["boxes"], task_manager=own, bootstrap_iters=0)
print(json.dumps(found["results"]["boxes"]))
"""
INSPECT = """
import json, os
os.chdir("set")
from inspect_ai import eval
from inspect_ai.model import ModelOutput, ModelUsage, get_model

STORED = json.load(open("../answers.json"))

def output(messages, tools, choice, config):
    text = messages[-1].text
    asked = {each.replace("Question: ", "").removesuffix("\\nAnswer:"): each for each in STORED}
    story = next(stored for each, stored in asked.items() if each in text)
    line = next(line for line in text.splitlines() if line.endswith(f") {STORED[story]}"))
    said = ModelOutput.from_content("mockllm/model", f"ANSWER: {line[0]}")
    # Else the mock model counts them with a table from the network.
    said.usage = ModelUsage(input_tokens=1, output_tokens=1, total_tokens=2)
    return said

(log,) = eval("inspect_task.py", model=get_model("mockllm/model", custom_outputs=output),
              display="none", log_dir="../logs")
assert log.status == "success", log.error
print(json.dumps({sample.id: sample.scores["choice"].value for sample in log.samples}))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Write a set, and stored answers of which every third is wrong."""
    place = tmp_path_factory.mktemp("readers")
    (place / "boxes.yaml").write_text(SCENARIO, encoding="utf-8")
    (place / "study.yaml").write_text(STUDY, encoding="utf-8")
    made = bn.Study.load(place / "study.yaml").items(name="boxes")
    made.write(place / "set")
    asked = [each for each in made.items if each.options]
    answers = {}
    for number, each in enumerate(asked):
        wrong = next(option for option in each.options if option != each.right)
        text = f"{each.text}\n\nQuestion: {each.question}\nAnswer:"
        answers[text] = wrong if number % 3 == 0 else each.right
    assert len(answers) == len(asked)
    (place / "answers.json").write_text(json.dumps(answers), encoding="utf-8")
    return place, made, asked


def printed(folder, code):
    """Return the JSON value that a program prints last, run in a folder."""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.extra("mlcroissant")
def test_croissant_describes_the_items(folder):
    place, made, _ = folder
    assert printed(place, CROISSANT) == [[each.id, each.order] for each in made.items]


@pytest.mark.extra("datasets")
def test_hugging_face_loads_the_folder(folder):
    place, made, _ = folder
    told = [[each.id, each.right, list(each.options)] for each in made.items]
    assert printed(place, HUGGING_FACE) == told


@pytest.mark.extra("lm_eval")
def test_the_evaluation_harness_scores_stored_answers(folder):
    place, _, asked = folder
    right = sum(number % 3 != 0 for number in range(len(asked)))
    assert printed(place, LM_EVAL)["acc,none"] == right / len(asked)


@pytest.mark.extra("inspect_ai")
def test_inspect_scores_stored_answers(folder):
    place, _, asked = folder
    told = {each.id: "I" if number % 3 == 0 else "C" for number, each in enumerate(asked)}
    assert printed(place, INSPECT) == told
