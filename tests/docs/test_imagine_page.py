"""The examples of the page about imagining print what it says."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "imagine.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def test_examples_print_what_the_page_says(capsys: pytest.CaptureFixture[str]) -> None:
    whole = "\n".join(EXAMPLES)
    exec(compile(whole, "example", "exec"), {"__name__": "example"})
    claims = re.findall(r"print\(.*\)  # (.*)", whole)
    assert capsys.readouterr().out == "".join(f"{claim}\n" for claim in claims)
