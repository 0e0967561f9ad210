"""The core works without the rooms around it."""

import subprocess
import sys
import tomllib
from pathlib import Path

from tools.size import SIZES

TOP = Path(__file__).parents[2]
CONTRACTS = tomllib.loads((TOP / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
(CONTRACT,) = (each for each in CONTRACTS if each["name"].startswith("What the paper describes"))
CORE, AROUND = CONTRACT["source_modules"], CONTRACT["forbidden_modules"]
APART = {"__main__", "errors", "files", "importing", "locking", "owned", "version", "worlds"}
"""Modules below all rooms, the one that starts the command line, and a room listed in parts."""
MOST = 36_000
"""Greatest number of lines of code of the core, as `tools/size.py` counts them."""
PROGRAM = """
import sys

class Deleted:
    def find_spec(self, name, path=None, target=None):
        if any(f"{name}.".startswith(f"{room}.") for room in sys.argv[1:]):
            raise ModuleNotFoundError(f"{name} was deleted", name=name)

sys.meta_path.insert(0, Deleted())
import beliefnest as bn
from beliefnest.llm.resolve import resolve_model
from beliefnest.scenarios.running import run_scenario

scenario = bn.Scenario.load("sally-anne", condition=3)
with bn.Nest.open(scenario, world="scripted") as nest:
    model = resolve_model("offline", {})
    outcome = run_scenario(nest, scenario, model, 0, 0.0, lambda what, done, total: None)
    assert outcome.ok
    belief = nest["/observer/sally"]
    before = belief.state
    belief.switch("try")
    assert belief.run("sally", "await goToPosition(bot, new Vec3(0, -51, -8))").ok
    prompt = belief.render("{{ branch | position('sally') }} {{ branch | chests }}")
    assert belief.explain(container=(-2, -51, -4))
    assert nest.compare("/", "/observer/sally")
    print(prompt.replace("\\n", " "))
    belief.switch("follow")
    assert belief.state == before
"""


def test_a_scenario_is_played_forked_and_asked_in_a_process_without_them():
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *AROUND], capture_output=True, text=True, check=False
    )
    assert done.stderr == ""
    assert "diamond" in done.stdout


def test_every_room_is_of_the_core_or_around_it():
    source = TOP / "src" / "beliefnest"
    rooms = {each.stem for each in source.iterdir() if each.suffix == ".py"}
    rooms |= {each.name for each in source.iterdir() if (each / "__init__.py").exists()}
    rooms |= {f"worlds.{each.stem}" for each in (source / "worlds").iterdir()}
    placed = {name.removeprefix("beliefnest.") for name in (*CORE, *AROUND)}
    parts = {"__init__", "__pycache__", "worlds.__init__", "worlds.__pycache__"}
    assert rooms - APART - parts == placed


def test_the_core_stays_small():
    files = [
        file
        for room in CORE
        for place in [TOP.joinpath("src", *room.split("."))]
        for file in ([place.with_suffix(".py")] if not place.is_dir() else place.rglob("*.*"))
        if file.suffix in SIZES and "test" not in file.parts
    ]
    assert 0 < sum(SIZES[file.suffix](file) for file in files) <= MOST
