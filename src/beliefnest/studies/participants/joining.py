"""Joining of participants' answers to the cells of a study."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.llm.messages import Usage
from beliefnest.plan.scenario_cells import CellKey
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected import Judgement
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.judging import outcome_of
from beliefnest.scenarios.outcome import ProbeOutcome, Reply
from beliefnest.scenarios.records import probe_json
from beliefnest.studies.participants.answers import PersonAnswer, first_sessions
from beliefnest.studies.participants.items import Item, ItemQuestion
from beliefnest.studies.participants.playing import Judged
from beliefnest.studies.study_folder import PersonCell
from beliefnest.world.texts import quoted, visible
from beliefnest.world.words import counted


@dataclass(frozen=True, slots=True)
class _PersonKey(CellKey):
    """Identity of a cell that a participant answered.

    Attributes:
        participant: Id of the participant.
    """

    participant: str


class Sessions(msgspec.Struct, frozen=True):
    """Numbers of participants; all but `excluded` are of those who are not excluded.

    Attributes:
        began: All of whom there is an answer or the beginning of a session.
        complete: Those who answered all questions of their list.
        partial: Those who stopped after some answers.
        unanswered: Those who stopped before the first answer.
        repeated: Those who took part more than once, of whom the first session counts.
        excluded: Those whom a list excludes, by reason.
    """

    began: int
    complete: int
    partial: int
    unanswered: int
    repeated: int
    excluded: Mapping[str, int] = msgspec.field(default_factory=dict)


@dataclass
class Joined:
    """Answers of participants, joined to the study.

    Attributes:
        cells: A cell for each participant and item with complete answers.
        sessions: Numbers of participants who began, ended and stopped.
        answers: All counted answers, each with True if it is right.
        notes: What was left out or is unusual, in words.
    """

    cells: list[PersonCell] = field(default_factory=list)
    sessions: Sessions = field(default_factory=lambda: Sessions(0, 0, 0, 0, 0))
    answers: list[tuple[PersonAnswer, bool]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


_Sessions = dict[str, dict[str, dict[str, PersonAnswer]]]
"""Answers by participant, item and question."""


def counted_answers(answers: Sequence[PersonAnswer], notes: list[str]) -> _Sessions:
    """Return the answers that count, by participant, item and question.

    Of a participant with several sessions, the first one counts. Equal answers that several files
    hold count once.

    Args:
        answers: Answers of all files, with the texts of their own options.
        notes: List that receives a sentence about what was left out.

    Raises:
        InputError: Two files contradict each other.
    """
    firsts = first_sessions(answers)
    later = {each.participant for each in answers if each.started != firsts[each.participant]}
    for participant in sorted(later):
        notes.append(
            f"participant {participant} took part more than once; only the session that began "
            f"first ({firsts[participant]}) counts"
        )
    sessions: _Sessions = {}
    twice = 0
    for answer in answers:
        if answer.started != firsts[answer.participant]:
            continue
        sheet = sessions.setdefault(answer.participant, {}).setdefault(answer.cell, {})
        before_it = sheet.setdefault(answer.question, answer)
        if before_it.response != answer.response:
            raise answer.fault(
                "response",
                f"is {quoted(answer.response)}, but {before_it.where} has "
                f"{quoted(before_it.response)}; keep one of the two files",
            )
        twice += before_it is not answer
    if twice:
        notes.append(f"{counted(twice, 'answer')} stood in several files and counted once")
    return sessions


def checked_answer(answer: PersonAnswer, items: Mapping[str, Item]) -> PersonAnswer:
    """Return an answer with the study's own texts of its options.

    Args:
        answer: The answer, as it is in its file.
        items: Items of the study, by name.

    Raises:
        InputError: It belongs to no question of the study, or is none of the options.
    """
    item = items.get(answer.cell)
    if item is None:
        raise answer.fault(
            "cell",
            f"{quoted(answer.cell)} is no cell of this study; the study, its scenarios, seed or "
            "world have changed since this participant's page was written: read the answers with "
            "the files of that time",
        )
    asked = next((each.asked for each in item.questions if each.id == answer.question), None)
    if asked is None:
        raise answer.fault("question", f"the cell {answer.cell} has no question {answer.question}")
    return with_own_options(answer, asked.options)


def with_own_options(answer: PersonAnswer, options: Sequence[str]) -> PersonAnswer:
    """Return an answer with the question's own texts of its options; empty: it has none.

    Raises:
        InputError: The answer is none of them, or it was given to others.
    """
    if not options:
        return answer
    texts = {visible(option): option for option in options}
    if answer.response and answer.response not in texts:
        raise answer.fault(
            "response",
            f"{quoted(answer.response)} is none of the options {', '.join(options)}",
        )
    if answer.options and set(answer.options) != set(texts):
        raise answer.fault("options", f"must be {', '.join(options)} in some order")
    order = tuple(texts[option] for option in answer.options) or tuple(options)
    return replace(answer, response=texts.get(answer.response, ""), options=order)


def joined(
    sessions: _Sessions,
    judged: Iterable[tuple[Item, Judged]],
    name: str,
    shown: Sequence[Item],
    notes: Sequence[str],
    read: Sequence[PersonAnswer],
) -> Joined:
    """Return the cells of participants, judged as the study judges models.

    Args:
        sessions: Result of `counted_answers`.
        judged: Answered items with their right answers.
        name: Name of the people in the column `model`.
        shown: All items of the study.
        notes: Notes of `counted_answers`.
        read: All answers and beginnings of sessions in the files.
    """
    whole = Joined(notes=list(notes))
    asked = {item.name: (item, by) for item, by in judged}
    for participant, cells in sessions.items():
        for cell, sheet in cells.items():
            item, by = asked[cell]
            outcomes = _outcomes(item, by, sheet)
            whole.answers += [
                (sheet[question.id], _judged(_judge(by, question), sheet[question.id]).ok)
                for question in item.questions
                if question.id in sheet
            ]
            if outcomes:
                whole.cells.append(_cell(item, by, outcomes, name, participant, sheet))
        whole.notes += _missing(participant, cells, shown)
    stopped = sum(bool(_missing(each, cells, shown)) for each, cells in sessions.items())
    started: dict[str, set[str]] = {}
    for each in read:
        started.setdefault(each.participant, set()).add(each.started)
    silent = len(started) - len(sessions)
    if silent:
        whole.notes.append(f"{counted(silent, 'participant')} began and gave no answer")
    whole.sessions = Sessions(
        began=len(started),
        complete=len(sessions) - stopped,
        partial=stopped,
        unanswered=silent,
        repeated=sum(len(times) > 1 for times in started.values()),
    )
    return whole


def _missing(
    participant: str, cells: Mapping[str, Mapping[str, PersonAnswer]], shown: Sequence[Item]
) -> list[str]:
    """Return a note if a participant did not answer all questions of a list."""
    numbers = {item.cell.list_number for item in shown if item.name in cells}
    asked = sum(len(item.questions) for item in shown if item.cell.list_number in numbers)
    count = sum(map(len, cells.values()))
    if count == asked:
        return []
    return [f"participant {participant} answered {count} of {counted(asked, 'question')}"]


def _judge(by: Judged, question: ItemQuestion) -> Answers:
    """Return a question with its right answers."""
    return by.probes[question.probe].questions[question.index]


def _judged(asked: Answers, answer: PersonAnswer) -> Judgement:
    return asked.judge(_reply(asked, answer))


def _reply(asked: Answers, answer: PersonAnswer) -> Reply:
    """Return the answer of a participant in the form of a model's."""
    said = answer.response or None
    outcome = "no_answer" if said is None else "read"
    return Reply(asked.question, answer.options, "", answer.response, said, answer.reason, outcome)


