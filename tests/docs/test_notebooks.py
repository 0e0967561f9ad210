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
