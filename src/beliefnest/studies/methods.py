"""Paragraph for a methods section, from what a study or a run has recorded."""

import hashlib
import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, get_args

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import read_regular
from beliefnest.llm.resolve import can_vary
from beliefnest.llm.stored_exchange import Exchange
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES
from beliefnest.scenarios.judging import LOST, unanswered_words
from beliefnest.studies.allocation import PARTICIPANT
from beliefnest.studies.clusters import DRAWS
from beliefnest.studies.counting import Row
from beliefnest.studies.participants.exclusions import excluded_words
from beliefnest.studies.study_record import StudyRecord
from beliefnest.studies.table import CellKind
from beliefnest.world.words import counted, listed

MethodsForm = Literal["markdown", "latex"]
FORMATS: tuple[MethodsForm, ...] = get_args(MethodsForm)


class ModelFacts(msgspec.Struct, frozen=True):
    """Model of a study.

    Attributes:
        name: Its name.
        answers: Number of recorded answers.
        dates: First and last day of the answers; None: no date is recorded.
        undated: Number of answers without a recorded date.
    """

    name: str
    answers: int = 0
    dates: tuple[str, str] | None = None
    undated: int = 0


class PeopleFacts(msgspec.Struct, frozen=True):
    """People who answered on a page for participants.

    Attributes:
        name: Their name in the column `model`.
        participants: Number of participants.
        rows: Number of their rows.
        shown: What they were shown: `film`, `story`, `both`.
        dates: First and last day; None: no date is recorded.
        sessions: How many began, were complete, partial, unanswered, repeated, and `excluded` by
            a list for each reason; empty: not noted.
    """

    name: str
    participants: int
    rows: int
    shown: Sequence[str]
    dates: tuple[str, str] | None
    sessions: Mapping[str, Any] = msgspec.field(default_factory=dict)


class RunFacts(msgspec.Struct, frozen=True):
    """Recorded facts about a study or a run.

    Attributes:
        kind: `study` or `run`.
        versions: Versions of programs by name; empty: not recorded.
        world: Name of the world.
        subjects: What was played, in words with names in code marks.
        factors: What it was combined with, in the same form.
        seed: Seed, in the same form; None: there is none.
        models: Models that answered.
        asking: How models were asked, in words; empty: they were not.
        templates: Prompt templates with the hash of their texts; None: built in.
        cells: Number of cells, without those of people.
        rows: Number of rows, without those of people.
        judged: Number of judged rows, without copies.
        variations: Number of independent variations among them.
        tokens: Tokens of all rows.
        cost: Known cost of all rows in US dollars.
        unpriced: Number of rows whose cost is not known.
        excluded: What was excluded, by keys of `_EXCLUDED`, and how often.
        computed: Number of judged rows whose right answers were computed from beliefs.
        not_answered: Number of judged rows by outcome, of those without an answer or result.
        rounds_not_answered: Number of rounds of episodes in which a model gave no program, by
            outcome.
        asked_again: Number of requests after answers that could not be read.
        intervals: Methods of the intervals of accuracies.
        people: People who answered.
    """

    kind: Literal["study", "run"]
    versions: Mapping[str, str]
    world: str
    subjects: str
    factors: Sequence[str]
    seed: str | None
    models: Sequence[ModelFacts]
    asking: str
    templates: Mapping[str, str | None]
    cells: int
    rows: int
    judged: int
    variations: int
    tokens: int
    cost: float
    unpriced: int
    excluded: Mapping[str, int] = msgspec.field(default_factory=dict)
    computed: int = 0
    not_answered: Mapping[str, int] = msgspec.field(default_factory=dict)
    rounds_not_answered: Mapping[str, int] = msgspec.field(default_factory=dict)
    asked_again: int = 0
    intervals: Sequence[str] = ()
    people: Sequence[PeopleFacts] = ()