def _outcomes(item: Item, by: Judged, sheet: Mapping[str, PersonAnswer]) -> list[ProbeOutcome]:
    """Return the outcomes of the probes all of whose questions are answered."""
    probes = dict.fromkeys(question.probe for question in item.questions)
    made = []
    for number in probes:
        own = [question for question in item.questions if question.probe == number]
        if all(question.id in sheet for question in own):
            pairs = [(_judge(by, each), sheet[each.id]) for each in own]
            made.append(_outcome(by.probes[number], pairs))
    return made


def _outcome(probe: Probe, pairs: Sequence[tuple[Answers, PersonAnswer]]) -> ProbeOutcome:
    replies = tuple(_reply(asked, answer) for asked, answer in pairs)
    verdicts = tuple(asked.judge(reply) for (asked, _), reply in zip(pairs, replies, strict=True))
    return ProbeOutcome(probe, verdicts, outcome_of(verdicts, None), Usage(), replies=replies)


def _cell(
    item: Item,
    by: Judged,
    outcomes: Sequence[ProbeOutcome],
    name: str,
    participant: str,
    sheet: Mapping[str, PersonAnswer],
) -> PersonCell:
    key = item.cell.key
    own = _PersonKey(
        scenario=key.scenario,
        content=key.content,
        condition=key.condition,
        variation=key.variation,
        model=name,
        template=key.template,
        repeat=1,
        setting=key.setting,
        participant=participant,
    )
    first = next(iter(sheet.values()))
    planned = replace(item.cell, key=own).plain()
    content: dict[str, Any] = {
        "error": None,
        "key": own.content_json(),
        "seed": own.seed,
        "ticks": by.ticks,
        "run": "",
        "expectations": list(by.expectations),
        "probes": [{**probe_json(each, ""), "answer": "", "seconds": 0.0} for each in outcomes],
        "page": {name: first.plain.get(name) for name in ("study", "shown", "list", "started")},
    }
    # A participant's answer is no copy of another one's.
    return PersonCell({**planned, "alike": None}, content)


def check_name(name: str, models: Sequence[str]) -> None:
    """Raise InputError if people would have the name of a model."""
    if not name.strip():
        raise InputError("--name is empty; give the people a name, such as people")
    if name in models:
        raise InputError(
            f"--name is {quoted(name)}, which is a model of the study; give another name"
        )
