"""Reading a recorded run: any simulator, branch and tick; prompts; pictures."""

import json
from pathlib import Path

import pytest
from PIL import Image

import beliefnest as bn
from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "run"
    assert run_command_line(["run", "sally-anne", "--condition", "3", "--out", str(folder)]) == 0
    return folder


def shown(run: Path, capsys: pytest.CaptureFixture[str], *options: str) -> dict[str, object]:
    assert run_command_line(["show", str(run), "--json", *options]) == 0
    state = json.loads(capsys.readouterr().out)
    assert isinstance(state, dict)
    return state


@pytest.mark.parametrize("path", ["/observer", "/sally", "/observer/sally"])
def test_a_recorded_belief_is_what_it_was_live(
    run: Path, path: str, capsys: pytest.CaptureFixture[str]
) -> None:
    live = json.loads((run / "run.json").read_text())["runs"][0]["beliefs"][path]
    recorded = shown(run, capsys, "--path", path)
    assert {key: recorded[key] for key in live} == live


def test_a_deeper_belief_than_was_asked_for_live_is_there(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert shown(run, capsys, "--path", "/sally/anne/observer")["path"] == "/sally/anne/observer"


def test_the_past_is_shown_as_it_was(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = shown(run, capsys, "--tick", "0")
    assert first["containers"] == {
        "-2,-51,-4": {"items": {}, "complete": True},
        "2,-51,-4": {"items": {}, "complete": True},
    }


def test_the_branch_of_a_probe_is_shown(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    follow = shown(run, capsys, "--path", "/observer")
    probe = shown(run, capsys, "--path", "/observer", "--branch", "probe 1")
    assert isinstance(follow["tick"], int)
    assert isinstance(probe["tick"], int)
    assert probe["tick"] > follow["tick"]


def test_what_ran_in_a_simulator_is_told(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert shown(run, capsys, "--path", "/observer")["programs"] == []
    programs = shown(run, capsys, "--path", "/observer", "--branch", "probe 1")["programs"]
    assert isinstance(programs, list)
    (program,) = programs
    assert (program["agent"], program["ok"], program["unfinished"]) == ("sally", False, [])
    assert "diamond" in program["error"]
    assert program["lines"][0] == 1
    assert run_command_line(["show", str(run)]) == 0
    assert "ticks 54 to 108: program of anne: ended well" in capsys.readouterr().out


def test_a_table_names_the_containers(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["show", str(run), "--path", "/observer/sally"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any("left chest" in line and "1 diamond" in line for line in lines)
    (closed,) = (line for line in lines if "right chest" in line)
    assert closed.split() == ["right", "chest", "-", "not", "known"]


def test_a_picture_of_a_belief_and_not_of_the_world(run: Path, tmp_path: Path) -> None:
    drawn = []
    for number, options in enumerate(([], ["--tick", "30"], ["--against", "/observer/sally"])):
        file = tmp_path / f"{number}.svg"
        asked = ["show", str(run), "--path", "/observer/sally", "--svg", str(file)]
        assert run_command_line([*asked, *options]) == 0
        drawn.append(file.read_text())
    assert all("/observer/sally" in text for text in drawn)
    assert "in reality: empty" in drawn[0]
    assert "tick 30" in drawn[1]
    assert "in reality" not in drawn[2]


def test_pictures_in_several_forms_at_once(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    png, pdf = tmp_path / "f.png", tmp_path / "f.pdf"
    assert run_command_line(["show", str(run), "--png", str(png), "--pdf", str(pdf)]) == 0
    assert capsys.readouterr().out.split() == ["written", "to", str(png), "written", "to", str(pdf)]
    assert pdf.read_bytes().startswith(b"%PDF")
    with Image.open(png) as picture:
        assert picture.width == pytest.approx(84 / 25.4 * 200, abs=1)


@pytest.mark.parametrize("ending", ["gif", "webp"])
def test_an_animation_moves(run: Path, tmp_path: Path, ending: str) -> None:
    file = tmp_path / f"f.{ending}"
    asked = ["show", str(run), "--path", "/sally", "--tick", "12", "--gif", str(file)]
    assert run_command_line(asked) == 0
    with Image.open(file) as picture:
        assert picture.n_frames > 3


def test_the_prompt_of_the_probe_is_rendered_again(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = (run / "condition-3" / "probe-1" / "prompt.txt").read_text()
    task = "task=Get a diamond from a chest."
    assert run_command_line(["prompt", str(run), "--path", "/observer/sally", "--var", task]) == 0
    assert capsys.readouterr().out.strip() == asked.strip()


def test_built_in_templates_go_by_their_names(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ["prompt", str(run), "--path", "/observer/sally", "--var", "task=Get a diamond."]
    assert run_command_line(given) == 0
    paper = capsys.readouterr().out
    assert run_command_line([*given, "--template", "paper"]) == 0
    assert capsys.readouterr().out == paper
    assert run_command_line([*given, "--template", "default"]) == 0
    assert "You are sally." in capsys.readouterr().out != paper


def test_claims_on_a_branch_of_a_belief_are_shown_with_the_branch(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "c.bn"
    agents = {"ann": (5.5, 0, 5.5), "bob": (6.5, 0, 5.5)}
    world = bn.ScriptedWorld(((0, 0, 0), (9, 3, 9)), agents=agents, containers={(3, 0, 3): {}})
    with bn.Nest(world, bn.Perception(testimony="accept"), store=file) as nest:
        claims = [bn.Claim.located("diamond", (3, 0, 3))]
        for path in ("/", "/bob"):
            if path != "/":
                nest[path].switch("what if")
            nest[path].scripted.say("ann", f"said in {path}", claims=claims)
    for path, heading in (("/ann", "in /ann"), ("/bob", "heard by"), ("/bob/ann", "in /bob/ann")):
        assert run_command_line(["show", str(file), "--path", path]) == 0
        claims_told = capsys.readouterr().out.partition("Claims")[2]
        assert "located" in claims_told or "diamond" in claims_told
        assert heading in claims_told and "in /bob " not in claims_told


@pytest.fixture(scope="module")
def talk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ann has looked into the chest; Bob, who is far away, is told of a diamond by her."""
    file = tmp_path_factory.mktemp("talk") / "talk.bn"
    agents = {"ann": (2.5, 0, 3.5), "bob": (28.5, 0, 3.5)}
    world = bn.ScriptedWorld(((0, 0, 0), (30, 3, 9)), agents=agents, containers={(1, 0, 1): {}})
    perception = bn.Perception(max_visible_distance=12, testimony="informed", grace=5)
    with bn.Nest(world, perception, store=file):
        world.open("ann", (1, 0, 1))
        world.step(20)
        world.say("ann", "Look!", claims=[bn.Claim.located("diamond", (1, 0, 1))])
    return file


def test_claims_are_shown_for_every_belief(talk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["show", str(talk), "--claims", "--depth", "1"]) == 0
    heading, _, row = capsys.readouterr().out.strip().splitlines()[-3:]
    assert heading.split()[-2:] == ["/ann", "/bob"]
    assert " ".join(row.split()) == "22 ann diamond is in (1, 0, 1) a lie no (4) yes"
    assert run_command_line(["show", str(talk), "--claims", "--json"]) == 0
    (told,) = json.loads(capsys.readouterr().out)
    assert list(told["beliefs"]) == ["/ann", "/bob", "/ann/bob", "/bob/ann"]
    assert told["beliefs"]["/bob/ann"]["taken_up"]
    assert shown(talk, capsys, "--path", "/bob")["claims"] == [
        told | {"beliefs": {"/bob": told["beliefs"]["/bob"]}}
    ]


@pytest.mark.parametrize("width", ["80", "30"])
def test_claims_are_readable_where_a_column_for_each_belief_has_no_room(
    width: str, talk: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", width)
    depth = "3" if width == "30" else "6"
    assert run_command_line(["show", str(talk), "--claims", "--depth", depth]) == 0
    printed = capsys.readouterr().out
    lines = printed.splitlines()
    assert " ".join(printed.split()).startswith("tick 22, ann: diamond is in (1, 0, 1) (a lie)")
    assert max(map(len, lines)) <= int(width)
    # No path is broken, and none is missing.
    words = {word.strip(",") for word in printed.split() if word.startswith("/")}
    assert {"/ann", "/bob", "/ann/bob", "/ann/bob/ann"} <= words
    assert all(word.strip("/").replace("/", "").isalpha() for word in words)
    if width == "80":
        assert "not taken up (4) /ann" in " ".join(printed.split())


def test_a_table_says_how_things_are_known(talk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["show", str(talk), "--path", "/bob", "--tick", "22"]) == 0
    assert "heard from ann 0 s ago" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (["show", "RUN", "--path", "/bob"], "bob"),
        (["show", "RUN", "--tick", "9999"], "future"),
        (["show", "RUN", "--path", "/observer", "--branch", "nothing"], "probe 1"),
        (["show", "nowhere"], "no run at"),
        (["show", "RUN", "--png", "nowhere/then.png"], "nowhere/then.png cannot be written"),
        (["show", "RUN", "--png", "then.jpeg"], "must end in .png"),
        (["show", "RUN", "--gif", "then.png"], ".gif, .webp"),
        (["show", "RUN", "--png", "then.png", "--height", "900"], "outside the box"),
        (["prompt", "RUN", "--path", "/sally"], "task"),
        (["prompt", "RUN", "--path", "/sally", "--var", "task"], "key=value"),
        (["prompt", "RUN", "--path", "/sally", "--template", "question"], "with --var NAME=TEXT"),
        (["prompt", "RUN", "--path", "/sally", "--template", "defaul"], "instructions, paper"),
    ],
)
def test_wrong_questions_are_one_line_and_2(
    run: Path, arguments: list[str], hint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command_line([str(run) if each == "RUN" else each for each in arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert hint in line


def test_of_several_conditions_all_have_the_tick_or_nothing_is_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "run"
    command = ["run", "sally-anne", "--condition", "1", "--condition", "3", "--world", "scripted"]
    assert run_command_line([*command, "--out", str(folder)]) == 0
    capsys.readouterr()
    heads = {}
    for name in ("condition-1", "condition-3"):
        heads[shown(folder / name, capsys)["tick"]] = name
    low, high = sorted(heads)
    assert run_command_line(["show", str(folder), "--tick", str(low)]) == 0
    assert capsys.readouterr().out.count(f"/ at tick {low}") == 2
    png = tmp_path / "f.png"
    for more in ([], ["--png", str(png)]):
        assert run_command_line(["show", str(folder), "--tick", str(high), *more]) == 2
        told = capsys.readouterr()
        assert told.out == ""
        assert f"in {heads[low].replace('-', ' ')}: tick {high}" in told.err
    assert not png.exists()


def test_a_page_is_refused_where_it_would_not_show_what_is_asked_for(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.html"
    for options, told in (
        (["--html", str(tmp_path / "page.pdf")], "must end in .html"),
        (["--html", str(page), "--tick", "99999"], "is in the future"),
        (["--html", str(page), "--branch", "probe 1"], "leave --branch out"),
    ):
        assert run_command_line(["show", str(run), *options]) == 2
        assert told in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_page_and_a_figure_are_written_by_one_command(run: Path, tmp_path: Path) -> None:
    page, figure = tmp_path / "page.html", tmp_path / "figure.png"
    assert run_command_line(["show", str(run), "--html", str(page), "--png", str(figure)]) == 0
    assert page.is_file()
    assert figure.is_file()
