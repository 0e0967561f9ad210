"""The policy that the notebook on training has learned."""

import json
from pathlib import Path
from typing import Any

import numpy as np

NOTEBOOK = Path(__file__).parents[2] / "docs" / "notebooks" / "training.ipynb"


def test_the_trained_policy_of_the_notebook_raises_the_lift() -> None:
    cells = json.loads(NOTEBOOK.read_text("utf-8"))["cells"]
    tagged: dict[str, list[Any]] = {"setup": [], "weights": []}
    for cell in cells:
        for tag in cell["metadata"].get("tags", ()):
            tagged.setdefault(tag, []).append(cell)
    there: dict[str, Any] = {}
    for cell in tagged["setup"]:
        exec(compile("".join(cell["source"]), NOTEBOOK.name, "exec"), there)
    (weights,) = tagged["weights"]
    trained = np.array(json.loads("".join(weights["outputs"][0]["data"]["text/plain"])))
    assert sum(there["play"](trained, seed) for seed in range(100, 104)) == 4
    # Without weights, Anne goes to the first lever, wherever Bob is.
    assert sum(there["play"](0 * trained, seed) for seed in range(100, 104)) < 4
    there["env"].close()
