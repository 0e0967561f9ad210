"""Questions to a model, answered in words or by choosing an option."""

import random
import re
from collections.abc import Mapping, Sequence

from beliefnest.llm.messages import Message, Model, Sampling, Usage
from beliefnest.nest.face.nest import Nest
from beliefnest.prompts import Template, built_in_template
from beliefnest.prompts.mind_view import MindView
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.outcome import Reply
from beliefnest.world.values import Position

__all__ = ["ask_question", "parse_answer", "shuffled"]

_ANSWER = re.compile(
    r"^[ \t>*_]*answer[ \t*_]*:[ \t*_]*(.*?)[ \t*_]*$", re.IGNORECASE | re.MULTILINE
)
_REASON = re.compile(
    r"^[ \t>*_]*reason[ \t*_]*:[ \t*_]*(.*)", re.IGNORECASE | re.MULTILINE | re.DOTALL
)


def ask_question(
    nest: Nest, probe: Probe, question: Answers, model: Model, seed: int, sampling: Sampling
) -> tuple[Reply, Usage]:
    """Ask a model a question of a probe, from the belief of the probe.

    Args:
        nest: The nest after the script.
        probe: Probe with the belief path and template.
        question: The question.
        model: The model.
        seed: Seed of the order of the options.
        sampling: Sampling options of the answer.

    Raises:
        ModelError: The model failed.
    """
    believer = nest[probe.path]
    options = shuffled(question, seed)
    template = built_in_template("question")
    if probe.template is not None:
        template = Template("template of the probe", probe.template)
    asked = {
        "question": question.question,
        "options": options,
        "reason": question.reason,
        "places": _places(believer.view),
    }
    system = believer.render(built_in_template("answering"), **asked)
    prompt = believer.render(template, task=question.question, **asked)
    answer = model.answer((Message("system", system), Message("user", prompt)), sampling)
    found, reason = parse_answer(answer.text, options)
    if answer.finish != "stop":
        found = None
    reply = Reply(question.question, options, prompt, answer.text, found, reason)
    return reply, answer.usage


def shuffled(question: Answers, seed: int) -> tuple[str, ...]:
    """Return the options of a question in the order of a seed."""
    options = list(question.options)
    random.Random(f"{seed} {question.question}").shuffle(options)
    return tuple(options)


def parse_answer(text: str, options: Sequence[str]) -> tuple[str | None, str]:
    """Parse the answer and the reason in a model's reply.

    Args:
        text: Complete reply; the last line `Answer: ...` and the text after `Reason:` count.
        options: Options, which a reply may also name by letter; empty: an answer in words.

    Returns:
        Answer, None if there is none or it is no option; reason, empty if there is none.
    """
    lines = _ANSWER.findall(text)
    told = _REASON.search(text)
    reason = told[1].strip() if told else ""
    said = lines[-1] if lines else text.strip() if "\n" not in text.strip() else ""
    said = said.strip().strip("\"'").rstrip(".").strip()
    if not said:
        return None, reason
    return (_chosen(said, options) if options else said), reason


def _chosen(said: str, options: Sequence[str]) -> str | None:
    letters = {chr(ord("a") + number): option for number, option in enumerate(options)}
    lettered = re.fullmatch(r"\(?([a-z])\)?(?:[.):]\s*(.*))?", said.casefold())
    if lettered and lettered[1] in letters:
        option = letters[lettered[1]]
        if not lettered[2] or lettered[2] == option.casefold():
            return option
    exact = [option for option in options if option.casefold().rstrip(".") == said.casefold()]
    return exact[0] if exact else None


def _places(view: MindView) -> Mapping[str, Position]:
    """Return the positions of the things and places that have a name for the asked mind."""
    named = {**view.names, **{at: name for name, at in view.places.items()}}
    return {**{name: at for at, name in named.items()}, **view.places}
