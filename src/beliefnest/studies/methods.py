"""Paragraph for a methods section, from what a study or a run has recorded."""

import hashlib
import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, get_args

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


def _source(result: StudyRecord, template: str) -> str:
    if template in BUILT_IN_TEMPLATES:
        return "built in"
    text = read_regular(result.folder.path / result.plan["inputs"]["templates"][template])
    return f"SHA-256 {hashlib.sha256(text).hexdigest()[:12]}"


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


def methods_text(result: StudyRecord, form: MethodsForm) -> str:
    """Return the paragraph about a study or run; it contains recorded facts only.

    Raises:
        InputError: The format does not exist, or a file of the folder is damaged.
    """
    if form not in FORMATS:
        raise InputError(f"there is no format {form!r}; give one of {', '.join(FORMATS)}")
    written = _latex if form == "latex" else _markdown
    return " ".join(written(sentence) for sentence in _sentences(result)) + "\n"


def _sentences(result: StudyRecord) -> Iterator[str]:
    plan, of = result.plan, result.folder.of
    versions = plan["versions"]
    program = f"BeliefNest {versions['beliefnest']}" if "beliefnest" in versions else "BeliefNest"
    details = [f"Python {versions['python']}"] if "python" in versions else []
    details += [versions["platform"]] if "platform" in versions else []
    on = f" ({', '.join(details)})" if details else " (version not recorded)"
    yield f"The {of} was played with {program}{on} in the world {_code(plan['world'])}."
    factors = list(_factors(plan, result.kind))
    yield f"It combines {_subjects(plan, result.kind)} with {listed(factors)}."
    seed = f"; all random numbers derive from seed {plan['seed']}" if "seed" in plan else ""
    cells = sum(PARTICIPANT not in cell["key"] for cell in plan["cells"])
    rows = sum(row.get(PARTICIPANT) is None for row in result.rows)
    yield f"This makes {counted(cells, 'cell')} and {counted(rows, 'row')}{seed}."
    names = [each.removeprefix("model:") for each in plan["models"]]
    names += [plan["claims_from"]] if plan.get("claims_from") else []
    clauses = list(_models(names, result.folder.exchanges()))
    if clauses:
        yield f"{'; '.join(clauses)}."
    yield from _people(result)
    if "attempts" in plan and any(map(can_vary, names)):
        yield f"Models were asked {_asking(plan, result.rows)}."
    templates = [f"{_code(name)} ({_source(result, name)})" for name in plan.get("templates", ())]
    if templates:
        yield f"Prompts were rendered with {listed(templates)}."
    tokens, known_cost, unpriced = usage_of(result.rows)
    if tokens or known_cost or unpriced:
        cost = f"cost {known_cost:.2f} US dollars"
        if unpriced:
            cost += f", without {counted(unpriced, 'row')} whose price is not known"
        yield f"The answers used {tokens:,} tokens and {cost}."
    yield from _exclusions(result)
    yield from _judged(result)
    if of == "study":
        intervals = _intervals(result.counted(result.groups))
        if intervals:
            yield f"The 95 % intervals of accuracies are by {listed(intervals)}."


def _judged(result: StudyRecord) -> Iterator[str]:
    """Yield the sentences about the judged rows."""
    rows = [row for row in result.rows if row["ok"] is not None and row["copy_of"] is None]
    variations = len({row["variation"] for row in rows})
    yield (
        f"{counted(len(rows), 'row').capitalize()} of "
        f"{counted(variations, 'independent variation')} "
        f"{'is' if len(rows) == 1 else 'are'} judged."
    )
    not_answered = _not_answered(rows)
    if not_answered:
        missing, kinds = sum(not_answered.values()), unanswered_words(not_answered)
        yield (
            f"Among them, {counted(missing, 'row')} without an answer to judge ({kinds}) count as "
            "not right."
        )
    rounds = _rounds_not_answered(rows)
    if rounds:
        gave = counted(sum(rounds.values()), "round")
        yield f"Models gave no program in {gave} ({unanswered_words(rounds)})."
    asked_again = sum(row.get("asked_again") or 0 for row in rows)
    if asked_again:
        yield f"Models were asked again after {counted(asked_again, 'unreadable answer')}."
    computed = _computed(rows)
    if computed:
        of = "" if computed == len(rows) else f" of {counted(computed, 'row')}"
        yield f"Right answers{of} were computed from the beliefs of the simulated agents."


def _exclusions(result: StudyRecord) -> Iterator[str]:
    """Yield the sentences about what was excluded."""
    people = _people_cells(result)
    sessions = result.folder.sessions()
    reasons = [sessions.get(name, {}).get("excluded") for name in people]
    reasons_words = [excluded_words(each) for each in reasons if each]
    reasons_words += [_exclusion(name, count) for name, count in _excluded(result).items()]
    if reasons_words:
        yield f"Excluded were {listed(reasons_words)}."
    elif not people:
        yield "Nothing was excluded."
    if people:
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


def _models(names: Sequence[str], exchanges: Sequence[Exchange]) -> Iterator[str]:
    """Yield a clause for each model of a provider, and one for all others."""
    models = dict.fromkeys(names)
    for name in filter(can_vary, models):
        yield _model(name, [each for each in exchanges if each.model == name])
    others = [_code(name) for name in models if not can_vary(name)]
    if others:
        are = "are no language models" if len(others) > 1 else "is no language model"
        yield f"{listed(others)} {are} of a provider"


def _model(name: str, exchanges: Sequence[Exchange]) -> str:
    if not exchanges:
        return f"{_code(name)} gave no recorded answer"
    answers = f"{_code(name)} gave {counted(len(exchanges), 'recorded answer')}"
    dates = sorted(each.date for each in exchanges if each.date)
    if not dates:
        return f"{answers} (dates not recorded)"
    undated = len(exchanges) - len(dates)
    without = f", {undated} without a recorded date" if undated else ""
    return f"{answers} {_span(dates)} (UTC){without}"


def _span(dates: Sequence[str]) -> str:
    """Return the first and last of sorted days, in words."""
    first, last = dates[0], dates[-1]
    return f"on {first}" if first == last else f"from {first} to {last}"


def _people_cells(result: StudyRecord) -> dict[str, list[Mapping[str, Any]]]:
    """Return the cells of the people of each name."""
    cells: dict[str, list[Mapping[str, Any]]] = {}
    for cell in result.plan["cells"]:
        if PARTICIPANT in cell["key"]:
            cells.setdefault(cell["key"]["model"], []).append(cell)
    return cells


def _people(result: StudyRecord) -> Iterator[str]:
    """Yield the sentences about the people of each name."""
    for name, cells in _people_cells(result).items():
        pages = [(result.folder.cell(cell["name"]) or {}).get("page") or {} for cell in cells]
        kinds = sorted({str(page["shown"]) for page in pages if page.get("shown")})
        shown = " and ".join(_SHOWN.get(each, each) for each in kinds)
        page_words = f"a page with {shown}" if shown else "a page"
        participants = len({cell["key"][PARTICIPANT] for cell in cells})
        rows = sum(row["model"] == name for row in result.rows)
        dates = sorted(str(page["started"])[:10] for page in pages if page.get("started"))
        when = f", {_span(dates)} (UTC)" if dates else " (dates not recorded)"
        yield (
            f"{_code(name)} are {counted(participants, 'participant')} who answered the same "
            f"questions on {page_words}, which gave {counted(rows, 'row')}{when}."
        )
        sessions = result.folder.sessions().get(name)
        if sessions:
            yield f"{_told_sessions(sessions)}."


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
