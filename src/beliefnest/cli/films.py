"""`beliefnest suite food-trucks`: films acted out and judged, beside the judgments of people."""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Any

import msgspec
from rich.table import Table

from beliefnest.cli.console import Printed, print_report, result_table
from beliefnest.cli.options import SuiteOptions
from beliefnest.cli.playing import playing, status_of, write_tables
from beliefnest.errors import InputError, MissingExtraError
from beliefnest.pictures.scatter import Dot, ScatterPanel, ScatterRow, scatter_figure
from beliefnest.studies.suite_playing import play_suite
from beliefnest.suites import FILMS
from beliefnest.suites.films.agreement import PUBLISHED, JudgesAgreement, agreement, interval
from beliefnest.suites.films.cells import FILM_KIND, film_cells
from beliefnest.suites.films.film import (
    ABOUT,
    WHOLE,
    Film,
    FilmParameters,
    FilmRow,
    JudgedPart,
    grid_for,
)
from beliefnest.suites.films.film_files import read_films
from beliefnest.suites.films.film_inference import LESIONS, Lesion

_MODELS: tuple[Lesion | None, ...] = (None, *LESIONS)
_WORDS: Mapping[Lesion | None, str] = {
    None: "inverse planning",
    "true_belief": "true belief",
    "no_cost": "no cost",
}
_AXES: Mapping[JudgedPart, tuple[str, str]] = {
    "desires": ("model: expected utility", "people: rating"),
    "beliefs": ("model: expected credence", "people: credence"),
    "locations": ("model: probability", "people: probability"),
}


JudgedFilms = Mapping[Lesion | None, Sequence[FilmRow]]
"""Rows of the films, by the part that is taken out of the model; None: the whole model."""


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
    folder = options.out or Path("suites", f"{FILMS}-{datetime.now():%Y%m%d-%H%M%S}")
    cells = film_cells(FILMS, films, parameters)
    about = {"suites": [FILMS], "data": str(options.path), "world": "scripted"}
    with playing(FILMS, folder) as (place, on_progress):
        result = play_suite(place, FILM_KIND, cells, about, (), on_progress)
    complete = [row for row in result.rows if row["model"] is not None]
    own = msgspec.convert(complete, list[FilmRow])
    judged = {each: [row for row in own if row.variant == _key(each)] for each in _MODELS}
    write_tables(result)
    report = _report(options, films, judged, parameters)
    report["files"] = [str(folder / "rows.csv"), *_write(folder, options, judged)]
    print_report(report, _parts(films, judged, report), as_json=options.json)
    return status_of(result)


def _report(
    options: SuiteOptions,
    films: Sequence[Film],
    judged: JudgedFilms,
    parameters: FilmParameters,
) -> dict[str, Any]:
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
                    [row for row in judged[None] if row.group == group], None, options.seed
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
            row.film: row.impossible for row in judged[None] if row.impossible is not None
        },
        "judgments": [_judgment(film, judged[None]) for film in films],
    }


def _key(lesion: Lesion | None) -> str:
    return lesion or WHOLE


def _correlations(rows: Sequence[FilmRow], lesion: Lesion | None, seed: int) -> dict[str, Any]:
    """Return correlations with the judgments of people, with intervals, by what was judged."""
    correlations: dict[str, Any] = {}
    for about in ABOUT:
        pairs = agreement(rows, about)
        if not len(pairs.model):
            continue
        correlations[about] = {
            "r": None if math.isnan(pairs.r) else pairs.r,
            "interval": interval(pairs, seed),
            "judgments": len(pairs.model),
            "published": PUBLISHED[lesion].get(about),
        }
    return correlations


def _judgment(film: Film, rows: Sequence[FilmRow]) -> dict[str, Any]:
    own = {about: _means(film, rows, about) for about in ABOUT}
    return {
        "film": film.name,
        "group": film.group or None,
        "scored": film.scored,
        "model": {about: means for about, means in own.items() if means},
        "people": film.people,
    }


def _write(folder: Path, options: SuiteOptions, judged: JudgedFilms) -> list[str]:
    """Write the figure, if people judged, and return its files: a PDF only with reportlab."""
    written = []
    rows = _scatter_rows(judged, options.seed)
    if rows:
        figure = scatter_figure(rows, f"Model and people, {options.path.name}")
        for ending in ("svg", "pdf", "png"):
            file = folder / f"scatter.{ending}"
            with suppress(MissingExtraError):
                figure.save(file)
                written.append(str(file))
    return written


def _scatter_rows(judged: JudgedFilms, seed: int) -> list[ScatterRow]:
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
    films: Sequence[Film], judged: JudgedFilms, report: Mapping[str, Any]
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
    alone = [film for film in films if not film.people]
    if alone:
        yield _alone(alone, judged[None])
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


def _alone(films: Sequence[Film], rows: Sequence[FilmRow]) -> Table:
    """Return the model's judgments of films that people did not judge."""
    shown = [a for a in ABOUT if any(_means(film, rows, a) for film in films)]
    table = result_table("film", *shown, title="films without judgments of people")
    for film in films:
        name = film.name if film.scored else f"{film.name} (not scored)"
        table.add_row(name, *(_means_text(_means(film, rows, about), about) for about in shown))
    return table


def _means(film: Film, rows: Sequence[FilmRow], about: JudgedPart) -> dict[str, float]:
    own = (row for row in rows if (row.film, row.about) == (film.name, about))
    return {row.name: row.model for row in own}


def _means_text(means: Mapping[str, float], about: JudgedPart) -> str:
    digits = 1 if about == "desires" else 3
    return ", ".join(f"{name} {value:.{digits}f}" for name, value in means.items())


def _r_text(r: float | None) -> str:
    return "none" if r is None else f"{r:.3f}"


def _interval_text(ends: tuple[float, float]) -> str:
    return f"{ends[0]:.3f} to {ends[1]:.3f}"
