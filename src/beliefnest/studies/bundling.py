"""Files of a supplement: a study or run with all that is needed to read it and to play it again."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from beliefnest.errors import InputError, UnknownNameError
from beliefnest.files import read_regular
from beliefnest.llm.providers import PROVIDERS
from beliefnest.llm.secrets import Secrets, secrets_in
from beliefnest.studies.accuracy_figure import plot_accuracy, svg_of
from beliefnest.studies.archive import check_secrets, with_manifest
from beliefnest.studies.filter_packages import PACKAGES, filter_packages
from beliefnest.studies.kinds import EPISODE_KIND, RUN_KIND, SCENARIO_KIND
from beliefnest.studies.methods import methods_text
from beliefnest.studies.page import page_text
from beliefnest.studies.plainframe import csv_text
from beliefnest.studies.study_record import StudyRecord


def opened(folder: Path) -> StudyRecord:
    """Return the results in the folder of a study or of a run.

    Raises:
        InputError: The folder holds neither.
    """
    if not any((folder / name).exists() for name in ("study.json", "cells", "run.json")):
        raise InputError(
            f"there is neither a study nor a run at {folder}; give the folder of `beliefnest study "
            "--out` or `beliefnest run --out`"
        )
    result = StudyRecord.read(folder)
    if result.kind not in (SCENARIO_KIND, EPISODE_KIND, RUN_KIND):
        raise InputError(
            f"{folder} holds {result.kind.name}; supplements are of scenarios and episodes"
        )
    return result


def bundled(result: StudyRecord, environment: Mapping[str, str], *, runs: bool) -> dict[str, bytes]:
    """Return the files of the supplement of a study or run, by path.

    Args:
        result: The results.
        environment: Variables with keys and addresses of models, which must not be in a file.
        runs: Include the recorded run files.

    Raises:
        InputError: A file contains a secret.
    """
    files = _files(result, runs=runs)
    check_secrets(files, _secrets(environment))
    return with_manifest(files, result.folder.of, result.plan["versions"])


def _files(result: StudyRecord, *, runs: bool) -> dict[str, bytes]:
    of_kind = _study_files if result.folder.of == "study" else _run_files
    files = {**dict(of_kind(result, runs=runs)), **filter_packages()}
    files["rows.csv"] = csv_text(result.typed()).encode()
    files["methods.md"] = methods_text(result, "markdown").encode()
    files["methods.tex"] = methods_text(result, "latex").encode()
    files["README.md"] = _readme(result, files).encode()
    return files


def _study_files(result: StudyRecord, *, runs: bool) -> Iterator[tuple[str, bytes]]:
    folder = result.folder.path
    yield "study.json", read_regular(folder / "study.json")
    for name in ("people.json", "people.csv"):
        if (folder / name).is_file():
            yield name, read_regular(folder / name)
    for path in _below(folder, ("inputs", "answers", *(["runs"] if runs else []))):
        yield path.relative_to(folder).as_posix(), path.read_bytes()
    for name in sorted(cell["name"] for cell in result.plan["cells"]):
        if (folder / "cells" / f"{name}.json").is_file():
            yield f"cells/{name}.json", read_regular(folder / "cells" / f"{name}.json")
    yield "study.html", page_text(result, result.groups).encode()
    yield from _figure(result.counted(result.groups), result.groups)


def _figure(groups: Sequence[Mapping[str, Any]], by: Sequence[str]) -> Iterator[tuple[str, bytes]]:
    """Yield the figure of accuracies; nothing without matplotlib."""
    along = [name for name in by if len({group[name] for group in groups}) > 1] or list(by[:1])
    try:
        yield "figure.svg", svg_of(plot_accuracy(groups, along)).encode()
    except UnknownNameError:
        return


def _run_files(result: StudyRecord, *, runs: bool) -> Iterator[tuple[str, bytes]]:
    folder = result.folder.path
    for path in _below(folder, (".",)):
        is_store = path.suffix == ".bn" or path.name.endswith((".bn-wal", ".bn-shm"))
        if (runs or not is_store) and path.suffix not in (".part", ".lock"):
            yield path.relative_to(folder).as_posix(), path.read_bytes()


def _below(folder: Path, names: Sequence[str]) -> list[Path]:
    return sorted(
        path
        for name in names
        for path in (folder / name).rglob("*")
        if path.is_file() and not path.is_symlink()
    )


def _secrets(environment: Mapping[str, str]) -> Secrets:
    """Return the keys of all providers and the passwords in their addresses."""
    values: list[str] = []
    for provider in PROVIDERS.values():
        values += [environment.get(name, "") for name in provider.key_variables]
        values += secrets_in(environment.get(provider.url_variable, ""))
    return Secrets(values)


def _readme(result: StudyRecord, files: Mapping[str, bytes]) -> str:
    version = result.plan["versions"].get("beliefnest", "")
    pin = f"=={version}" if version else ""
    kind = result.folder.of
    filters = ""
    if any(name.startswith(f"{PACKAGES}/") for name in files):
        filters = (
            "\nPrompts use filters of the packages in `packages/`. If these are not installed, "
            f"read them, and write `PYTHONPATH={PACKAGES}` before the command.\n"
        )
    contents = "\n".join(
        f"| `{name}` | {content} |"
        for name, content in _CONTENTS[kind].items()
        if any(file == name or file.startswith(name) for file in files)
    )
    return f"""# Supplement of a {kind}

{methods_text(result, "markdown")}
Play everything again, without any model, and compare all rows:

```bash
pip install "beliefnest[study,plot]{pin}"
beliefnest reproduce .
```

The command takes the recorded answers in place of models. It says that all rows are equal, or
which ones differ and where.
{filters}
| file | content |
|---|---|
{contents}
"""


_CONTENTS = {
    "study": {
        "inputs/study.yaml": "the study as it was written",
        "inputs/scenarios/": "scenarios as they were played",
        "inputs/tasks/": "tasks as they were played",
        "inputs/templates/": "prompt templates",
        "inputs/policies/": "programs and classes of policies",
        "inputs/models/": "files of scripted or recorded answers",
        "study.json": "the plan: each cell with its values and seed, and invalid combinations",
        "people.json": "the cells that participants answered",
        "people.csv": "every answer of a participant, with times and the order of the options",
        "answers/": "every request to a model and its answer, with tokens, cost and date",
        "cells/": "the result of each cell",
        "runs/": "recorded runs, for `beliefnest show` and `beliefnest serve`",
        "rows.csv": "one row for each probe or episode",
        "figure.svg": "accuracies with 95 % intervals",
        "study.html": "the page: figure, intervals, differences, all rows",
        "packages/": "packages of prompt filters",
        "methods.md": "the paragraph above; `methods.tex`: the same in LaTeX",
        "bundle.json": "versions, and the SHA-256 of every file",
    },
    "run": {
        "scenario.yaml": "the scenario as it was played",
        "scenario.templates.json": "its prompt templates",
        "study.json": "the plan: each cell with its settings, and versions",
        "cells/": "the result of each cell",
        "run.json": "settings, versions and all results in one object",
        "model.jsonl": "every request to a model and its answer",
        "rows.csv": "one row for each probe",
        "picture.png": "all conditions at their ends",
        "report.html": "the page",
        "packages/": "packages of prompt filters",
        "methods.md": "the paragraph above; `methods.tex`: the same in LaTeX",
        "bundle.json": "versions, and the SHA-256 of every file",
    },
}
