"""Pages do what they say, their examples one after the other."""

import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.usefixtures("kept_worlds")

DOCS = Path(__file__).parents[2] / "docs"
PAGES = (
    "coming-from-mineflayer.md",
    "filters.md",
    "large-worlds.md",
    "programs.md",
    "python.md",
    "scripted-world.md",
    "timelines.md",
)


@pytest.mark.parametrize("page", PAGES)
def test_examples_print_what_the_page_says(
    page: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    text = (DOCS / page).read_text(encoding="utf-8")
    for example in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
        exec(compile(example, page, "exec"), {"__name__": "example"})
        printed = capsys.readouterr().out.splitlines()
        claims = re.findall(r"print\(.*\)  # (.*)", example)
        assert [line for line in printed if line in claims] == claims
