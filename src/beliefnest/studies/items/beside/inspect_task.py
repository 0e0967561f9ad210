"""The items of this folder as a task of Inspect AI: `inspect eval inspect_task.py --model ...`."""

from pathlib import Path
from typing import Any

from inspect_ai import Task, task
from inspect_ai.dataset import Sample, json_dataset
from inspect_ai.scorer import choice, grouped, mean, stderr
from inspect_ai.solver import multiple_choice

ITEMS = Path(__file__).parent / "items.jsonl"


def sample(item: dict[str, Any]) -> Sample:
    """Return an item as a sample of a question with options."""
    return Sample(
        id=item["id"],
        input=f"{item['text']}\n\n{item['question']}",
        choices=item["options"],
        target=chr(ord("A") + item["options"].index(item["right"])),
        metadata={name: item[name] for name in ("family", "order", "kind", "skeleton", "chance")},
    )


@task
def items() -> Task:
    """Questions with options; accuracy by order, with errors clustered by skeleton."""
    every = json_dataset(str(ITEMS), lambda item: sample(item) if item["options"] else [])
    return Task(
        dataset=every,
        solver=multiple_choice(),
        scorer=choice(),
        metrics=[grouped(mean(), "order"), stderr(cluster="skeleton")],
    )
