"""The page about explanations shows what its examples print."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "explain.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
(SHOWN,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize(("example", "text"), list(zip(EXAMPLES, [SHOWN, ""], strict=True)))
def test_examples_print_what_the_page_says(
    example: str, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    exec(compile(example, "example", "exec"), {"__name__": "example"})
    printed = capsys.readouterr().out
    claims = re.findall(r"print\(.*\)  # (.*)", example)
    assert printed == text + "".join(f"{claim}\n" for claim in claims)
