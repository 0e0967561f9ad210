"""The page about claims shows what its examples print."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "claims.md").read_text(encoding="utf-8")


def test_the_examples_print_what_the_page_says(capsys: pytest.CaptureFixture[str]) -> None:
    told, signed, read = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    (shown,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    for example, more in ((told, shown), (signed, ""), (read, "")):
        exec(compile(example, "example", "exec"), {"__name__": "example"})
        printed = re.findall(r"print\(.*\)  # (.*)", example)
        assert capsys.readouterr().out == "".join(f"{line}\n" for line in printed) + more
