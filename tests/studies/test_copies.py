"""Repeated cells are no further evidence: neither for intervals nor for tests."""

from pathlib import Path

import pytest
from tests.studies.small import SMALL, small_in
from tests.studies.test_episode_cells import TASK

import beliefnest as bn
from beliefnest.studies.counting import count_rows, paired_rows

SEARCHED = TASK.replace("eve: random", 'eve: "search:0"')


def row(model, cell, ok, copy_of=None):
    return {
        "model": model,
        "repeat": int(cell[1:]),
        "cell": cell,
        "ok": ok,
        "outcome": "ok" if ok else "wrong",
        "tokens": 2,
        "copy_of": copy_of,
    }


def test_of_a_row_and_its_copies_one_is_counted_in_each_group():
    rows = [row("a", "a1", True), row("a", "a2", True, "a1"), row("a", "a3", True, "a1")]
    (found,) = count_rows(rows, ["model"])
    assert (found["rows"], found["copies"], found["judged"], found["ok"]) == (3, 2, 1, 1)
    assert found["tokens"] == 6
    assert found["low"] == pytest.approx(0.2065, abs=1e-4)  # Wilson, 1 of 1
    apart = count_rows(rows, ["repeat"])
    assert [each["judged"] for each in apart] == [1, 1, 1]


def test_pairs_are_copies_where_both_their_rows_are():
    fixed = [row("a", f"a{n}", True, "a1" if n > 1 else None) for n in range(1, 7)]
    other = [row("b", f"b{n}", False, "b1" if n > 1 else None) for n in range(1, 7)]
    drawn = [row("c", f"c{n}", False) for n in range(1, 7)]
    found = paired_rows([*fixed, *other, *drawn], "model", ["model", "repeat"])
    assert [(each.one, each.other, each.pairs) for each in found] == [
        ("a", "b", 1),
        ("a", "c", 6),
        ("b", "c", 6),
    ]
    assert found[0].p == 1
    assert paired_rows(fixed, "repeat", ["model", "repeat"]) == []


@pytest.mark.parametrize(
    ("task", "policies", "repeats", "copies"),
    [
        (SEARCHED, "program:idle.js", 1, 2),
        (SEARCHED, "program:drawing.js", 1, 0),
        (SEARCHED, "random", 1, 0),
        (TASK, "program:idle.js", 1, 0),
        ("help-find", "scripted:idle.js", 1, 0),
        ("help-find", "scripted:idle.js", 2, 3),
    ],
)
def test_episodes_are_copies_where_nobody_draws(
    task: str,
    policies: str,
    repeats: int,
    copies: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bring.yaml").write_text(task)
    Path("idle.js").write_text("")
    Path("drawing.js").write_text("if (Math.random() < 0.5) await sleep(1)")
    name = "bring.yaml" if "\n" in task else task
    result = bn.Study(tasks=name, policies=policies, seeds=3, repeats=repeats).run("out", jobs=1)
    assert all(row["outcome"] in ("ok", "wrong") for row in result.rows)
    (found,) = result.counted(["policy"])
    assert (found["rows"], found["copies"]) == (3 * repeats, copies)
    assert ("rows are copies" in result.write_page("page.html").read_text("utf-8")) == (copies > 0)


def test_repeats_of_a_scenario_are_copies_where_nobody_draws(tmp_path: Path) -> None:
    study = bn.Study(small_in(tmp_path), repeats=3, world="scripted")
    result = study.run(tmp_path / "a", jobs=1)
    assert [row["copy_of"] for row in result.rows] == [None, *[result.rows[0]["cell"]] * 2]
    drawing = SMALL + "script: [{agent: ann, program: 'Math.random()'}]\n"
    study = bn.Study(small_in(tmp_path, drawing), repeats=3, world="scripted")
    assert {row["copy_of"] for row in study.run(tmp_path / "b", jobs=1).rows} == {None}


def test_probes_of_a_cell_are_compared_and_what_never_differs_alone_is_told(
    tmp_path: Path,
) -> None:
    second = SMALL[SMALL.index("  - label: fetch") :].replace("fetch", "again")
    study = bn.Study(
        small_in(tmp_path, SMALL + second.replace("Get a", "Take a")),
        world="scripted",
        variations={"count": [1, 2]},
    )
    result = study.run(tmp_path / "out", jobs=1)
    (pairs,) = result.differences("probe").to_dict("records")
    assert (pairs["one"], pairs["other"], pairs["pairs"]) == ("fetch", "again", 2)
    assert list(result.differences("model").columns[:3]) == ["one", "other", "pairs"]
    with pytest.raises(bn.InputError, match="no two rows differ in 'task' alone"):
        result.differences("task")
