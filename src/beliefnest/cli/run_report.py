"""`report.html`: the results of a run on one self-contained page."""

import json
import shlex
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from beliefnest.world.texts import visible


def report_html(
    report: Mapping[str, Any],
    *,
    about: Mapping[str, str],
    conditions: Mapping[int, str],
    versions: Mapping[str, str],
) -> str:
    """Return the page of a run.

    Args:
        report: The run's report, as in `run.json`.
        about: `description` of the scenario, and its `name` as given on the command line.
        conditions: Descriptions of conditions, by number.
        versions: Versions of programs, by name.
    """
    runs = [_run(each, conditions) for each in report["runs"]]
    # The template escapes all text from scenarios and models. Only our own pictures are markup.
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    environment.filters["compact"] = _compact
    template = environment.from_string(
        (files("beliefnest.cli") / "run_report.html").read_text(encoding="utf-8")
    )
    return visible(
        template.render(
            report=report,
            runs=runs,
            description=about["description"],
            command=command_of(about["name"], report["settings"]),
            versions=sorted(versions.items()),
            several_models=len({(run["model"], run["seed"]) for run in runs}) > 1,
            verdict=_verdict,
        )
        + "\n"
    )


def command_of(name: str, settings: Mapping[str, Any]) -> str:
    """Return the command line that repeats the run."""
    words = ["beliefnest", "run", name]
    for condition in settings["conditions"]:
        words += ["--condition", str(condition)]
    words += ["--world", settings["world"], "--models", ",".join(settings["models"])]
    for key in ("repeat", "seed", "attempts", "temperature"):
        if settings.get(key) is not None:
            words += [f"--{key}", str(settings[key])]
    return shlex.join(words)


def _run(run: Mapping[str, Any], conditions: Mapping[int, str]) -> dict[str, Any]:
    """Return the result of one condition for the template, with the content of its files."""
    folder, number = Path(run["run_dir"]), run["condition"]
    picture = folder / "picture.svg"
    probes = []
    for index, probe in enumerate(run["probes"], start=1):
        place = folder / f"probe-{index}"
        texts = {name: _text(place / f"{name}.txt") for name in ("prompt", "answer")}
        replies = [
            {
                **reply,
                "prompt": _text(place / f"question-{count}.txt"),
                "text": _text(place / f"reply-{count}.txt"),
            }
            for count, reply in enumerate(probe["replies"], start=1)
        ]
        probes.append({**probe, **texts, "replies": replies})
    return {
        **run,
        "title": "run" if number is None else f"condition {number}",
        "about": conditions.get(number, "") if number is not None else "",
        "held": sum(bool(each["ok"]) for each in run["expectations"]),
        "probes": probes,
        # Our own SVG writer escapes all text in it.
        "picture": Markup(_text(picture)) if picture.is_file() else None,
    }


def _text(file: Path) -> str:
    return file.read_text(encoding="utf-8") if file.is_file() else ""


def _verdict(ok: bool | None) -> Markup:
    if ok is None:
        return Markup("nothing expected")
    return Markup("as expected") if ok else Markup('<span class="no">NOT as expected</span>')


def _compact(value: object) -> str:
    """Return a value of the report on one line."""
    if isinstance(value, Mapping):
        if not value:
            return "none"
        return ", ".join(f"{key}: {_compact(each)}" for key, each in value.items())
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"({', '.join(map(_compact, value))})"
    return value if isinstance(value, str) else json.dumps(value)
