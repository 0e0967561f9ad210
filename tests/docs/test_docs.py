"""README and docs: their code works, and their pictures are the program's own."""

import re
from pathlib import Path

import pytest
import yaml

from beliefnest import Nest
from beliefnest.cli.app import run_command_line
from beliefnest.scenarios.probing import resolved
from beliefnest.scenarios.scenario import Scenario

pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOT = Path(__file__).parents[2]
PAPERS = ("README.md", "docs/scenarios.md")
EXAMPLES = [
    pytest.param(code, id=f"{paper}-{number}")
    for paper in PAPERS
    for number, code in enumerate(
        re.findall(r"```python\n(.*?)```", (ROOT / paper).read_text(encoding="utf-8"), re.DOTALL)
    )
]


@pytest.mark.parametrize("code", EXAMPLES)
def test_python_examples_run_and_print_what_they_say(
    code: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "example", "exec"), {"__name__": "example"})
    printed = capsys.readouterr().out.splitlines()
    for claim in re.findall(r"print\(.*\)  # (.*)", code):
        assert claim in printed


def test_the_scenario_of_the_guide_does_as_it_expects(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    guide = (ROOT / "docs" / "scenarios.md").read_text(encoding="utf-8")
    text, drawn, beliefs, computed, _ = re.findall(r"```yaml\n(.*?)```", guide, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    Path("boxes.yaml").write_text(text, encoding="utf-8")
    assert run_command_line(["run", "boxes.yaml", "--out", "run"]) == 0
    assert {scenario.condition for scenario in Scenario.load_all("boxes.yaml")} == {1, 2}
    with Nest.open(
        Scenario.from_mapping(yaml.safe_load(text + beliefs), condition=1), world="scripted"
    ) as nest:
        known = {path: nest[path].state.containers for path in ("/ann/bob", "/bob/ann")}
    assert known["/ann/bob"][4, 1, 2].items == {"apple": 3}
    assert known["/bob/ann"][2, 1, 2].complete
    probe = {"path": "/ann", **yaml.safe_load(computed)}
    asking = Scenario.from_mapping({**yaml.safe_load(text), "probes": [probe]}, condition=1)
    with Nest.open(asking, world="scripted") as nest:
        nest.play()
        (question,) = resolved(nest, asking.probes[0]).questions
    assert question.right == ("he does not know",)
    shut, opened = (
        Scenario.from_mapping(yaml.safe_load(drawn), condition=number) for number in (1, 2)
    )
    assert shut.setting.snapshot.containers == {(1, 1, 1): {"diamond": 1}}
    for scenario, sees in ((shut, False), (opened, True)):
        with Nest.open(scenario, world="scripted") as nest:
            assert nest["/ann"].state.agents["bob"].current == sees


def test_the_readme_begins_with_the_two_commands() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    first, second = re.findall(r"```bash\n(.*?)\n```", readme, re.DOTALL)[:2]
    assert first.endswith("pip install . && beliefnest run sally-anne")
    assert second == 'pip install -e ".[dev]" && pytest'


@pytest.mark.parametrize("paper", [*PAPERS, "CONTRIBUTING.md"])
def test_links_between_papers_lead_somewhere(paper: str) -> None:
    file = ROOT / paper
    for target in re.findall(r"\]\(([^)#]+)\)", file.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (file.parent / target).exists(), target


def test_the_first_page_leads_to_every_other_page() -> None:
    folder = ROOT / "docs"
    first = (folder / "index.md").read_text("utf-8")
    pages = {file.name for file in folder.glob("*.md")} - {"index.md"}
    assert {name for name in pages if f"]({name})" not in first} == set()
