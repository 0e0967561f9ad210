"""Write the pictures of README and docs, with the program itself. Run by `make picture`."""

import tempfile
from pathlib import Path

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.cli.folder import STORE

IMAGES = Path(__file__).parents[1] / "docs" / "img"
CHEST = (-2, -51, -4)
PATHS = ("/", "/observer", "/sally", "/observer/sally")
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
            plot = nest.plot_beliefs(container=CHEST, item="diamond", paths=PATHS)
            plot.save(images / "beliefs-over-time.png")
        for name in BATTERIES:
            run = Path(folder, name)
            if run_command_line(["run", name, "--out", str(run)]) != 0:
                raise SystemExit(f"{name} is not as expected: mend that first")
            (images / f"{name}.png").write_bytes((run / "picture.png").read_bytes())


if __name__ == "__main__":
    write_pictures(IMAGES)
