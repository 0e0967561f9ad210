"""Run as the page's data: everything at first, then the updates with their new rows."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec
from msgspec.structs import asdict

from beliefnest.belief.node_memory import paths_with_room
from beliefnest.nest.face.reader import Reader
from beliefnest.pictures.palette import MARKS, agent_looks
from beliefnest.timeline.journal import TimelineInfo, TimelineKey
from beliefnest.timeline.run_records import ProgramRecord, PromptRecord
from beliefnest.viewer.page.blocks import BlockPalette
from beliefnest.viewer.page.pose_history import PoseBook, PoseRow, Stand
from beliefnest.viewer.page.tracks import PLACED, Onlooker, Track, TrackRecorder
from beliefnest.world.event_words import happens
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.values import Position

_THOUSAND = 1000


class _Sent:
    """Number of rows of each list that were sent, and the last one."""

    def __init__(self) -> None:
        self._done: dict[str, tuple[int, Any]] = {}

    def fresh(self, name: str, rows: Sequence[Any]) -> tuple[int, Sequence[Any]] | None:
        """Return the number of the first new row, and the new rows; None if there are none."""
        count, last = self._done.get(name, (0, None))
        # A row has the last change of its tick, so the last row may have been replaced.
        first = count - 1 if count and rows[count - 1] != last else count
        if first == len(rows):
            return None
        self._done[name] = (len(rows), rows[-1])
        return first, rows[first:]


def _fresh_rows(sent: dict[str, int], name: str, rows: Sequence[Any]) -> list[Any] | None:
    """Return the number of the first new row of a list that only grows, and its new rows."""
    first = sent.get(name, 0)
    sent[name] = len(rows)
    return [first, list(rows[first:])] if first < len(rows) else None


class _TrackRows:
    """Updates of one track."""

    def __init__(self, track: Track) -> None:
        self._track = track
        self._sent = _Sent()
        self._begun = False

    def update(self) -> dict[str, Any]:
        """Return the new rows by list: `[number of its first row, rows]`; empty if none."""
        track = self._track
        update: dict[str, Any] = {}
        if not self._begun:
            self._begun = True
            update["grid"] = track.grid
        names = ("blocks", "items", "wrong", "heard", "claims")
        lists: dict[str, Sequence[Any]] = {name: getattr(track, name) for name in names}
        for part in ("agents", "holds", "owns"):
            lists |= {f"{part} {n}": rows for n, rows in enumerate(getattr(track, part))}
        lists |= {f"contents {cell}": rows for cell, rows in track.contents.items()}
        agents = {f"agents {n}" for n in range(len(track.agents))}
        for name, rows in lists.items():
            fresh = self._sent.fresh(name, rows)
            if fresh is not None:
                update[name] = [fresh[0], [*map(_told, fresh[1])] if name in agents else fresh[1]]
        return update


def _told(row: Any) -> Any:
    if row[1] == PLACED:
        tick, code, seen, pose, *more = row
        return [tick, code, seen, _rounded(pose), *more]
    return row


class _StandRows:
    """Updates of one agent's poses, in columns of differences."""

    def __init__(self, stand: Stand) -> None:
        self._stand = stand
        self._sent = 0

    def update(self) -> Mapping[str, Any] | None:
        """Return columns `t`, `x`, `y`, `z`, `yaw`, `pitch` (thousandths); None if nothing is new.

        Each number except the first is the difference from the one before. `gone` lists the rows in
        which the agent is absent.
        """
        first, ticks = self._sent, self._stand.ticks
        if first == len(ticks):
            return None
        self._sent = len(ticks)
        poses = self._stand.poses[first:]
        rows = [_rounded(pose) if pose is not None else [0] * 5 for pose in poses]
        names = ("x", "y", "z", "yaw", "pitch")
        columns = {name: _steps([row[at] for row in rows]) for at, name in enumerate(names)}
        gone = [number for number, pose in enumerate(poses) if pose is None]
        return {"from": first, "t": _steps(ticks[first:]), **columns, "gone": gone}


def _rounded(pose: PoseRow | Sequence[float]) -> list[int]:
    return [round(_THOUSAND * value) for value in pose]


def _steps(values: Sequence[int]) -> list[int]:
    return [value - before for value, before in zip(values, [0, *values[:-1]], strict=True)]


Onlookers = Callable[[TimelineInfo, Sequence[BeliefPath]], Onlooker]