def answered(names: Sequence[str], exchanges: Sequence[Exchange]) -> list[ModelFacts]:
    """Return the facts about each model, from its recorded answers."""
    models = []
    for name in dict.fromkeys(names):
        own = [each for each in exchanges if each.model == name]
        dates = sorted(each.date for each in own if each.date)
        span = (dates[0], dates[-1]) if dates else None
        models.append(ModelFacts(name, len(own), span, len(own) - len(dates)))
    return models


def usage_of(rows: Sequence[Row]) -> tuple[int, float, int]:
    """Return tokens, known cost and number of rows without known cost."""
    # Rows of cells without a result have no tokens.
    ended = [row for row in rows if row.get("tokens") is not None]
    tokens = sum(row.get("tokens") or 0 for row in rows)
    return (
        tokens,
        sum(row.get("cost") or 0.0 for row in rows),
        sum(row.get("cost") is None for row in ended),
    )


def facts_of(result: StudyRecord) -> RunFacts:
    """Return the facts about a study or run, from its folder.

    Raises:
        InputError: A file of the folder is damaged.
    """
    plan, rows, of = result.plan, result.rows, result.folder.of
    names = [each.removeprefix("model:") for each in plan["models"]]
    names += [plan["claims_from"]] if plan.get("claims_from") else []
    tokens, cost, unpriced = usage_of(rows)
    judged = [row for row in rows if row["ok"] is not None and row["copy_of"] is None]
    return RunFacts(
        kind=of,
        versions=plan["versions"],
        world=plan["world"],
        subjects=_subjects(plan, result.kind),
        factors=list(_factors(plan, result.kind)),
        seed=None if "seed" not in plan else f"seed {plan['seed']}",
        models=answered(names, result.folder.exchanges()),
        asking=_asking(plan, rows),
        templates=_templates(result),
        cells=sum(PARTICIPANT not in cell["key"] for cell in plan["cells"]),
        rows=sum(row.get(PARTICIPANT) is None for row in rows),
        judged=len(judged),
        variations=len({row["variation"] for row in judged}),
        tokens=tokens,
        cost=cost,
        unpriced=unpriced,
        excluded=_excluded(result),
        computed=_computed(judged),
        not_answered=_not_answered(judged),
        rounds_not_answered=_rounds_not_answered(judged),
        asked_again=sum(row.get("asked_again") or 0 for row in judged),
        intervals=_intervals(result.counted(result.groups)) if of == "study" else (),
        people=list(_people(result)),
    )


def _people(result: StudyRecord) -> Iterator[PeopleFacts]:
    """Yield the facts about the people of each name."""
    cells: dict[str, list[Mapping[str, Any]]] = {}
    for cell in result.plan["cells"]:
        if PARTICIPANT in cell["key"]:
            cells.setdefault(cell["key"]["model"], []).append(cell)
    for name, own in cells.items():
        contents = [result.folder.cell(cell["name"]) or {} for cell in own]
        pages = [each.get("page") or {} for each in contents]
        days = sorted(str(page["started"])[:10] for page in pages if page.get("started"))
        yield PeopleFacts(
            name=name,
            participants=len({cell["key"][PARTICIPANT] for cell in own}),
            rows=sum(row["model"] == name for row in result.rows),
            shown=sorted({str(page["shown"]) for page in pages if page.get("shown")}),
            dates=(days[0], days[-1]) if days else None,
            sessions=result.folder.sessions().get(name, {}),
        )


def _not_answered(rows: Sequence[Row]) -> dict[str, int]:
    """Return the number of rows without an answer or a result, by outcome."""
    counts = {name: sum(row["outcome"] == name for row in rows) for name in LOST}
    return {name: count for name, count in counts.items() if count}


def _rounds_not_answered(rows: Sequence[Row]) -> dict[str, int]:
    """Return the number of rounds in which a model gave no program, by outcome."""
    return Counter(name for row in rows for name in json.loads(row.get("not_answered") or "[]"))


def _computed(rows: Sequence[Row]) -> int:
    """Return the number of rows with a question whose right answer a belief gave."""
    texts = [row.get("expected") or "{}" for row in rows]
    asked = [json.loads(text).get("answers", ()) for text in texts]
    return sum(any("right_from" in each for each in questions) for questions in asked)


