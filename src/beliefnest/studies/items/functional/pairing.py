"""Literal and functional items side by side: one model, the same instances, the same tick."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from beliefnest.errors import InputError, ModelError
from beliefnest.plan.jobs import OnStudyProgress
from beliefnest.scenarios.record_forms import checked_form, read_json
from beliefnest.studies.accuracy_figure import plot_accuracy
from beliefnest.studies.clusters import exchange_p, rate_interval
from beliefnest.studies.items.asking import check_readers
from beliefnest.studies.items.functional.certifying import Certificate
from beliefnest.studies.items.functional.siblings import TaskFamily
from beliefnest.studies.study import Study
from beliefnest.world.texts import quoted

if TYPE_CHECKING:  # matplotlib is optional, and imported when something is plotted.
    from matplotlib.figure import Figure

FUNCTIONAL = "functional.json"
"""Name of the file of certificates and pairs."""

Outcomes = Mapping[int, Sequence[bool]]
"""Right or wrong by instance, for each repeat."""


class LiteralFunctionalPair(msgspec.Struct, frozen=True):
    """Outcomes of a model on the same instances of a family.

    Attributes:
        family: Name of the family; empty: several.
        order: Order that the family needs.
        literal: Answers to the question about the belief.
        functional: Episodes from the same tick in which the belief is needed.
    """

    family: str
    order: int
    literal: Outcomes
    functional: Outcomes

    def plain(self) -> dict[str, Any]:
        """Return rates, those of any and of all repeats, and the test of their difference."""
        balance = [sum(self.literal[n]) - sum(self.functional[n]) for n in self.literal]
        return {
            "family": self.family,
            "order": self.order,
            "instances": len(self.literal),
            "repeats": len(next(iter(self.literal.values()))),
            "literal": _rates(self.literal),
            "functional": _rates(self.functional),
            "difference": sum(balance) / sum(map(len, self.literal.values())),
            "p": exchange_p(balance),
        }


def _rates(outcomes: Outcomes) -> dict[str, float]:
    each = list(outcomes.values())
    low, high, _ = rate_interval(each)
    return {
        "rate": sum(map(sum, each)) / sum(map(len, each)),
        "low": low,
        "high": high,
        "pass_at_k": sum(map(any, each)) / len(each),
        "pass_hat_k": sum(map(all, each)) / len(each),
    }


def paired(
    family: TaskFamily,
    model: str,
    seeds: Sequence[int],
    repeats: int,
    folder: Path,
    jobs: int,
    on_progress: OnStudyProgress,
) -> LiteralFunctionalPair:
    """Ask a model the question of each instance, and let it play the episode from there.

    In the episode the model gets its agent's own belief and what happened (`model:MODEL:0`), as in
    the story of the question; nobody tells it what others believe.

    Args:
        family: The family; its file has one probe with a question.
        model: Name of the model.
        seeds: Instances.
        repeats: Times that each instance is asked and played.
        folder: Folder of answers and episodes; what is in it is not played again.
        jobs: Number of processes.
        on_progress: Function that receives the progress.

    Raises:
        ModelError: An answer or an episode has no result.
    """
    first = family.instance(seeds[0])
    drawn = {seed: family.values(seed) for seed in seeds}
    wanted = {_key(values) for values in drawn.values()}
    names = list(drawn[seeds[0]])
    conditions = None if family.condition is None else [family.condition]
    asked = Study(
        [family.name],
        models=[model],
        repeats=repeats,
        variations={name: _once(v[name] for v in drawn.values()) for name in names},
        constraints=[lambda values: _key({name: values[name] for name in names}) in wanted],
        conditions=conditions,
        world="scripted",
    )
    played = Study(
        tasks=[family.name],
        models=[model],
        orders=[0],
        repeats=repeats,
        seeds=list(seeds),
        conditions=conditions,
    )
    answers = _outcomes(asked, folder / "literal", jobs, on_progress)
    episodes = _outcomes(played, folder / "functional", jobs, on_progress)
    return LiteralFunctionalPair(
        first.name,
        first.order,
        {seed: answers[_key(values)] for seed, values in drawn.items()},
        {seed: episodes[str(seed)] for seed in seeds},
    )


def _key(values: Mapping[str, Any]) -> str:
    return json.dumps(dict(values), sort_keys=True)


def _once(values: Iterator[Any]) -> list[Any]:
    return list({json.dumps(value): value for value in values}.values())


def _outcomes(
    study: Study, folder: Path, jobs: int, on_progress: OnStudyProgress
) -> dict[str, list[bool]]:
    """Return outcomes by the key of a variation, or by the number of an instance."""
    result = study.run(folder, jobs, on_progress=on_progress)
    for why in result.failed.values():
        raise ModelError(f"{folder}: a cell has no result: {why}")
    keys = {cell["name"]: cell["key"] for cell in result.plan["cells"]}
    outcomes: dict[str, list[bool]] = {}
    for row in result.rows:
        key = keys[row["cell"]]
        of = str(key["instance"]) if "instance" in key else _key(key["variation"])
        outcomes.setdefault(of, []).append(row["ok"])
    return outcomes


def by_order(pairs: Sequence[LiteralFunctionalPair]) -> list[LiteralFunctionalPair]:
    """Return the outcomes of all families together, a pair for each order."""
    orders = sorted({each.order for each in pairs})
    return [_together(order, [each for each in pairs if each.order == order]) for order in orders]


def _together(order: int, pairs: Sequence[LiteralFunctionalPair]) -> LiteralFunctionalPair:
    """Return the pair of several families; their instances are numbered anew."""
    literal = dict(enumerate(v for each in pairs for v in each.literal.values()))
    functional = dict(enumerate(v for each in pairs for v in each.functional.values()))
    return LiteralFunctionalPair("", order, literal, functional)


class _Rate(msgspec.Struct):
    rate: float


class OrderGap(msgspec.Struct):
    """Row of `functional.json`: rates of a model on the same instances.

    Attributes:
        family: Name of the family; empty: all families of the order.
        order: Order that the family needs.
        literal: Rate of right answers to questions.
        functional: Rate of episodes won.
        difference: Literal minus functional.
        p: Probability of at least this difference by chance.
    """

    family: str
    order: int
    literal: _Rate
    functional: _Rate
    difference: float
    p: float


class _FunctionalForm(msgspec.Struct):
    model: str = ""
    pairs: list[OrderGap] = []


def check_answerer(folder: Path, model: str | None) -> None:
    """Check the model of a pair before anything is played.

    Args:
        folder: Folder of the certificates.
        model: Name of the model; None: none is asked.

    Raises:
        InputError: The model cannot read questions, or the folder has figures of another one, or
            such that cannot be read.
    """
    check_readers([] if model is None else [model])
    if not (folder / FUNCTIONAL).exists():
        return
    there = _read(folder).model
    if there not in ("", model):
        raise InputError(
            f"{folder} has figures of {quoted(there)}, which this would replace; add "
            f"`--model {there}`, or name another folder: `-o {folder}-2`"
        )


def read_gaps(folder: Path) -> tuple[str, dict[int, OrderGap]]:
    """Return the model of a folder of functional items, and its gap at each order.

    Raises:
        InputError: The folder holds none, or no model was asked.
    """
    results = _read(folder)
    if not results.model:
        raise InputError(
            f"{folder} has no model: run `beliefnest items STUDY -o {folder} --functional "
            "--model M`"
        )
    return results.model, {each.order: each for each in results.pairs if not each.family}


def _read(folder: Path) -> _FunctionalForm:
    file = folder / FUNCTIONAL
    write = f"write it with `beliefnest items STUDY -o {folder} --functional --model M`"
    if not file.is_file():
        raise InputError(f"there is no {file}; {write}")
    again = f"delete it, and {write}"
    content = read_json(file, again)
    checked_form(content, _FunctionalForm, file, again)
    return msgspec.convert(content, _FunctionalForm)


def plot_pairs(
    pairs: Sequence[LiteralFunctionalPair], certificates: Sequence[Certificate]
) -> "Figure":
    """Draw literal beside functional by order, with lines for chance and for search.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    groups = [
        {
            "order": pair.order,
            "items": kind,
            "accuracy": rates["rate"],
            "low": rates["low"],
            "high": rates["high"],
            "chance": _mean(c.bound for c in certificates if c.order == pair.order),
            "judged": rates["instances"],
        }
        for pair in by_order(pairs)
        for kind in ("literal", "functional")
        for rates in [{**pair.plain()[kind], "instances": len(pair.literal)}]
    ]
    figure = plot_accuracy(groups, ("order", "items"))
    (axes,) = figure.axes
    for place, pair in enumerate(by_order(pairs)):
        solved = [c.solved[0] / c.solved[1] for c in certificates if c.order == pair.order]
        height = sum(solved) / len(solved)
        name = None if place else "search of the order"
        axes.plot([place - 0.45, place + 0.45], [height] * 2, color="#333333", label=name)
    axes.legend(frameon=False)
    return figure


def _mean(values: Iterator[float | None]) -> float | None:
    numbers = [value for value in values if value is not None]
    return sum(numbers) / len(numbers) if numbers else None
