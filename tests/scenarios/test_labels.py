"""Labels in prompts: what a container is called, and what it looks as if it held."""

from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.prompts import built_in_template

SMARTIES = """
name: smarties
box: [[0, 0, 0], [8, 3, 8]]
blocks: [{{block: stone, fill: [[0, 0, 0], [8, 0, 8]]}}]
labels: {labels}
containers:
  - {{at: [2, 1, 2], label: the Smarties tube, looks: candy, items: {{stick: 1}}}}
agents:
  ann: {{position: [3.5, 1, 4.5]}}
  bob: {{position: [5.5, 1, 4.5]}}
static_blocks: [stone, [2, 1, 2]]
initial_beliefs:
  - {{path: "/**", containers: [{{at: [2, 1, 2], items: {{cookie: 1}}}}]}}
"""


def opened(folder: Path, labels: str) -> bn.Nest:
    file = folder / "smarties.yaml"
    file.write_text(SMARTIES.format(labels=labels))
    return bn.Nest.open(bn.Scenario.load(str(file)), world="scripted", store=folder / "run.bn")


def test_prompts_say_what_a_container_looks_like_if_the_scenario_lets_them(tmp_path: Path) -> None:
    with opened(tmp_path, "true") as nest:
        prompt = nest["/ann/bob"].render(built_in_template("default"), task="Find candy.")
        labels = nest["/ann/bob"].labels
    assert (
        "(2, 1, 2) chest (the Smarties tube, looks as if it held candy): known, {'cookie': 1}; "
        "believed from the start" in prompt
    )
    with bn.Nest.read(tmp_path / "run.bn") as recorded:
        assert recorded["/ann/bob"].labels == labels != {}


def test_prompts_say_no_labels_otherwise(tmp_path: Path) -> None:
    with opened(tmp_path, "false") as nest:
        assert "Smarties" not in nest["/ann"].render(built_in_template("default"), task="x")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[2, 1, 2]]", "[2, 1, 99]]", "outside the box"),
        ('"/**"', '"/ann/**/bob"', "may only stand at its end, once"),
        ('"/**"', '"/zed/**"', "agents are ann, bob"),
    ],
)
def test_what_is_nowhere_or_nobody_is_refused(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    file = tmp_path / "smarties.yaml"
    file.write_text(SMARTIES.format(labels="true").replace(old, new))
    with pytest.raises(bn.ScenarioError, match=message):
        bn.Scenario.load(str(file))
