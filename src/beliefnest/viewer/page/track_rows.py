"""Tracks as rows of plain data: at first all rows, later the new ones."""

from collections.abc import Mapping, Sequence
from typing import Any

from beliefnest.viewer.page.pose_history import PoseRow, Stand
from beliefnest.viewer.page.tracks import PLACED, Track

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


def fresh_rows(sent: dict[str, int], name: str, rows: Sequence[Any]) -> list[Any] | None:
    """Return the number of the first new row of a list that only grows, and its new rows."""
    first = sent.get(name, 0)
    sent[name] = len(rows)
    return [first, list(rows[first:])] if first < len(rows) else None


class TrackRows:
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


class StandRows:
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
