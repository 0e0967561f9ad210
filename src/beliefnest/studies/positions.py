"""Answers by the position of options: where the right option stood, and which one was chosen."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from beliefnest.studies.clusters import rate_interval
from beliefnest.studies.counting import Row


def choices_of(rows: Sequence[Row], content: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the answers of one cell to questions with options.

    Args:
        rows: Rows of the cell, one for each probe.
        content: Content of the cell's file.

    Yields:
        The probe's row with `question`; `options` (their number); `right_at` and `chosen_at`,
        positions from 1 in the order of the prompt. `right_at` is None if several options are
        right, `chosen_at` if there was no usable answer.
    """
    for row, probe in zip(rows, content.get("probes", []), strict=False):
        right = _right_answers(probe)
        for reply in probe["replies"]:
            options = reply.get("options") or []
            if not options:
                continue
            places = [
                n for n, each in enumerate(options, 1) if each in right.get(reply["question"], ())
            ]
            answer = reply["answer"]
            yield {
                **row,
                "question": reply["question"],
                "options": len(options),
                "right_at": places[0] if len(places) == 1 else None,
                "chosen_at": options.index(answer) + 1 if answer in options else None,
            }


def _right_answers(probe: Mapping[str, Any]) -> dict[str, list[str]]:
    """Return the right answers of a probe's questions, by question."""
    asked = (
        each for check in probe.get("checks", []) for each in check["expected"].get("answers", [])
    )
    return {each["question"]: list(each["right"]) for each in asked}


def count_positions(
    choices: Sequence[Mapping[str, Any]], by: Sequence[str]
) -> list[dict[str, Any]]:
    """Count which position was chosen for each position of the right option.

    Args:
        choices: Answers, as `choices_of` yields them.
        by: Columns that define the groups.

    Returns:
        A row for each group, number of options and position of the right option, in this order:
        the columns of `by`; `options`; `right_at`; `asked`; `variations`; `right`; `accuracy` with
        `low` and `high` (95 %, clustered by variation); `chosen_1` and so on; `none` (no usable
        answer). Questions with several right options are left out.
    """
    with_right = [each for each in choices if each["right_at"] is not None]
    widest = max((each["options"] for each in with_right), default=0)
    groups: dict[tuple[Any, ...], list[Mapping[str, Any]]] = {}
    for each in with_right:
        groups.setdefault(tuple(each.get(name) for name in by), []).append(each)
    counted = []
    for values, group in groups.items():
        cells: dict[tuple[int, int], list[Mapping[str, Any]]] = {}
        for each in group:
            cells.setdefault((each["options"], each["right_at"]), []).append(each)
        for (options, right_at), answers in sorted(cells.items(), key=lambda cell: cell[0]):
            head = {**dict(zip(by, values, strict=True)), "options": options, "right_at": right_at}
            counted.append({**head, **_counted(answers, right_at, widest)})
    return counted


def _counted(answers: Sequence[Mapping[str, Any]], right_at: int, widest: int) -> dict[str, Any]:
    clusters: dict[object, list[bool]] = {}
    for each in answers:
        clusters.setdefault(each["variation"], []).append(each["chosen_at"] == right_at)
    low, high, _ = rate_interval(list(clusters.values()))
    chosen = Counter(each["chosen_at"] for each in answers)
    return {
        "asked": len(answers),
        "variations": len(clusters),
        "right": chosen[right_at],
        "accuracy": chosen[right_at] / len(answers),
        "low": low,
        "high": high,
        **{f"chosen_{number}": chosen[number] for number in range(1, widest + 1)},
        "none": chosen[None],
    }
