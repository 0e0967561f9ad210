"""The example that trains an agent, and the page about it (train.md), at a small scale."""

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

pytest.importorskip("stable_baselines3", reason="it is large, and tested at night")
pytestmark = pytest.mark.extra("stable_baselines3", "sb3_contrib", "matplotlib")

ROOT = Path(__file__).parents[2]
FILE = ROOT / "examples" / "train_an_agent.py"


@pytest.fixture
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("train_an_agent", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["lost-diamond", "joint-lift"])
def test_a_few_updates_give_a_table_and_a_figure(
    name: str,
    example: ModuleType,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    for constant, value in {"EPISODES": 64, "INSTANCES": 8, "SEEDS": (1,)}.items():
        monkeypatch.setattr(example, constant, value)
    example.main(name)
    (_, *rows) = capsys.readouterr().out.splitlines()
    means = {row[:16].strip(): float(row[16:].split()[0]) for row in rows}
    assert list(means) == [*example.POLICIES, "learned without", "learned with"]
    assert all(0 <= mean <= 1 for mean in means.values())
    assert means["search:0"] < means["search:1"] == 1
    assert "</svg>" in Path(f"train-{name}.svg").read_text(encoding="utf-8")


def test_the_learner_of_the_page_gives_back_the_diamond(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (code,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs" / "train.md").read_text(encoding="utf-8"), re.DOTALL
    )
    monkeypatch.chdir(ROOT)
    exec(code, {"__name__": "train"})
    assert float(capsys.readouterr().out) > 0.9
