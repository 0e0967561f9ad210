"""`beliefnest suite food-trucks`: films acted out and judged, beside the judgments of people."""

import math
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from rich.table import Table

from beliefnest.cli.console import Printed, print_report, progress_on, result_table
from beliefnest.cli.options import SuiteOptions
from beliefnest.errors import InputError, MissingExtraError
from beliefnest.locking import holding
from beliefnest.pictures.scatter import Dot, ScatterPanel, ScatterRow, scatter_figure
from beliefnest.studies.plainframe import Typed, write_csv, write_parquet
from beliefnest.suites import FILMS
from beliefnest.suites.films.agreement import PUBLISHED, JudgesAgreement, agreement, interval
from beliefnest.suites.films.film import ABOUT, Film, FilmParameters, JudgedPart, grid_for
from beliefnest.suites.films.film_files import read_films
from beliefnest.suites.films.film_inference import LESIONS, Judgment, Lesion, judge

_MODELS: tuple[Lesion | None, ...] = (None, *LESIONS)
_WORDS: Mapping[Lesion | None, str] = {
    None: "inverse planning",
    "true_belief": "true belief",
    "no_cost": "no cost",
}
_SINGULAR: Mapping[JudgedPart, str] = {
    "desires": "desire",
    "beliefs": "belief",
    "locations": "location",
}
_AXES: Mapping[JudgedPart, tuple[str, str]] = {
    "desires": ("model: expected utility", "people: rating"),
    "beliefs": ("model: expected credence", "people: credence"),
    "locations": ("model: probability", "people: probability"),
}
_REPORTS = 10
"""Lines of progress where there is no terminal."""


def run_films(options: SuiteOptions, rows: Collection[int] | None) -> int:
    """Act the films out, judge, print and write files.

    Args:
        options: Options of the command.
        rows: Ids of the films to judge; None: all.

    Raises:
        BeliefNestError: The input is wrong, or a file cannot be written.
    """
    films, parameters = read_films(options.path)
    if rows is not None:
        films = [film for film in films if film.name in {str(row) for row in rows}]
    films = films[: options.limit]
    if not films:
        raise InputError(f"{options.path} holds none of the films asked for")
    folder = _folder(options.out)
    with holding(folder):
        judged = _judge_all(films, parameters)
        report = _report(options, judged, parameters)
        report["files"] = _write(folder, options, judged)
    print_report(report, _parts(judged, report), as_json=options.json)
    return 0


def _judge_all(
    films: Sequence[Film], parameters: FilmParameters
) -> dict[Lesion | None, list[Judgment]]:
    """Judge all films with each model, and show the progress."""
    judged: dict[Lesion | None, list[Judgment]] = {}
    step = max(1, len(films) // _REPORTS)
    with progress_on(FILMS) as on_progress:
        for lesion in _MODELS:
            judged[lesion] = []
            for number, film in enumerate(films):
                if number % step == 0:
                    on_progress(f"{_WORDS[lesion]}, film {film.name}", number, len(films))
                judged[lesion].append(judge(film, parameters, lesion))
        on_progress("all films judged", len(films), len(films))
    return judged


def _folder(out: Path | None) -> Path:
    folder = out or Path("suites", f"{FILMS}-{datetime.now().astimezone():%Y%m%d-%H%M%S}")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"the folder {folder} cannot be made: {error.strerror}") from None
    return folder


