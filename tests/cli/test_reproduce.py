"""The paper's experiments beside its claims, and where we differ."""

import json

from beliefnest.cli.app import run_command_line


def test_the_papers_claims_hold_as_written_and_in_a_copy(tmp_path, capsys):
    page = tmp_path / "page.md"
    assert run_command_line(["reproduce", "--copies", "1", "--page", str(page), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["right"] == found["rows"] == 24
    claims = {(each["scenario"], each["condition"]): each for each in found["claims"]}
    assert [each["as_the_paper"] for each in claims.values()] == [True, True, True, False]
    assert claims["sally-anne", 2]["result"] == "sally opens 2,-51,-4"
    assert all(each["copies_ok"] == each["copies"] == 1 for each in claims.values())
    assert "does not know" in claims["ice-cream-van", 1]["differs"]
    assert page.read_text().count("\n| Example") == 4
