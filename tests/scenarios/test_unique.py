"""The key `unique` of scenario files."""

from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.errors import ScenarioError

TEXT = """\
name: one
box: [[0, 0, 0], [8, 4, 8]]
containers:
  - {at: [4, 1, 4], items: {diamond: 1}}
  - {at: [6, 1, 4]}
agents:
  ann: {position: [2.5, 1, 2.5]}
  bob: {position: [6.5, 1, 6.5]}
unique:
  - gold_ingot
  - minecraft:diamond
"""


def load(folder: Path, text: str) -> bn.Scenario:
    file = folder / "one.yaml"
    file.write_text(text, encoding="utf-8")
    return bn.Scenario.load(str(file))


def test_a_scenario_lists_unique_items(tmp_path: Path) -> None:
    assert load(tmp_path, TEXT).setting.unique == {"diamond", "gold_ingot"}


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (("minecraft:diamond", "diamnd"), r"one.yaml:11: unique\[1\].*diamnd.*diamond"),
        (("{at: [6, 1, 4]}", "{at: [6, 1, 4], items: {diamond: 2}}"), r":11: .*'diamond' is"),
        (
            ("unique:", "initial_beliefs:\n  - path: /ann/**\n    containers:\n"
             "      - {at: [4, 1, 4], items: {diamond: 1}}\n"
             "      - {at: [6, 1, 4], items: {diamond: 1}}\nunique:"),
            r"one.yaml:16: unique\[1\]: 'diamond' is unique, but initial_beliefs give '/ann/\*\*'",
        ),
    ],
)  # fmt: skip
def test_what_contradicts_it_is_named_with_its_line(
    tmp_path: Path, change: tuple[str, str], fault: str
) -> None:
    with pytest.raises(ScenarioError, match=fault):
        load(tmp_path, TEXT.replace(*change))
