"""Wrong arguments and odd names: one line and status 2, and nothing reaches the terminal raw."""

import pytest

from beliefnest.cli.app import run_command_line

ODD = r"""
name: odd
description: "[/x] \e[31m \u2028"
box: [[0, 0, 0], [9, 3, 9]]
blocks: [{block: stone, fill: [[0, 0, 0], [9, 0, 9]]}]
agents: {ann: {position: [2.5, 1, 2.5]}, constructor: {position: [4.5, 1, 4.5]}}
containers: [{at: [6, 1, 6], label: "[/x]\e[31m\u2028\u202e"}]
script: [{label: "[/x]\e[31m\u2028", agent: ann, program: "bot.chat('hi')"}]
expectations: [{path: /ann, label: "[/x]\e[31m", container: [6, 1, 6], items: {}}]
"""


@pytest.mark.parametrize(
    "arguments", [["run", ""], ["run", "sally-anne", "--seed", str(2**80)], ["show", "a\0b"]]
)
def test_wrong_arguments_are_one_line(capsys, arguments):
    assert run_command_line(arguments) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_names_of_others_are_no_markup_and_command_no_terminal(tmp_path, capsys):
    (tmp_path / "odd.yaml").write_text(ODD, encoding="utf-8")
    run = str(tmp_path / "run")
    assert run_command_line(["run", str(tmp_path / "odd.yaml"), "--out", run]) in (0, 1)
    assert run_command_line(["show", run]) == 0
    told = "".join(capsys.readouterr())
    assert "[/x]" in told
    assert not set("\x1b\u2028\u202e") & set(told)
