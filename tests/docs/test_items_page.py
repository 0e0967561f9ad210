"""The page about sets of items: its code does as it says."""

import re
from pathlib import Path

import pytest
from tests.studies.items.test_items import SCENARIO

PAGE = (Path(__file__).parents[2] / "docs" / "items.md").read_text(encoding="utf-8")


@pytest.mark.extra("scipy")
def test_the_page_makes_a_set(tmp_path, monkeypatch, capsys):
    pytest.importorskip("scipy", reason="comes with the extra `stats`")
    monkeypatch.chdir(tmp_path)
    ((study,), (code,)) = (
        re.findall(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL) for kind in ("yaml", "python")
    )
    for name in ("moved", "told"):
        text = SCENARIO.replace("name: boxes", f"name: {name}")
        Path(f"{name}.yaml").write_text(text, encoding="utf-8")
    few = study.replace("variations: 100", "variations: 6").replace("[reality, first]", "[reality]")
    Path("study.yaml").write_text(few, encoding="utf-8")
    exec(compile(code, "items.md", "exec"), {"__name__": "example"})
    assert re.match(r"\d+ 0 \{'public': \d+, 'held-out': \d+\}", capsys.readouterr().out)
    files = {path.name for path in Path("items").iterdir()}
    assert files <= {
        *re.findall(r"[a-z_.A-Z]+\.(?:jsonl|json|md|py|yaml)", PAGE),
        "held-out",
        ".lock",
    }
