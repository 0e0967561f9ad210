"""Items that models are asked as text; their answers."""

from collections.abc import Iterable
from string import ascii_uppercase

import jinja2
import msgspec

from beliefnest.errors import InputError
from beliefnest.llm.failures import UnusableAnswerError
from beliefnest.llm.messages import Answer, Message, Model, Sampling
from beliefnest.llm.reading_answers import read_answer
from beliefnest.prompts import built_in_template
from beliefnest.studies.items.record import ItemRecord
from beliefnest.world.texts import quoted


class ItemAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """Answer of a model to an item.

    Attributes:
        id: Id of the item.
        model: Name of the model.
        answered: Option that the answer names; None: it names none, or several.
        ok: True if the answer is right.
        outcome: `ok`, `wrong`, or why there is no answer: `ambiguous`, `unread`, `cut`, `refused`,
            `no_answer`.
        why_not: Why the answer is not right; empty: it is.
        finish: Reason for the end of the answer; empty: no answer came.
        text: Complete text of the answer.
        tokens: Tokens sent and received.
        cost: Cost in US dollars; None: not known.
    """

    id: str
    model: str
    answered: str | None
    ok: bool
    outcome: str
    why_not: str
    finish: str
    text: str
    tokens: int = 0
    cost: float | None = None


def check_readers(models: Iterable[str]) -> None:
    """Raise InputError if a model cannot read items, whose texts are prose."""
    if any(each.partition("?")[0] == "offline" for each in models):
        raise InputError(
            "the model offline reads the sections of prompts and no prose, and items are prose; "
            "name another model, such as chance, first-option or scripted:FILE"
        )


def prompt_of(item: ItemRecord) -> tuple[Message, ...]:
    """Return the messages that ask an item, in the form of the template `story`."""
    form = jinja2.Template(built_in_template("answering").text)
    system = form.render(options=item.options, reason=False)
    options = "".join(
        f"{letter}) {option}\n"
        for letter, option in zip(ascii_uppercase, item.options, strict=False)
    )
    prompt = f"{item.text.strip()}\n\nQuestion: {item.question}\n\nOptions:\n{options}"
    return Message("system", system), Message("user", prompt)


def ask_item(model: Model, item: ItemRecord) -> ItemAnswer:
    """Ask a model an item with options.

    Raises:
        ModelError: The model cannot be asked, or a limit is reached. An answer that is missing or
            cannot be used is no error.
    """
    try:
        answer = model.answer(prompt_of(item), Sampling(seed=item.seed))
    except UnusableAnswerError as error:
        return ItemAnswer(
            id=item.id,
            model=model.name,
            answered=None,
            ok=False,
            outcome="no_answer",
            why_not=str(error),
            finish="",
            text="",
            tokens=error.usage.tokens,
            cost=error.usage.cost,
        )
    return judged_answer(item, model.name, answer)


def judged_answer(item: ItemRecord, model: str, answer: Answer) -> ItemAnswer:
    """Read and judge an answer to an item with options."""
    reading = read_answer(answer.text, item.options, answer.finish)
    answered = reading.option if reading.outcome == "read" else None
    outcome, why_not = reading.row_outcome, reading.reason
    if answered is not None:
        outcome = "ok" if answered == item.right else "wrong"
        why_not = "" if answered == item.right else f"answered {quoted(answered)}"
    return ItemAnswer(
        id=item.id,
        model=model,
        answered=answered,
        ok=outcome == "ok",
        outcome=outcome,
        why_not=why_not,
        finish=answer.finish,
        text=answer.text,
        tokens=answer.usage.tokens,
        cost=answer.usage.cost,
    )