def _intervals(groups: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the methods of the intervals of counted groups, in words."""
    used = {group["interval"] for group in groups}
    return [words for name, words in _INTERVALS.items() if name in used]


_INTERVALS = {
    "wilson": "the method of Wilson (1927)",
    "bootstrap": f"the cluster bootstrap over variations ({DRAWS:,} draws)",
    "two-way bootstrap": (
        f"the pigeonhole bootstrap over variations and participants ({DRAWS:,} draws; Owen 2007)"
    ),
}


def _subjects(plan: Mapping[str, Any], kind: CellKind) -> str:
    keys = [cell["key"] for cell in plan["cells"]]
    names = list(dict.fromkeys(key[kind.subject] for key in keys))
    if "seeds" in plan:
        subjects = f"{kind.name} of the {_several(kind.subject, sorted(names))}"
        return f"{subjects} ({_several('seed', plan['seeds'], '')})"
    numbers = sorted({key["condition"] for key in keys if key["condition"] is not None})
    subjects = f"the {_several(kind.subject, names)}"
    return f"{subjects} under {_several('condition', numbers, '')}" if numbers else subjects


def _factors(plan: Mapping[str, Any], kind: CellKind) -> Iterator[str]:
    variations = plan["variations"]
    if isinstance(variations, int):
        factor = f"{counted(variations, 'drawn variation')} of each scenario"
        varied = _varied(plan)
        yield f"{factor} (in {listed(varied)})" if varied else factor
    elif variations:
        lists = [f"{_code(n)} ({counted(len(v), 'value')})" for n, v in variations.items()]
        yield f"all valid combinations of {listed(lists)}"
    word, plural = kind.player
    yield f"the {_several(word, plan[kind.players], plural=plural)}"
    if plan.get("templates"):
        yield f"the {_several('prompt template', plan['templates'])}"
    if plan["repeats"] > 1:
        yield counted(plan["repeats"], "repeat")
    design = plan.get("design")
    if design == "balanced":
        yield "a balanced design, in which each variation is played under one condition"
    elif design is not None:
        yield "a Latin square, which divides the cells into lists"


def _varied(plan: Mapping[str, Any]) -> list[str]:
    """Return what differs between drawn variations, with names in code marks."""
    drawn = [cell["key"]["variation"] for cell in plan["cells"]]
    names = dict.fromkeys(name for each in drawn for name in each)
    texts = {name: {json.dumps(each.get(name)) for each in drawn} for name in names}
    return [_code(name) for name, values in texts.items() if len(values) > 1]


def _asking(plan: Mapping[str, Any], rows: Sequence[Row]) -> str:
    if "attempts" not in plan:
        return ""
    heat = plan["temperature"]
    heat_words = "the provider's default temperature" if heat is None else f"temperature {heat:g}"
    parts = [f"at {heat_words}"]
    if any(row.get("attempts", 1) for row in rows):
        parts.append(f"with at most {counted(plan['attempts'], 'request')} for a program")
    if "retry_unread" in plan:
        again = counted(plan["retry_unread"], "further request")
        parts.append(f"{again} after an unreadable answer")
    if plan.get("answer") == "structured":
        parts.append("with answers to choices in a structured form")
    if "max_output_tokens" in plan:
        parts.append(f"at most {counted(plan['max_output_tokens'], 'token')} for an answer")
    if "system" in plan:
        parts.append("a system message of our own")
    if "skills" in plan:
        parts.append(f"and skills listed with the detail {_code(plan['skills'])}")
    if plan.get("claims_from"):
        parts.append(f"with claims read out of what agents said by {_code(plan['claims_from'])}")
    return ", ".join(parts)


def _templates(result: StudyRecord) -> dict[str, str | None]:
    digests: dict[str, str | None] = {}
    for name in result.plan.get("templates", []):
        digests[name] = None
        if name not in BUILT_IN_TEMPLATES:
            text = read_regular(result.folder.path / result.plan["inputs"]["templates"][name])
            digests[name] = hashlib.sha256(text).hexdigest()[:12]
    return digests


def _excluded(result: StudyRecord) -> dict[str, int]:
    """Return what is not among the judged rows, in words, with counts."""
    plan, rows = result.plan, result.rows
    tried = {row["cell"] for row in rows}
    counts = {
        "combination": len(plan["invalid"]),
        "unplayed": sum(cell["name"] not in tried for cell in plan["cells"]),
        "unjudged": sum(row["ok"] is None for row in rows),
        "copy": sum(row["copy_of"] is not None and row["ok"] is not None for row in rows),
    }
    return {name: count for name, count in counts.items() if count}


_EXCLUDED = {
    "combination": "{0} that makes no valid scenario or episode",
    "unplayed": "{0} that has not been played",
    "unjudged": "{0} without an expectation to judge",
    "copy": "{0} that differs from another row only by a seed on which nothing depends",
}
_NOUNS = {"combination": "combination", "unplayed": "cell", "unjudged": "row", "copy": "row"}


def methods_text(facts: RunFacts, form: MethodsForm) -> str:
    """Return the paragraph; it contains recorded facts only.

    Raises:
        InputError: The format does not exist.
    """
    if form not in FORMATS:
        raise InputError(f"there is no format {form!r}; give one of {', '.join(FORMATS)}")
    written = _latex if form == "latex" else _markdown
    return " ".join(written(sentence) for sentence in _sentences(facts)) + "\n"


def _sentences(facts: RunFacts) -> Iterator[str]:
    versions = facts.versions
    program = f"BeliefNest {versions['beliefnest']}" if "beliefnest" in versions else "BeliefNest"
    details = [f"Python {versions['python']}"] if "python" in versions else []
    details += [versions["platform"]] if "platform" in versions else []
    on = f" ({', '.join(details)})" if details else " (version not recorded)"
    yield f"The {facts.kind} was played with {program}{on} in the world {_code(facts.world)}."
    yield f"It combines {facts.subjects} with {listed(facts.factors)}."
    seed = "" if facts.seed is None else f"; all random numbers derive from {facts.seed}"
    yield f"This makes {counted(facts.cells, 'cell')} and {counted(facts.rows, 'row')}{seed}."
    if facts.models:
        yield f"{'; '.join(_models(facts.models))}."
    for people in facts.people:
        yield f"{_person(people)}."
        if people.sessions:
            yield f"{_told_sessions(people.sessions)}."
    if facts.asking and any(can_vary(each.name) for each in facts.models):
        yield f"Models were asked {facts.asking}."
    if facts.templates:
        prompt_words = [
            f"{_code(name)} ({'built in' if text is None else f'SHA-256 {text}'})"
            for name, text in facts.templates.items()
        ]
        yield f"Prompts were rendered with {listed(prompt_words)}."
    if facts.tokens or facts.cost or facts.unpriced:
        cost = f"cost {facts.cost:.2f} US dollars"
        if facts.unpriced:
            cost += f", without {counted(facts.unpriced, 'row')} whose price is not known"
        yield f"The answers used {facts.tokens:,} tokens and {cost}."
    yield from _exclusions(facts)
    yield (
        f"{counted(facts.judged, 'row').capitalize()} of "
        f"{counted(facts.variations, 'independent variation')} "
        f"{'is' if facts.judged == 1 else 'are'} judged."
    )
    if facts.not_answered:
        missing, kinds = sum(facts.not_answered.values()), unanswered_words(facts.not_answered)
        yield (
            f"Among them, {counted(missing, 'row')} without an answer to judge ({kinds}) count as "
            "not right."
        )
    if facts.rounds_not_answered:
        rounds = counted(sum(facts.rounds_not_answered.values()), "round")
        kinds = unanswered_words(facts.rounds_not_answered)
        yield f"Models gave no program in {rounds} ({kinds})."
    if facts.asked_again:
        yield f"Models were asked again after {counted(facts.asked_again, 'unreadable answer')}."
    if facts.computed:
        some = f" of {counted(facts.computed, 'row')}"
        of = "" if facts.computed == facts.judged else some
        yield f"Right answers{of} were computed from the beliefs of the simulated agents."
    if facts.intervals:
        yield f"The 95 % intervals of accuracies are by {listed(facts.intervals)}."


def _exclusions(facts: RunFacts) -> Iterator[str]:
    """Yield the sentences about what was excluded."""
    reasons = [each.sessions.get("excluded") for each in facts.people]
    reasons_words = [excluded_words(each) for each in reasons if each]
    reasons_words += [_exclusion(name, count) for name, count in facts.excluded.items()]
    if reasons_words:
        yield f"Excluded were {listed(reasons_words)}."
    elif not facts.people:
        yield "Nothing was excluded."
    if facts.people:
        yield (
            f"{'Further p' if any(reasons) else 'P'}articipants or answers that were left out of "
            "the files by hand are not recorded: report them."
        )


def _exclusion(name: str, count: int) -> str:
    words = _EXCLUDED[name].format(counted(count, _NOUNS[name]))
    if count == 1:
        return words
    for one, many in ((" makes ", " make "), (" has ", " have "), (" differs ", " differ ")):
        words = words.replace(one, many)
    return words


def _models(models: Sequence[ModelFacts]) -> Iterator[str]:
    """Yield a clause for each model of a provider, and one for all others."""
    yield from (_model(each) for each in models if can_vary(each.name))
    others = [_code(each.name) for each in models if not can_vary(each.name)]
    if others:
        are = "are no language models" if len(others) > 1 else "is no language model"
        yield f"{listed(others)} {are} of a provider"


def _model(model: ModelFacts) -> str:
    if not model.answers:
        return f"{_code(model.name)} gave no recorded answer"
    answers = f"{_code(model.name)} gave {counted(model.answers, 'recorded answer')}"
    if model.dates is None:
        return f"{answers} (dates not recorded)"
    first, last = model.dates
    span = f"on {first}" if first == last else f"from {first} to {last}"
    without = f", {model.undated} without a recorded date" if model.undated else ""
    return f"{answers} {span} (UTC){without}"


def _person(people: PeopleFacts) -> str:
    shown = " and ".join(_SHOWN.get(each, each) for each in people.shown)
    page = f"a page with {shown}" if shown else "a page"
    words = (
        f"{_code(people.name)} are {counted(people.participants, 'participant')} who answered the "
        f"same questions on {page}, which gave {counted(people.rows, 'row')}"
    )
    if people.dates is None:
        return f"{words} (dates not recorded)"
    first, last = people.dates
    return f"{words}, {f'on {first}' if first == last else f'from {first} to {last}'} (UTC)"


def _told_sessions(sessions: Mapping[str, Any]) -> str:
    """Return how many participants began, ended and stopped, as a clause."""
    words = (
        f"Of {counted(sessions['began'], 'participant')} who began, {sessions['complete']} "
        f"answered all questions, {sessions['partial']} stopped in the middle (complete probes "
        f"count) and {sessions['unanswered']} gave no answer"
    )
    if sessions["repeated"]:
        words += f"; {sessions['repeated']} took part more than once, and the first session counts"
    return words


_SHOWN = {"film": "films", "story": "stories", "both": "stories and films"}

_MARK = "\0"
"""Mark around names, which no text of a study contains."""


def _code(name: str) -> str:
    return f"{_MARK}{name.replace(_MARK, '')}{_MARK}"


def _several(noun: str, names: Sequence[object], mark: str = _MARK, plural: str = "") -> str:
    marked = [f"{mark}{name}{mark}" for name in names]
    word = noun if len(names) == 1 else plural or f"{noun}s"
    return f"{word} {listed(marked)}"


def _markdown(sentence: str) -> str:
    return sentence.replace(_MARK, "`")


_SPECIAL = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    **{letter: f"\\{letter}" for letter in "&%$#_{}"},
}


def _latex(sentence: str) -> str:
    parts = ["".join(_SPECIAL.get(c, c) for c in part) for part in sentence.split(_MARK)]
    # Every second part stands between two marks.
    return "".join(rf"\texttt{{{part}}}" if n % 2 else part for n, part in enumerate(parts))
