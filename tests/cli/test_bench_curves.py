"""Curves of `beliefnest bench growth --curves`: their points, files and drawings."""

import csv
import itertools
import os
from pathlib import Path

import pytest
from msgspec.structs import replace

from beliefnest.cli.app import run_command_line
from beliefnest_benchmarks.curve_files import drawn, save_curve
from beliefnest_benchmarks.curves import CURVES, Aim, Curve, Point, Series, measured_points

NAMES = ("in memory", "in a run file", "elsewhere")
CURVE = Curve(
    "small",
    "Small boxes",
    "edge, blocks",
    "tick, ms",
    "memory, MB",
    [Series(name, []) for name in NAMES],
    [
        Aim("ms", "twice the first", 2.0, of_first="in memory"),
        Aim("mb", "at 20: 300 MB", 300.0, at=20),
    ],
)
POINTS = [
    Point(name, x, 0.5 * x + number / 50, 150 + x)
    for number, name in enumerate(NAMES)
    for x in (10, 20, 40)
]


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        ([], "no bench is named"),
        (["size"], "not of size"),
        (["growth", "size"], "not of growth, size"),
        (["nothing"], "there is no bench 'nothing'"),
    ],
)
def test_only_growth_has_curves(
    capsys: pytest.CaptureFixture[str], arguments: list[str], hint: str
) -> None:
    assert run_command_line(["bench", *arguments, "--curves", "curves"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert hint in line
    assert not Path("curves").exists()


@pytest.mark.parametrize("place", ["file", "file/below"])
@pytest.mark.extra("matplotlib")
def test_a_file_is_no_folder_for_curves(capsys: pytest.CaptureFixture[str], place: str) -> None:
    Path("file").write_text("mine")
    assert run_command_line(["bench", "growth", "--curves", place]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "file is no folder; name another folder" in line
    assert Path("file").read_text() == "mine"


@pytest.mark.extra("matplotlib")
def test_a_file_that_cannot_be_written_is_named() -> None:
    Path("small.svg").mkdir()
    with pytest.raises(Exception, match=r"--curves: .*small\.svg cannot be written"):
        save_curve(CURVE, POINTS, Path())


@pytest.mark.extra("matplotlib")
def test_a_curve_is_written_as_a_table_and_a_picture_with_its_aims() -> None:
    table, picture = save_curve(CURVE, POINTS, Path())
    with table.open(newline="") as opened:
        rows = list(csv.reader(opened))
    assert rows[:2] == [
        ["series", "edge, blocks", "tick, ms", "memory, MB"],
        ["in memory", "10", "5", "160"],
    ]
    assert len(rows) == 1 + len(POINTS)
    drawing = picture.read_text()
    for text in ("Small boxes", "edge, blocks", "tick, ms", "memory, MB", *NAMES):
        assert text in drawing
    assert "aim: twice the first" in drawing
    save_curve(CURVE, POINTS, Path())
    assert picture.read_text() == drawing


@pytest.mark.extra("matplotlib")
@pytest.mark.parametrize("log", ["", "y", "xy"])
def test_names_of_lines_have_room_and_aims_are_inside(log: str) -> None:
    figure = drawn(replace(CURVE, log=log), POINTS)
    figure.draw_without_rendering()
    for axes, limit in zip(figure.axes, (10.0, 300.0), strict=True):
        low, high = axes.get_ylim()
        assert low < limit < high
        ends = [text for text in axes.texts if text.get_text() in NAMES]
        boxes = sorted((text.get_window_extent() for text in ends), key=lambda box: box.y0)
        assert len(boxes) == len(NAMES)
        assert all(one.y1 <= other.y0 + 1 for one, other in itertools.pairwise(boxes))
        assert all(box.x1 <= figure.bbox.x1 + 1 for box in boxes)


def test_every_aim_of_a_first_point_names_a_series() -> None:
    for curve in CURVES:
        names = {series.name for series in curve.series}
        assert {aim.of_first for aim in curve.aims if aim.of_first} <= names


@pytest.mark.long
def test_points_are_measured_in_processes_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    here = Path(__file__).parents[2]
    monkeypatch.setenv(
        "PYTHONPATH", os.pathsep.join(str(here / each) for each in ("src", "benchmarks"))
    )
    walk = '{"shape": [40, 8, 40], "agents": 2, "depth": 1, "is_known": true}'
    series = [
        Series("walk", [f"of_walk({x}, {walk!r})" for x in (1, 2)]),
        Series("long", ["of_long_walk(in_file=True, ticks=2000, agents=2)"]),
        Series(
            "branches", ["branched(in_file=False, acts=True, chained=True, branches=4, block=2)"]
        ),
    ]
    told: list[str] = []
    points = measured_points(Curve("few", "", "", "", "", series), told.append)
    assert told == ["few: walk", "few: walk", "few: long", "few: branches"]
    places = {each.name: [p.x for p in points if p.series == each.name] for each in series}
    assert places == {"walk": [1, 2], "long": list(range(100, 2001, 100)), "branches": [2, 4]}
    assert all(point.ms > 0 for point in points)
    assert all(point.mb > 30 for point in points if point.series != "branches")
