"""The paper's experiments beside its claims, and where we differ."""

import json
from pathlib import Path

from beliefnest.cli.app import run_command_line


def test_the_papers_claims_hold_as_written_and_in_a_copy(tmp_path, capsys):
    page = tmp_path / "page.md"
    assert run_command_line(["reproduce", "--copies", "1", "--page", str(page), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["right"] == found["rows"] == 24
    reported = [each for each in found["claims"] if not each["is_control"]]
    claims = {(each["scenario"], each["condition"], each["probe"]): each for each in reported}
    others = [True, True]  # Mary, in the observer's belief and herself.
    assert [each["as_the_paper"] for each in claims.values()] == [True, True, True, False, *others]
    assert len(found["claims"]) * 2 == found["rows"]
    assert claims["sally-anne", 2, "prediction"]["result"] == "sally opens 2,-51,-4"
    assert all(each["copies_ok"] == each["copies"] == 1 for each in found["claims"])
    assert "does not know" in claims["ice-cream-van", 1, "third order"]["differs"]
    controls = [each for each in found["claims"] if each["is_control"]]
    assert {each["condition"] for each in controls} == {2, 3}
    places = {(each["condition"], each["path"]): each["expected"] for each in controls}
    (to_a, to_b) = ("arrives 4.5,1,4.5, within 3", "arrives 20.5,1,16.5, within 3")
    for path in ("/observer/john/mary", "/observer/mary", "/mary"):
        assert (places[2, path], places[3, path]) == (to_b, to_a)
    assert page.read_text().count("\n| Example") == 12
    kept = Path(__file__).parents[2] / "docs" / "reproduction.md"
    assert claimed(page) == claimed(kept), "write it anew with `beliefnest reproduce --page`"


def claimed(page):
    """Its table, without how many copies there were and how long each took."""
    lines = page.read_text(encoding="utf-8").splitlines()
    rows = [line.split(" | ") for line in lines if line.startswith("| ")]
    return [[*row[:5], *row[7:]] for row in rows]
