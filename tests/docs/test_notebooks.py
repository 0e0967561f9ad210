"""The notebooks of the docs run from end to end, and show drawings."""

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from tests.profiles import NIGHTLY

if TYPE_CHECKING:
    import nbformat

pytestmark = pytest.mark.extra("ipykernel", "nbclient", "nbformat")

DRAWINGS = {"tutorial": 3, "study": 1, "food_trucks": 4, "training": 2}
LONG = {"training"}
"""Notebooks that compute for minutes: they run at night."""
NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))
RUN = [file for file in NOTEBOOKS if NIGHTLY or file.stem not in LONG]


@pytest.mark.parametrize("file", RUN, ids=lambda file: file.stem)
@pytest.mark.filterwarnings("ignore")  # of Jupyter's own libraries
def test_every_cell_runs_and_shows_what_the_file_shows(file: Path, tmp_path: Path) -> None:
    import nbclient
    import nbformat

    stored, notebook = (nbformat.read(file, as_version=4) for _ in range(2))
    resources = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=1800, resources=resources).execute()
    shown = _shown(notebook)
    drawn = sum("<svg" in data.get("text/html", "") or "image/svg+xml" in data for data in shown)
    assert drawn >= DRAWINGS[file.stem]
    assert not any(" object at 0x" in data.get("text/plain", "") for data in shown)
    assert _words(stored) == _words(notebook), "write it anew with `make notebooks`"
    assert any("<svg" in "".join(data.values()) for data in _shown(stored))


def _shown(notebook: "nbformat.NotebookNode") -> list["nbformat.NotebookNode"]:
    """Return what cells show, of each kind of output that has data."""
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    return [out.data for cell in cells for out in cell.outputs if "data" in out]


def _words(notebook: "nbformat.NotebookNode") -> list[str]:
    """Return what cells show, without drawings."""
    return [data["text/plain"] for data in _shown(notebook) if "text/plain" in data]