def _report(
    options: SuiteOptions,
    judged: Mapping[Lesion | None, Sequence[Judgment]],
    parameters: FilmParameters,
) -> dict[str, Any]:
    films = [judgment.film for judgment in judged[None]]
    groups = list(dict.fromkeys(film.group for film in films if film.group))
    return {
        "suite": FILMS,
        "data": str(options.path),
        "seed": options.seed,
        "films": len(films),
        "scored": sum(film.scored for film in films),
        "correlations": {
            _key(lesion): _correlations(judged[lesion], lesion, options.seed) for lesion in _MODELS
        },
        "groups": {
            group: {
                "films": sum(film.scored for film in films if film.group == group),
                "correlations": _correlations(
                    [each for each in judged[None] if each.film.group == group], None, options.seed
                ),
            }
            for group in groups
        },
        "coarser_grids": {
            film.name: grid
            for film in films
            if (grid := grid_for(film, parameters)) != parameters.grid
        },
        "impossible": {
            judgment.film.name: judgment.impossible
            for judgment in judged[None]
            if judgment.impossible is not None
        },
        "judgments": [_judgment(judgment) for judgment in judged[None]],
    }


def _key(lesion: Lesion | None) -> str:
    return lesion or "model"


def _correlations(
    judgments: Sequence[Judgment], lesion: Lesion | None, seed: int
) -> dict[str, Any]:
    """Return the coefficients of all that people judged, with intervals."""
    correlations: dict[str, Any] = {}
    for about in ABOUT:
        pairs = agreement(judgments, about)
        if not len(pairs.model):
            continue
        correlations[about] = {
            "r": None if math.isnan(pairs.r) else pairs.r,
            "interval": interval(pairs, seed),
            "judgments": len(pairs.model),
            "published": PUBLISHED[lesion].get(about),
        }
    return correlations


def _judgment(judgment: Judgment) -> dict[str, Any]:
    film = judgment.film
    return {
        "film": film.name,
        "group": film.group or None,
        "scored": film.scored,
        "model": judgment.model,
        "people": film.people,
    }


def _write(
    folder: Path, options: SuiteOptions, judged: Mapping[Lesion | None, Sequence[Judgment]]
) -> list[str]:
    """Write the figure, if people judged, and the tables; without pyarrow, no Parquet file."""
    written = []
    rows = _scatter_rows(judged, options.seed)
    if rows:
        figure = scatter_figure(rows, f"Model and people, {options.path.name}")
        for ending in ("svg", "pdf", "png"):
            file = folder / f"scatter.{ending}"
            figure.save(file)
            written.append(str(file))
    columns = _columns(judged)
    try:
        for name, write in (("judgments.csv", write_csv), ("judgments.parquet", write_parquet)):
            write(columns, folder / name)
            written.append(str(folder / name))
    except MissingExtraError as error:
        sys.stderr.write(f"no judgments.parquet: {error}\n")
    except OSError as error:
        raise InputError(f"{folder} cannot be written: {error.strerror or error}") from None
    return written


def _columns(judged: Mapping[Lesion | None, Sequence[Judgment]]) -> dict[str, Typed]:
    """Return a row for each judgment of each model, with that of people beside it."""
    rows: list[tuple[object, ...]] = []
    for lesion, judgments in judged.items():
        for judgment in judgments:
            film = judgment.film
            for about, means in judgment.model.items():
                people, errors = film.people.get(about, {}), film.errors.get(about, {})
                rows += [
                    (
                        *(film.name, film.group or None, film.scored, _key(lesion)),
                        *(_SINGULAR[about], name, value, people.get(name), errors.get(name)),
                        judgment.impossible,
                    )
                    for name, value in means.items()
                ]
    kinds = {
        **dict.fromkeys(("film", "group"), "string"),
        "scored": "bool",
        **dict.fromkeys(("variant", "about", "name"), "string"),
        **dict.fromkeys(("model", "people", "people_se"), "float64"),
        "impossible": "string",
    }
    columns = zip(*rows, strict=True)
    return {
        name: Typed(values, kind)
        for (name, kind), values in zip(kinds.items(), columns, strict=True)
    }


