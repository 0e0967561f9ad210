"""Items that models are asked as text; their answers."""

from string import ascii_uppercase

import jinja2
import msgspec

from beliefnest.errors import ModelError
from beliefnest.llm.failures import NOT_ASKED
from beliefnest.llm.messages import Finish, Message, Model, Sampling
from beliefnest.llm.reading_answers import read_answer
from beliefnest.prompts import built_in_template
from beliefnest.studies.items.record import ItemRecord


class ItemAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """Answer of a model to an item.

    Attributes:
        id: Id of the item.
        model: Name of the model.
        answer: Option that the answer names; None: it names none, or several.
        outcome: `ok`, `wrong`, or why there is no answer: `ambiguous`, `unread`, `cut`, `refused`,
            `no_answer`.
        ok: True if the answer is right.
        text: Complete text of the answer.
        tokens: Tokens sent and received.
        cost: Cost in US dollars; None: not known.
    """

    id: str
    model: str
    answer: str | None
    outcome: str
    ok: bool
    text: str
    tokens: int = 0
    cost: float | None = None


def prompt_of(item: ItemRecord) -> tuple[Message, ...]:
    """Return the messages that ask an item, in the form of the template `story`."""
    form = jinja2.Template(built_in_template("answering").text)
    system = form.render(options=item.options, reason=False)
    options = "".join(
        f"{letter}) {option}\n"
        for letter, option in zip(ascii_uppercase, item.options, strict=False)
    )
    prompt = f"{item.text}\n\nQuestion: {item.question}\n\nOptions:\n{options}"
    return Message("system", system), Message("user", prompt)


def ask_item(model: Model, item: ItemRecord) -> ItemAnswer:
    """Ask a model an item with options.

    Raises:
        ModelError: The model cannot be asked, or a limit is reached.
    """
    try:
        answer = model.answer(prompt_of(item), Sampling(seed=item.seed))
    except NOT_ASKED:
        raise
    except ModelError as error:
        fault = str(error)
        return ItemAnswer(
            id=item.id, model=model.name, answer=None, outcome="no_answer", ok=False, text=fault
        )
    option, outcome = judged_text(answer.text, item, answer.finish)
    return ItemAnswer(
        id=item.id,
        model=model.name,
        answer=option,
        outcome=outcome,
        ok=outcome == "ok",
        text=answer.text,
        tokens=answer.usage.tokens,
        cost=answer.usage.cost,
    )


def judged_text(text: str, item: ItemRecord, finish: Finish = "stop") -> tuple[str | None, str]:
    """Return the option that an answer names, and its outcome; see `ItemAnswer`."""
    reading = read_answer(text, item.options, finish)
    if reading.outcome != "read":
        return None, reading.row_outcome
    return reading.option, "ok" if reading.option == item.right else "wrong"
