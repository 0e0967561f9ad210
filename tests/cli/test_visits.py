"""Beliefs that the command line lets people visit."""

import io

from beliefnest.cli.app import run_command_line


def test_a_run_can_be_visited_until_a_line_is_entered(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO("\n"))
    asked = ["run", "red-green-blue", "--condition", "1", "--realtime", "--listen", "0"]
    where = ["--embody", "/agent_1", "--embody", "/agent_1/agent_2"]
    assert run_command_line([*asked, *where, "--out", str(tmp_path / "run")]) == 0
    told = capsys.readouterr().err
    assert "to visit, join by a name that no agent has" in told
    assert "/agent_1/agent_2  2080 0 0 to 2092 3 9  /tp 2086 1 5" in told
    assert told.rstrip().endswith("beliefs can be visited until you press Enter")


def test_beliefs_that_nobody_could_visit_are_refused_at_once(tmp_path, capsys):
    asked = ["run", "red-green-blue", "--embody", "/agent_1", "--out", str(tmp_path / "run")]
    assert run_command_line(asked) == 2
    assert "--embody /agent_1: nobody can visit a belief in the world embedded" in (
        capsys.readouterr().err
    )
    assert not (tmp_path / "run").exists()
