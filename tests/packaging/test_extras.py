"""Features that need an extra say so, with the command that installs it."""

import importlib
import sys

import pytest
from tests.studies.small import small_in

import beliefnest as bn
import beliefnest.frames
from beliefnest.env import parallel_env
from beliefnest.errors import MissingExtraError
from beliefnest.pictures.figure import Figure
from beliefnest.pictures.marks import Drawing

BLANK = Figure(lambda points: Drawing(points, points, (), ""), 84, "")


def tasks_of_inspect(study, folder):
    importlib.import_module("beliefnest.inspect")


@pytest.mark.parametrize(
    ("package", "extra", "use"),
    [
        ("pandas", "study", lambda study, folder: study.run(folder / "s").frame()),
        ("pyarrow", "study", lambda study, folder: study.run(folder / "s").write_tables()),
        ("pandas", "study", lambda study, folder: beliefnest.frames.cells_df(folder / "s")),
        ("matplotlib.figure", "plot", lambda study, folder: study.run(folder / "s").plot()),
        ("distributed", "dask", lambda study, folder: study.run(folder / "new", 2, "dask")),
        ("ray.util.joblib", "ray", lambda study, folder: study.run(folder / "new", 2, "ray")),
        ("reportlab.pdfbase", "pdf", lambda study, folder: BLANK.save(folder / "f.pdf")),
        ("pettingzoo", "pettingzoo", lambda study, folder: parallel_env("sally-anne")),
        ("inspect_ai", "inspect", tasks_of_inspect),
    ],
)
def test_what_is_missing_is_told_with_its_command(tmp_path, monkeypatch, package, extra, use):
    study = bn.Study(small_in(tmp_path), world="scripted")
    study.run(tmp_path / "s", jobs=1)
    # pandas looks for pyarrow once, when it is first imported, and then holds to what it found.
    importlib.import_module("pandas")
    for name in list(sys.modules):
        # A module of the package that another test imported is found without its package.
        if name.startswith(("beliefnest.inspect", "beliefnest.env.", f"{package}.")):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MissingExtraError, match=rf'pip install "beliefnest\[{extra}\]"'):
        use(study, tmp_path)
