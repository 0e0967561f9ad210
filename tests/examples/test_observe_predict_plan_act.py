"""The loop of the example: it is short, it works, and it acts only on what worked in belief."""

import importlib.util
import re
import subprocess
import sys
from collections import deque
from pathlib import Path
from types import ModuleType

import pytest

from beliefnest.llm.offline import OfflineModel
from beliefnest.llm.recorded_models import ScriptedModel
from beliefnest.timeline.store import Journal

ROOT = Path(__file__).parents[2]
FILE = ROOT / "examples" / "observe_predict_plan_act.py"
IDLE = "```javascript\nawait doNothing(bot);\n```"


@pytest.fixture(scope="module")
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("observe_predict_plan_act", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_it_is_shorter_than_100_lines() -> None:
    assert len(FILE.read_text(encoding="utf-8").splitlines()) < 100


def test_it_prints_what_the_docs_say() -> None:
    guide = (ROOT / "docs" / "help-sally.md").read_text(encoding="utf-8")
    (said,) = re.findall(r"\$ python examples/.*\n((?:.+\n)+?)```", guide)
    ended = subprocess.run([sys.executable, str(FILE)], capture_output=True, text=True, check=True)
    assert ended.stdout == said


def test_anne_foresees_the_failure_and_helps(example: ModuleType, tmp_path: Path) -> None:
    store = tmp_path / "run.bn"
    (only,) = example.play(OfflineModel(), str(store))
    assert not only.sally_would_succeed
    assert "Vec3(-2, -51, -4)" in only.predicted
    assert "giveItemToOther" in only.planned
    assert only.would_help
    assert only.helped
    with Journal.read(store) as journal:
        branches = {(info.key.path, info.key.branch) for info in journal.timelines()}
    assert branches == {((), "main"), (("anne",), "prediction 1"), (("anne",), "plan 1")}


def test_a_plan_that_does_not_work_in_belief_is_not_acted_on(example: ModuleType) -> None:
    rounds = example.play(ScriptedModel("scripted", deque([IDLE] * 2 * example.ROUNDS)))
    assert len(rounds) == example.ROUNDS
    assert not any(each.would_help or each.helped for each in rounds)
