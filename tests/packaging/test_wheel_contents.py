"""Files of a wheel besides Python: texts for models, scenarios, templates."""

from pathlib import Path

from hatchling.builders.wheel import WheelBuilder

ROOT = Path(__file__).parents[2]


def test_a_wheel_carries_what_is_read_at_run_time_and_no_sources_of_the_bundle() -> None:
    builder = WheelBuilder(str(ROOT))
    files = {Path(each.distribution_path).as_posix() for each in builder.recurse_included_files()}
    assert {
        "beliefnest/skills/manifests.json",
        "beliefnest/skills/manifests.py",
        "beliefnest/scenarios/builtin/ice-cream-van.yaml",
        "beliefnest/scenarios/builtin/help-sally.yaml",
        "beliefnest/scenarios/starter/starter.yaml",
        "beliefnest/prompts/texts/paper.txt",
        "beliefnest/studies/participants/web/plugin.js",
        "beliefnest/studies/participants/web/style.css",
    } <= files
    sources = ("beliefnest/skills/code/", "beliefnest/worlds/minecraft/node/")
    assert not [file for file in files if file.startswith(sources) and file.endswith(".js")]
