"""The items of this folder that the LM Evaluation Harness can ask."""

from datasets import Dataset


def with_options(items: Dataset) -> Dataset:
    """Return the questions with options."""
    return items.filter(lambda item: bool(item["options"]))
