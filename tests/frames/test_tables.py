"""Tables of a study's recorded runs, joined on their ids."""

import re
from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest import frames

GUIDE = Path(__file__).parents[2] / "docs" / "frames.md"


@pytest.fixture
def told(capsys, tmp_path, monkeypatch):
    """Return the output of the guide's code, run in a folder with its study."""
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", GUIDE.read_text("utf-8"), re.DOTALL)
    exec(compile(code, "guide", "exec"), {"__name__": "guide"})
    return code, capsys.readouterr().out.splitlines()


def test_the_guide_does_what_it_says_and_all_tables_join(told):
    code, printed = told
    assert printed == re.findall(r"print\(.*\)  # (.*)", code)
    cells = frames.cells_df("lies")
    events = frames.events_df("lies")
    ids = ["cell", "path", "branch", "entry", "number"]
    assert not events.duplicated(ids).any()
    assert set(events.cell) == set(cells.cell)
    probes = frames.probes_df("lies")
    ran = events[events.path == "/observer"]
    assert set(ran.branch) == set(probes.probe)
    assert (cells.right == 1).all()
    alone = frames.events_df(cells.run[0])
    assert len(alone) == (events.cell == cells.cell[0]).sum()


def test_claims_tell_of_each_belief(tmp_path):
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (6, 3, 6)),
        agents={"anne": (1.5, 0, 1.5), "bob": (3.5, 0, 1.5)},
        containers={(5, 0, 5): {}},
    )
    perception = bn.Perception(testimony="accept")
    with bn.Nest(world, perception, store=tmp_path / "run.bn") as nest:
        world.say("anne", "Over there.", claims=[bn.Claim.located("diamond", (5, 0, 5))])
        taken = nest.claims()[0].taken_up("/bob")
    claims = frames.claims_df(tmp_path / "run.bn", ["/bob"])
    assert claims[["claim", "speaker", "item", "path"]].values.tolist() == [
        [1, "anne", "diamond", "/bob"]
    ]
    assert claims.taken_up.tolist() == [taken]
    assert frames.requests_df(tmp_path / "run.bn").empty


def test_a_study_that_was_not_recorded_has_cells_and_probes_alone(tmp_path):
    study = bn.Study("sally-anne", conditions=[1], world="scripted")
    study.run(tmp_path / "plain", jobs=1)
    cells, probes = (read(tmp_path / "plain") for read in (frames.cells_df, frames.probes_df))
    assert list(cells.cell) == list(probes.cell)
    assert cells.run.isna().all()
    for read in (frames.requests_df, frames.events_df, frames.claims_df):
        with pytest.raises(bn.InputError, match="the study recorded no runs"):
            read(tmp_path / "plain")


def test_where_there_is_no_run_it_says_so(tmp_path):
    with pytest.raises(bn.InputError, match="there is no run"):
        frames.cells_df(tmp_path)
