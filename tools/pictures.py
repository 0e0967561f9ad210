"""Write the pictures of README and docs, with the program itself. Run by `make picture`."""

import contextlib
import re
import tempfile
from pathlib import Path

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.cli.folder import STORE
from beliefnest.studies.accuracy_figure import svg_of

ROOT = Path(__file__).parents[1]
IMAGES = ROOT / "docs" / "img"
CHEST = (-2, -51, -4)
PATHS = ("/", "/observer", "/sally", "/observer/sally")
FIGURE_1 = ("/", "/agent_1", "/agent_2", "/agent_1/agent_2", "/agent_2/agent_1")
BATTERIES = (
    "unexpected-contents",
    "unexpected-transfer",
    "bake-sale",
    "birthday-puppy",
    "lie",
    "knowledge-access",
    "double-bluff",
)


def write_pictures(images: Path) -> None:
    """Write them into a folder."""
    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder, "run")
        if run_command_line(["run", "sally-anne", "--out", str(run)]) != 0:
            raise SystemExit("sally-anne is not as expected: mend that first")
        (images / "sally-anne.png").write_bytes((run / "picture.png").read_bytes())
        belief = str(images / "belief.png")
        run_command_line(["show", str(run), "--path", "/observer/sally", "--png", belief])
        with bn.Nest.read(run / "condition-1" / STORE) as nest:
            nest.figure(PATHS).save(images / "figure.png")
            narrow = nest.figure(("/", "/observer/sally"))
            narrow.save(images / "sally-anne-narrow.png", size="one column", dpi=300)
            plot = nest.plot_beliefs(container=CHEST, item="diamond", paths=PATHS)
            plot.save(images / "beliefs-over-time.png")
        for name in BATTERIES:
            run = Path(folder, name)
            if run_command_line(["run", name, "--out", str(run)]) != 0:
                raise SystemExit(f"{name} is not as expected: mend that first")
            (images / f"{name}.png").write_bytes((run / "picture.png").read_bytes())
        figure_1 = Path(folder, "figure 1")
        run_command_line(["run", "red-green-blue", "--condition", "1", "--out", str(figure_1)])
        with bn.Nest.read(figure_1 / "condition-1" / STORE) as nest:
            nest.figure(FIGURE_1).save(images / "red-green-blue.png")
        write_study(images, Path(folder, "study"))
        write_minds(images, Path(folder))
        write_day(images, Path(folder))


def write_study(images: Path, folder: Path) -> None:
    """Write the figure of a study, which docs/studies.md tells how to make."""
    study = bn.Study("sally-anne", variations=20, world="scripted")
    result = study.run(folder, jobs=1)
    text = svg_of(result.plot(by=["condition", "model"]))
    (images / "study.svg").write_text(text, encoding="utf-8")


def write_minds(images: Path, folder: Path) -> None:
    """Write the figures of docs/minds.md with the examples of that page."""
    page = (ROOT / "docs" / "minds.md").read_text(encoding="utf-8")
    examples = re.findall(r"```python\n(.*?)```", page, re.DOTALL)[:2]
    with contextlib.chdir(folder):
        exec("\n".join(examples), {"__name__": "examples"})
    for name in ("minds.png", "minds-plan.png"):
        (images / name).write_bytes((folder / name).read_bytes())


def write_day(images: Path, folder: Path) -> None:
    """Write the pictures of docs/days/psychologist.md with the files of that page."""
    page = (ROOT / "docs" / "days" / "psychologist.md").read_text(encoding="utf-8")
    scenario, study = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    with contextlib.chdir(folder):
        Path("window.yaml").write_text(scenario, encoding="utf-8")
        Path("study.yaml").write_text(study, encoding="utf-8")
        belief = str(images / "day-lia-wim.png")
        run_command_line(["run", "window.yaml", "--out", "window"])
        run_command_line(["show", "window", "--path", "/lia/wim", "--png", belief])
        played = bn.Study.load("study.yaml").run("window-study", jobs=1)
        figure = played.plot(by=["order", "condition", "model"])
        figure.savefig(images / "day-accuracy.png")


if __name__ == "__main__":
    write_pictures(IMAGES)
