"""The page about episodes shows what its examples print, and the page of tasks what there is."""

import re
from pathlib import Path

import pytest
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.episodes.tasks import parameters_of, source_of

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "episodes.md").read_text(encoding="utf-8")


EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
"""The last one is a study, whose numbers tests of tasks and of studies hold too."""


@pytest.mark.parametrize("example", few_by_day(EXAMPLES, len(EXAMPLES) - 1))
def test_the_examples_print_what_the_page_says(
    example: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("nothing.txt").write_text("", encoding="utf-8")
    exec(compile(example, "example", "exec"), {"__name__": "example"})
    printed = re.findall(r"print\(.*\)  # (.*)", example)
    assert capsys.readouterr().out == "".join(f"{line}\n" for line in printed)


def test_the_task_of_the_page_is_played(tmp_path: Path) -> None:
    text, *_ = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    file = tmp_path / "carry.yaml"
    file.write_text(text, encoding="utf-8")
    with bn.Episode(bn.Task.load(str(file)), {"ann": "search:1"}) as episode:
        assert episode.play().success
        assert all(tick is not None for _, tick in episode.conditions)


def test_the_page_of_tasks_tells_of_all_of_them() -> None:
    page = (DOCS / "tasks.md").read_text(encoding="utf-8")
    first, *sections = re.findall(r"^## (.*)$", page, re.MULTILINE)
    assert first == "Rules without beliefs"
    assert sections == list(bn.Task.names())
    for name in bn.Task.names():
        assert source_of(name).partition("\n\n")[2] in page
        assert all(f"`{key}`" in page for key in parameters_of(name))
        assert (DOCS / "img" / f"task-{name}.png").is_file()
        task = bn.Task.load(name)
        kind = "search" if task.form.goals_known else "infer"
        for policy in (f"{kind}:{task.order}", f"search:{task.order - 1}"):
            assert re.search(rf"^\| {name} \| \d \| {policy} \| \d+/\d+ ", page, re.MULTILINE)
