"""Films of simulators: pictures over time with captions, as participants see them."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence

import msgspec
from msgspec.structs import replace

from beliefnest.nest.face.nest import Nest
from beliefnest.pictures.still import draw_still
from beliefnest.pictures.svg import svg_text
from beliefnest.prompts.story_filters import captions
from beliefnest.world.paths import parse_path
from beliefnest.world.values import Position

_MOST = 60
"""Greatest number of pictures without a new caption."""
_TICK_MS = 50
_SHORTEST_MS = 200
_LONGEST_MS = 1_500
_LETTER_MS = 60
"""Time to read one letter: about 200 words a minute."""
_CAPTION_MS = 700
"""Time to notice a new caption."""


class FilmFrame(msgspec.Struct, frozen=True):
    """Part of a film during which nothing changes.

    Attributes:
        picture: Index of its picture.
        ms: Duration in milliseconds.
        caption: What has happened last, in words.
    """

    picture: int
    ms: int
    caption: str


class SceneFilm(msgspec.Struct, frozen=True):
    """Film of one simulator.

    Attributes:
        pictures: SVG texts of one size, each once.
        frames: Frames in the order of time.
    """

    pictures: tuple[str, ...]
    frames: tuple[FilmFrame, ...]


def read_film(nest: Nest, path: str, start: int) -> SceneFilm:
    """Return the film of a simulator until now.

    The pictures show the simulator alone: false beliefs are not marked.

    Args:
        nest: The nest after the script.
        path: Belief path of the simulator.
        start: First tick.
    """
    view = nest[path].view
    changes = nest[path].changes(start)
    # A mind does not notice that time goes on after its last percept.
    end = nest.tick if view.owner is None else changes[-1]
    texts: dict[int, str] = {}
    for tick, sentence in captions(view):
        then = min(tick, end)
        texts[then] = f"{texts[then]} {sentence}" if then in texts else sentence
    ticks = sorted({*changes[:: max(1, math.ceil(len(changes) / _MOST))], *texts, end})
    pictures = _pictures(nest, path, ticks, view.names)
    times = _durations(ticks, texts)
    words: Iterator[str] = itertools.accumulate(
        (texts.get(tick, "") for tick in ticks), lambda before, now: now or before
    )
    distinct = list(dict.fromkeys(pictures))
    frames = [
        FilmFrame(distinct.index(picture), ms, caption)
        for picture, ms, caption in zip(pictures, times, words, strict=True)
    ]
    return SceneFilm(tuple(distinct), tuple(_joined(frames)))


def _durations(ticks: Sequence[int], texts: Mapping[int, str]) -> list[int]:
    """Return the duration of each picture; one with a new caption can be read."""
    spans = [later - tick for tick, later in itertools.pairwise(ticks)]
    usual = [min(_LONGEST_MS, max(_SHORTEST_MS, span * _TICK_MS)) for span in spans]
    reading = [
        _CAPTION_MS + _LETTER_MS * len(texts[tick]) if tick in texts else 0 for tick in ticks
    ]
    return [max(pair) for pair in zip([*usual, _LONGEST_MS], reading, strict=True)]


def _pictures(
    nest: Nest, path: str, ticks: Sequence[int], names: Mapping[Position, str]
) -> list[str]:
    """Return the SVG text of each tick; all have the same size and show the same storey."""
    (last,) = nest.scenes(path, nest.tick, path)
    parsed = parse_path(path, nest.agents)
    # An agent's own sight is part of what it perceives. A narrator sees all.
    sight: list[str] | None = None if parsed else []
    drawings = []
    for tick in ticks:
        (scene,) = nest.scenes(path, tick, path, sight=sight, height=last.height)
        drawings.append(draw_still(scene, names))
    height = max(each.height for each in drawings)
    return [svg_text(replace(each, height=height)) for each in drawings]


def _joined(frames: Sequence[FilmFrame]) -> list[FilmFrame]:
    """Return frames without repetitions: equal neighbours become one."""
    shown: list[FilmFrame] = []
    for frame in frames:
        if shown and (shown[-1].picture, shown[-1].caption) == (frame.picture, frame.caption):
            shown[-1] = replace(shown[-1], ms=shown[-1].ms + frame.ms)
        else:
            shown.append(frame)
    return shown
