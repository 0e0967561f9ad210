"""A scenario that takes no time, and studies of it."""

from pathlib import Path

SMALL = """\
name: small
box: [[0, 0, 0], [6, 3, 6]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [6, 0, 6]]}
parameters:
  spot: {default: [1, 1, 1], values: [[1, 1, 1], [5, 1, 1], [1, 1, 5]]}
  item: {default: diamond, values: [diamond, bone]}
  count: {default: 1, range: [1, 64]}
constraints: ["spot[0] + spot[2] < 10"]
containers:
  - {label: box, at: "${spot}", block: "chest[facing=south]", items: {"${item}": "${count}"}}
agents:
  ann: {position: [3.5, 1, 3.5]}
initial_beliefs:
  - {path: /ann, containers: [{at: "${spot}", items: {"${item}": "${count}"}}]}
probes:
  - label: fetch
    path: /ann
    acts_in: /
    agent: ann
    task: Get a ${item} from a chest.
    expect: {opens: "${spot}"}
"""


def small_in(folder: Path, text: str = SMALL) -> str:
    """Path of the scenario's file."""
    file = folder / "small.yaml"
    file.write_text(text, encoding="utf-8")
    return str(file)


def study_in(folder: Path, text: str) -> Path:
    """Path of a study's file, the scenario beside it."""
    small_in(folder)
    file = folder / "study.yaml"
    file.write_text(text, encoding="utf-8")
    return file


def tables_of(folder: Path) -> dict[str, bytes]:
    """Return the tables in a folder of a study; there is a Parquet file only with pyarrow."""
    names = ("rows.csv", "rows.parquet", "study.html")
    found = {name: (folder / name).read_bytes() for name in names if (folder / name).exists()}
    assert len(found) > 1
    return found
