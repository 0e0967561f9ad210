"""The page about claims shows what its example prints."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "claims.md").read_text(encoding="utf-8")


def test_the_example_prints_what_the_page_says(capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    (shown,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(example, "example", "exec"), {"__name__": "example"})
    printed = re.findall(r"print\(.*\)  # (.*)", example)
    assert capsys.readouterr().out == "".join(f"{line}\n" for line in printed) + shown