class About(msgspec.Struct, frozen=True):
    """Names and texts about a run, for people.

    Attributes:
        title: Name of the scenario.
        subtitle: Distinguishing feature of the run, such as its condition.
        description: Subject of the scenario.
        labels: Names of containers and places.
        paths: Beliefs that the scenario asks about; they are shown from the start.
        episode: Function that returns the present rounds of the run's episode as plain values, or
            None if there is none: `task`, `instance`, `start` (a tick), `rounds` (the largest
            number), and `branches` by name, each with `policies`, `goal` (words, whether it must
            never come true, tick or None), `reached`, `violated` (ticks or None) and `parts`
            (`round`, `t`, `end`, `agents` with `agent`, `program`, `goes_on`, `fault`, `ended`,
            `message`, `reason`).
        inferences: Function that returns the posteriors to show, as `told_inference` does.
    """

    title: str
    subtitle: str = ""
    description: str = ""
    labels: Mapping[Position, str] = msgspec.field(default_factory=dict)
    paths: tuple[BeliefPath, ...] = ()
    episode: Callable[[], Mapping[str, Any] | None] = msgspec.field(default=lambda: None)
    inferences: Callable[[], Sequence[Mapping[str, Any]]] = msgspec.field(default=tuple)


@dataclass
class _Line:
    """Recorded timeline: its recorders, and what was sent of it."""

    info: TimelineInfo
    book: PoseBook
    recorders: list[TrackRecorder]
    tracks: dict[BeliefPath, _TrackRows]
    stands: list[_StandRows]
    entries: int = 0
    claims: int = 0
    events: list[dict[str, Any]] = field(default_factory=list)
    sent: dict[str, int] = field(default_factory=dict)
    told: Any = None


