"""The examples of the page about looking write the files they name and print what they say."""

import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.usefixtures("kept_worlds")

PAGE = (Path(__file__).parents[2] / "docs" / "looking.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def test_the_examples_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "example"}
    for example in EXAMPLES:
        exec(compile(example, "example", "exec"), names)
        for file in re.findall(r'save\("([^"]+)"', example):
            assert Path(file).stat().st_size > 1000
        claims = re.findall(r"print\(.*\)  # (.*)", example)
        assert capsys.readouterr().out.splitlines() == claims


def test_its_pictures_are_there() -> None:
    for target in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", PAGE):
        assert (Path(__file__).parents[2] / "docs" / target).is_file(), target
