"""The page about timelines does what it says, one example after the other in one folder."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "timelines.md").read_text(encoding="utf-8")


def test_examples_print_what_the_page_says(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for example in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(compile(example, "example", "exec"), {"__name__": "example"})
        printed = capsys.readouterr().out.splitlines()
        claims = re.findall(r"print\(.*\)  # (.*)", example)
        assert [line for line in printed if line in claims] == claims