class RunData:
    """Data of one run for one page, which grows with the run.

    Args:
        reader: Reader of the nest.
        about: Names and texts about the run.
        depth: Depth of the real world's beliefs that are recorded from the start.
        onlookers: Makes onlookers, which see the first nodes of a timeline while they are recorded.
    """

    def __init__(
        self, reader: Reader, about: About, depth: int = 2, onlookers: Onlookers | None = None
    ) -> None:
        self.reader, self.about, self.depth = reader, about, depth
        self._onlookers = onlookers
        self._palette = BlockPalette(reader.history.context)
        self._lines: dict[TimelineKey, _Line] = {}
        self._sent: dict[str, int] = {}
        self._begun = False
        self._episode: Mapping[str, Any] | None = None

    def update(self) -> dict[str, Any]:
        """Return the updates since the last call, at first everything; empty if there are none."""
        new: dict[str, Any] = {}
        lines = {}
        infos = self.reader.timelines()
        for info in infos:
            line = self._lines.get(info.key) or self._begin(info)
            line.info = info
            line_update = self._line_update(line)
            if line_update:
                lines[str(self.keys().index(info.key))] = line_update
        if lines:
            new["timelines"] = lines
        records: dict[str, list[Any]] = {
            "states": self._palette.entries,
            "programs": [_program(each) for each in self.reader.programs()],
            "prompts": [_prompt(each) for each in self.reader.prompts()],
        }
        for name, rows in records.items():
            fresh = _fresh_rows(self._sent, name, rows)
            if fresh is not None:
                new[name] = fresh
        episode = self.about.episode()
        if episode != self._episode:
            self._episode = new["episode"] = episode
        if not self._begun:
            self._begun = True
            new["head"] = self._head()
        return new

    def deepen(self, key: TimelineKey, path: BeliefPath) -> None:
        """Record one more node of a timeline from now on; the next update contains all of it."""
        line = self._lines[key]
        if path not in line.tracks:
            recorder = TrackRecorder(
                self.reader, key, [path], line.book, self._palette, fills=False
            )
            line.recorders.append(recorder)
            line.tracks[path] = _TrackRows(recorder.tracks[0])

    def nodes(self) -> Iterable[tuple[TimelineInfo, BeliefPath]]:
        """Return everything recorded: each timeline with each of its nodes, shallow ones first."""
        for line in self._lines.values():
            for path in line.tracks:
                yield line.info, path

    def _head(self) -> dict[str, Any]:
        reader, about = self.reader, self.about
        box = reader.setting.snapshot.box
        looks = agent_looks(reader.agents)
        return {
            "title": about.title,
            "subtitle": about.subtitle,
            "description": about.description,
            "seed": reader.seed,
            "agents": [asdict(looks[name]) for name in reader.agents],
            "marks": {mark.value: asdict(look) for mark, look in MARKS.items()},
            "box": {"low": box.low, "shape": box.shape},
            "places": [[*place, name] for name, place in sorted(reader.setting.places.items())],
            "labels": [[*place, label] for place, label in sorted(about.labels.items())],
            "asked": [path_text(path) for path in about.paths],
            "inferences": about.inferences(),
        }

    def _begin(self, info: TimelineInfo) -> _Line:
        base = None if info.base is None else self._lines[info.base.timeline].book
        book = PoseBook(len(self.reader.agents), info.start, base)
        own = info.key.path
        deep = max(1, self.depth - len(own))
        context = self.reader.history.context
        paths = paths_with_room(context, own, deep if own else self.depth)
        asked = [path for path in self.about.paths if path[: len(own)] == own]
        paths += [path for path in dict.fromkeys(asked) if path not in paths]
        onlooker = None if self._onlookers is None else self._onlookers(info, paths)
        recorder = TrackRecorder(
            self.reader, info.key, paths, book, self._palette, onlooker=onlooker
        )
        tracks = {track.path: _TrackRows(track) for track in recorder.tracks}
        stands = [_StandRows(stand) for stand in book.stands]
        self._lines[info.key] = _Line(info, book, [recorder], tracks, stands)
        return self._lines[info.key]

    def keys(self) -> Sequence[TimelineKey]:
        """Return the timelines, in the order of the page's numbers."""
        return list(self._lines)

    def _line_update(self, line: _Line) -> dict[str, Any]:
        for recorder in line.recorders:
            recorder.advance(line.info.entries)
        update: dict[str, Any] = {}
        facts = self._facts(line.info)
        if facts != line.told:
            line.told = facts
            update["facts"] = facts
        self._read_events(line)
        events = _fresh_rows(line.sent, "events", line.events)
        if events is not None:
            update["events"] = events
        poses = {n: rows.update() for n, rows in enumerate(line.stands)}
        if any(rows is not None for rows in poses.values()):
            update["poses"] = {str(n): rows for n, rows in poses.items() if rows is not None}
        tracks = {path_text(path): rows.update() for path, rows in line.tracks.items()}
        if any(tracks.values()):
            update["tracks"] = {path: rows for path, rows in tracks.items() if rows}
        return update

    def _facts(self, info: TimelineInfo) -> dict[str, Any]:
        base, keys = info.base, self.keys()
        return {
            "path": path_text(info.key.path),
            "branch": info.key.branch,
            "base": None if base is None else {"timeline": keys.index(base.timeline)},
            "start": info.start,
            "head": info.head,
            "description": info.description,
            "selected": info.key in self.reader.selected(),
        }

    def _read_events(self, line: _Line) -> None:
        labels = self.about.labels
        for entry in self.reader.entries(line.info.key, line.entries, line.info.entries):
            for event in entry.events if isinstance(entry, Frame) else ():
                place = event.detail.get("position")
                wrote = bool(event.actor) and "text" in event.detail
                row: dict[str, Any] = {
                    "t": entry.tick,
                    "actor": event.actor,
                    "text": happens(event, labels),
                    "spoken": event.kind.is_speech,
                    "listed": event.kind.traits.is_deed or wrote,
                }
                if place is not None:
                    row["at"] = list(place)
                line.events.append(row)
        line.entries = line.info.entries
        recorder = line.recorders[0]
        for number, claim, kind in recorder.claims[line.claims :]:
            # Without labels: whoever heard the claim need not know them.
            line.events[number].setdefault("claims", []).append([str(claim), kind])
        line.claims = len(recorder.claims)


def _program(record: ProgramRecord) -> dict[str, Any]:
    return {
        "path": path_text(record.path),
        "branch": record.branch,
        "agent": record.agent,
        "t": record.tick,
        "ticks": record.ticks,
        "ok": record.ok,
        "error": record.error,
        "code": record.code,
        "log": list(record.log),
        "lines": list(record.lines),
    }


def _prompt(record: PromptRecord) -> dict[str, Any]:
    return {
        "path": path_text(record.path),
        "at": path_text(record.timeline.path),
        "branch": record.timeline.branch,
        "t": record.tick,
        "model": record.model,
        "attempt": record.attempt,
        "messages": [list(message) for message in record.messages],
        "answer": record.answer,
        "error": record.error,
        "task": record.detail.get("task", ""),
    }
