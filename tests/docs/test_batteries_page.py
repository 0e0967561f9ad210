"""The page of the field's tasks: its stories are answered, its scenarios are there."""

import re
from pathlib import Path

from beliefnest.cli.app import run_command_line
from beliefnest.scenarios.sources import builtin_names

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "batteries.md").read_text(encoding="utf-8")


def test_the_stories_of_the_page_are_answered_as_they_say(tmp_path: Path) -> None:
    (stories,) = re.findall(r'```json\n(\{"name.*?)```', PAGE, re.DOTALL)
    path = tmp_path / "stories.jsonl"
    path.write_text(stories, encoding="utf-8")
    assert run_command_line(["suite", "stories", "--data", str(path)]) == 0


def test_every_task_that_has_a_page_is_built_in() -> None:
    pages = sorted(path.stem for path in (DOCS / "tasks").glob("*.md"))
    assert len(pages) == 7
    assert set(pages) <= set(builtin_names())
    for page in pages:
        assert f"tasks/{page}.md" in PAGE
        text = (DOCS / "tasks" / f"{page}.md").read_text(encoding="utf-8")
        assert "**Found in people.**" in text
        assert (DOCS / "img" / f"{page}.png").is_file()
