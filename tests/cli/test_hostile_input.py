"""Wrong arguments and odd names: one line and status 2, and nothing reaches the terminal raw."""

import pytest

from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")

ODD = r"""
name: odd
description: "[/x] \e[31m \u2028"
box: [[0, 0, 0], [9, 3, 9]]
blocks: [{block: stone, fill: [[0, 0, 0], [9, 0, 9]]}]
agents: {ann: {position: [2.5, 1, 2.5]}, constructor: {position: [4.5, 1, 4.5]}}
containers: [{at: [6, 1, 6], label: "[/x]\e[31m\u2028\u202e"}]
places: {"[/x]\e[31m\u2028\u202e": [2, 1, 2]}
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
    drawn = tmp_path / "odd.svg"
    assert run_command_line(["show", run, "--svg", str(drawn)]) == 0
    for text in ("".join(capsys.readouterr()), drawn.read_text(encoding="utf-8")):
        assert "[/x]" in text
        assert not set("\x1b\u2028\u202e") & set(text)


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--max-tokens", "-1"),
        ("--max-cost", "nan"),
        ("--max-cost", "-0.1"),
        ("--temperature", "nan"),
        ("--temperature", "inf"),
        ("--temperature", "-1"),
        ("--repeat", "0"),
        ("--repeat", str(10**9)),
        ("--attempts", "0"),
        ("--attempts", str(10**9)),
        ("--seed", str(2**63)),
        ("--seed", "-1"),
    ],
)
def test_numbers_that_cannot_be_are_refused_by_the_name_of_their_option(
    capsys, tmp_path, monkeypatch, option, value
):
    monkeypatch.chdir(tmp_path)
    assert run_command_line(["run", "sally-anne", option, value]) == 2
    assert option in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