def _scatter_rows(
    judged: Mapping[Lesion | None, Sequence[Judgment]], seed: int
) -> list[ScatterRow]:
    rows = []
    for about in ABOUT:
        pairs = {lesion: agreement(judged[lesion], about) for lesion in _MODELS}
        if len(pairs[None].model):
            across, up = _AXES[about]
            panels = [
                ScatterPanel(f"{about}: {_WORDS[lesion]}", _coefficient(each, seed), _points(each))
                for lesion, each in pairs.items()
            ]
            rows.append(ScatterRow(across, up, panels))
    return rows


def _points(pairs: JudgesAgreement) -> list[Dot]:
    columns = (pairs.model.tolist(), pairs.people.tolist(), pairs.names, pairs.errors.tolist())
    return [
        Dot(x, y, name, 0.0 if math.isnan(error) else error)
        for x, y, name, error in zip(*columns, strict=True)
    ]


def _coefficient(pairs: JudgesAgreement, seed: int) -> str:
    ends = interval(pairs, seed)
    r = None if math.isnan(pairs.r) else pairs.r
    parts = [f"r = {_r_text(r)}", f"n = {len(pairs.names)}"]
    if ends is not None:
        parts.insert(1, f"95 % {_interval_text(ends)}")
    return ", ".join(parts).replace("-", "\u2212")


def _parts(
    judged: Mapping[Lesion | None, Sequence[Judgment]], report: Mapping[str, Any]
) -> Iterator[Printed]:
    title = f"{FILMS}: {report['films']} films, {report['scored']} of them scored"
    if report["correlations"]["model"]:
        table = _table(title, "model", *_NUMBERS, _PUBLISHED)
        for lesion in _MODELS:
            _add(table, _WORDS[lesion], report["correlations"][_key(lesion)])
        yield table
        if report["groups"]:
            table = _table("inverse planning, by group of films", "group", *_NUMBERS)
            for group, part in report["groups"].items():
                title_of_group = f"{group} ({part['films']} films)"
                _add(table, title_of_group, part["correlations"], published=False)
            yield table
    else:
        yield f"{title}; people judged none of them"
    alone = [each for each in judged[None] if not each.film.people]
    if alone:
        yield _alone(alone)
    for name, step in report["impossible"].items():
        yield f"film {name} is left out: {step}"
    for name, grid in report["coarser_grids"].items():
        yield (
            f"film {name}: credences are multiples of 1/{grid}; finer ones do not fit into memory"
        )
    yield f"files: {', '.join(report['files'])}"


_NUMBERS = ("n", "r", "95 % interval")
_PUBLISHED = "published, experiment 1"


def _table(title: str, heading: str, *numbers: str) -> Table:
    return result_table(heading, "judgments of", *numbers, title=title, right=numbers)


def _add(table: Table, name: str, pairs: Mapping[str, Any], *, published: bool = True) -> None:
    for about, each in pairs.items():
        cells = [name, about, str(each["judgments"]), _r_text(each["r"])]
        cells.append(_interval_text(each["interval"]) if each["interval"] else "")
        if published:
            cells.append("" if each["published"] is None else str(each["published"]))
        table.add_row(*cells)


def _alone(judgments: Sequence[Judgment]) -> Table:
    """Return the model's judgments of films that people did not judge."""
    shown: list[JudgedPart] = [a for a in ABOUT if any(a in each.model for each in judgments)]
    table = result_table("film", *shown, title="films without judgments of people")
    for each in judgments:
        cells = [_means(each, about) for about in shown]
        table.add_row(_film_text(each.film), *cells)
    return table


def _film_text(film: Film) -> str:
    return film.name if film.scored else f"{film.name} (not scored)"


def _means(judgment: Judgment, about: JudgedPart) -> str:
    digits = 1 if about == "desires" else 3
    means = judgment.model.get(about, {})
    return ", ".join(f"{name} {value:.{digits}f}" for name, value in means.items())


def _r_text(r: float | None) -> str:
    return "none" if r is None else f"{r:.3f}"


def _interval_text(ends: tuple[float, float]) -> str:
    return f"{ends[0]:.3f} to {ends[1]:.3f}"
