"""The notebooks of the docs run from end to end, and show drawings."""

from pathlib import Path

import nbclient
import nbformat
import pytest

DRAWINGS = {"tutorial": 3, "study": 1}
NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
@pytest.mark.filterwarnings("ignore")  # of Jupyter's own libraries
def test_every_cell_runs_and_drawings_are_shown(file: Path, tmp_path: Path) -> None:
    notebook = nbformat.read(file, as_version=4)
    resources = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=300, resources=resources).execute()
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    shown = [out.data for cell in cells for out in cell.outputs if out.output_type != "stream"]
    drawn = sum("<svg" in data.get("text/html", "") or "image/svg+xml" in data for data in shown)
    assert drawn >= DRAWINGS[file.stem]
    assert not any(" object at 0x" in data.get("text/plain", "") for data in shown)


def test_the_notebook_of_a_study_holds_what_it_shows(tmp_path: Path) -> None:
    file = next(file for file in NOTEBOOKS if file.stem == "study")
    stored, notebook = (nbformat.read(file, as_version=4) for _ in range(2))
    resources = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=300, resources=resources).execute()
    assert _words(stored) == _words(notebook), "write it anew with `make notebooks`"
    drawn = [out.data for cell in stored.cells for out in cell.get("outputs", []) if "data" in out]
    assert any("<svg" in data.get("image/svg+xml", "") for data in drawn)


def _words(notebook: nbformat.NotebookNode) -> list[str]:
    """What cells show, without drawings."""
    outputs = [out for cell in notebook.cells for out in cell.get("outputs", [])]
    return [out.data["text/plain"] for out in outputs if "text/plain" in out.get("data", {})]
