"""docs/models.md says what the code does."""

import re
import subprocess
import sys
from pathlib import Path

from beliefnest.llm.budget import AnswerLimits, RunLimits
from beliefnest.llm.providers import PROVIDERS
from beliefnest.llm.retrying import RetryPolicy

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "models.md").read_text(encoding="utf-8")


def test_every_provider_and_its_variables_are_named():
    for provider in PROVIDERS.values():
        (row,) = [line for line in PAGE.splitlines() if f"| `{provider.name}:MODEL` |" in line]
        for variable in (*provider.key_variables, provider.url_variable):
            assert f"`{variable}`" in row


def test_the_limits_are_those_of_the_code():
    answer, run = AnswerLimits(), RunLimits()
    assert f"{answer.first_token_seconds:g} seconds to its first token" in PAGE
    assert f"silent for {answer.seconds:g} seconds" in PAGE
    assert f"{run.tokens:,} tokens and {run.cost:g} US dollars" in PAGE
    assert f"{RetryPolicy().attempts} times in all" in PAGE


def test_the_examples_run(tmp_path):
    examples = re.findall(r"^```python\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    done = subprocess.run(
        [sys.executable, "-c", "".join(examples)],
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert 'getItemFromChest(bot, new Vec3(2, 64, 2), {"diamond": 1});' in done.stdout
    assert (tmp_path / "run" / "model.jsonl").exists()
    told = iter(done.stdout.splitlines())
    for line in re.findall(r"print\(.*\)  # (.*)", "".join(examples)):
        assert line in told
