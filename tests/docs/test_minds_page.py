"""The page about inferring minds shows what its examples print."""

import re
from pathlib import Path

import pytest

from beliefnest.minds.mind_model import MindModel

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "minds.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(
    r"```python\n(.*?)```(?:\n\nIt prints\n\n```text\n(.*?)```)?", PAGE, re.DOTALL
)


def test_examples_print_what_the_page_says(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "examples"}
    for code, text in EXAMPLES:
        exec(compile(code, "example", "exec"), names)
        claims = re.findall(r"print\(.*\)  # (.*)", code)
        assert capsys.readouterr().out == text + "".join(f"{claim}\n" for claim in claims)
    assert [text for _, text in EXAMPLES if text], "an example shows a table of text"
    for picture in re.findall(r"\]\(img/(.*?)\)", PAGE):
        assert (tmp_path / picture).stat().st_size > 1000
        assert (DOCS / "img" / picture).exists()


def test_the_table_names_every_argument() -> None:
    rows = PAGE.partition("## The arguments of `MindModel`")[2].partition("\n## ")[0]
    told = set(re.findall(r"`(\w+)`", "".join(re.findall(r"^\|(.*?)\|", rows, re.MULTILINE))))
    assert told == {name for name, field in MindModel.__dataclass_fields__.items() if field.init}
