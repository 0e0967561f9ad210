"""The drawing of the rooms, their table and the folders say the same."""

import ast
import re
import tomllib
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

TOP = Path(__file__).parents[2]
SOURCES = TOP / "src" / "beliefnest"
NODE_SOURCES = SOURCES / "worlds" / "minecraft" / "node" / "src"


def rooms_in(folder):
    return {each.name for each in folder.iterdir() if (each / "__init__.py").exists()}


def layers_of(container):
    contracts = tomllib.loads((TOP / "pyproject.toml").read_text())["tool"]["importlinter"]
    (found,) = [c for c in contracts["contracts"] if c.get("containers") == [container]]
    return {name.strip("() ") for layer in found["layers"] for name in layer.split("|")}


@pytest.mark.parametrize(
    ("paper", "from_here"),
    [("design/architecture.md", ""), ("CONTRIBUTING.md", "## Adding something")],
)
def test_files_that_the_papers_name_are_there(paper, from_here):
    _, _, text = f"\n{(TOP / paper).read_text()}".partition(f"\n{from_here}")
    named = re.findall(r"`([\w/]+/[\w.]*|[\w/]+\.(?:py|js|md|toml))`", text)
    assert len(named) > 30
    roots = (SOURCES, NODE_SOURCES, NODE_SOURCES.parent, TOP)
    missing = [name for name in named if not any((at / name).exists() for at in roots)]
    assert missing == []


def test_every_room_is_in_the_table_and_in_the_contract():
    table = (TOP / "CONTRIBUTING.md").read_text()
    rooms = rooms_in(SOURCES) | {f"nest/{room}" for room in rooms_in(SOURCES / "nest")}
    told = set(re.findall(r"^\| `([\w/]+?)/?` \|", table, re.MULTILINE))
    assert rooms - {"nest"} <= told
    assert rooms_in(SOURCES) <= layers_of("beliefnest")
    assert rooms_in(SOURCES / "nest") == layers_of("beliefnest.nest")


def imports_of(path, modules):
    """Modules of the package that a file imports, also within functions, but for types alone."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    typed = [each for each in tree.body if isinstance(each, ast.If)]
    idle = {
        id(part)
        for each in typed
        if "TYPE_CHECKING" in ast.unparse(each.test)
        for part in each.body
    }
    for node in ast.walk(tree):
        if id(node) in idle:
            continue
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            names = {f"{node.module}.{alias.name}" for alias in node.names} & modules.keys()
            yield from names or {node.module} & modules.keys()


def test_no_files_import_each_other_in_a_circle():
    files = [p for p in SOURCES.rglob("*.py") if "node_modules" not in p.parts]
    modules = {
        ".".join(p.relative_to(SOURCES.parent).with_suffix("").parts).removesuffix(".__init__"): p
        for p in files
    }
    TopologicalSorter({name: set(imports_of(p, modules)) for name, p in modules.items()}).prepare()
