"""Questions to a model, answered in words or by choosing an option."""

import random
from collections.abc import Mapping

from msgspec.structs import replace

from beliefnest.errors import ModelError
from beliefnest.llm.failures import UnusableAnswerError
from beliefnest.llm.messages import Answer, ChoiceSampling, Message, Model, Sampling, Usage
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.llm.option_models import OPTION_MODELS
from beliefnest.llm.reading_answers import read_answer, read_words
from beliefnest.llm.statements import given_reason
from beliefnest.nest.face.nest import Nest
from beliefnest.prompts import built_in_template
from beliefnest.prompts.mind_view import MindView
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.outcome import Reply
from beliefnest.world.values import Position


def ask_question(
    nest: Nest,
    probe: Probe,
    question: Answers,
    model: Model,
    seed: int,
    sampling: Sampling,
    settings: ModelSettings,
) -> tuple[Reply, Usage]:
    """Ask a model a question of a probe, from the belief of the probe.

    Args:
        nest: The nest after the script.
        probe: Probe with the belief path and template.
        question: The question.
        model: The model.
        seed: Seed of the order of the options.
        sampling: Sampling options of the answer.
        settings: Form of the answer, and number of times to ask again, with the form said once
            more, if an answer names no option or several.

    Raises:
        ModelError: The model cannot be asked, or not for the form of the settings.
    """
    believer = nest[probe.path]
    options = shuffled(question, seed)
    asked = {
        "question": question.question,
        "options": options,
        "reason": question.reason,
        "places": _places(believer.view),
    }
    system = believer.render(built_in_template("answering"), **asked)
    prompt = believer.render(probe.template_or("question"), task=question.question, **asked)
    messages = [Message("system", system), Message("user", prompt)]
    usage = Usage()
    structured = settings.answer == "structured" and bool(options)
    if structured or (options and probe.template is not None and model.name in OPTION_MODELS):
        sampling = ChoiceSampling(
            sampling.temperature, sampling.seed, sampling.max_output_tokens, options
        )
    for again in range(settings.retry_unread + 1):
        try:
            answer = model.answer(messages, sampling)
        except UnusableAnswerError as error:
            reply = Reply(question.question, options, prompt, "", None, "", "no_answer", str(error))
            return replace(reply, asked_again=again), usage + error.usage
        usage += answer.usage
        if structured and answer.form == "text":
            raise ModelError(
                f"{model.name} has no structured form of answers; leave out `answer: structured`"
            )
        reply = replace(_reply(question, options, prompt, answer), asked_again=again)
        if reply.outcome not in ("unread", "ambiguous"):
            break
        # Providers refuse empty messages.
        said = Message("assistant", answer.text.strip() or "(no text)")
        messages = [*messages, said, Message("user", f"{reply.why_not}\n\n{system}")]
    return reply, usage


def _reply(question: Answers, options: tuple[str, ...], prompt: str, answer: Answer) -> Reply:
    if options:
        reading = read_answer(answer.text, options, answer.finish)
        chosen = reading.option
    else:
        reading = read_words(answer.text, answer.finish)
        chosen = reading.said or None
    return Reply(
        question=question.question,
        options=options,
        prompt=prompt,
        text=answer.text,
        answer=chosen if reading.outcome == "read" else None,
        reason=given_reason(answer.text),
        outcome=reading.row_outcome,
        why_not=reading.reason,
        form=answer.form,
    )


def shuffled(question: Answers, seed: int) -> tuple[str, ...]:
    """Return the options of a question in the order of a seed."""
    options = list(question.options)
    random.Random(f"{seed} {question.question}").shuffle(options)
    return tuple(options)


def _places(view: MindView) -> Mapping[str, Position]:
    """Return the positions of the things and places that have a name for the asked mind."""
    named = {**view.names, **{at: name for name, at in view.places.items()}}
    return {**{name: at for at, name in named.items()}, **view.places}
