"""Explanations in words: one line for the fact, then one or two lines for each belief."""

from collections.abc import Iterable, Sequence

from beliefnest.belief.grounds import PerceivedEvent, Source
from beliefnest.nest.explain.parts import (
    BaseFact,
    Contents,
    Element,
    HeardClaim,
    Level,
    Missed,
    Reason,
    SeenElsewhere,
    Sighting,
    Value,
    ValueGround,
    View,
)
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.event_words import did, kind_words
from beliefnest.world.paths import path_text
from beliefnest.world.words import items_words, point_words, with_the

_GIVEN = (Source.PRIOR, Source.EDITED)
"""Sources that are no perceptions."""

_HANDED_ON = {
    Source.PRIOR: "had been believed since tick",
    Source.SEEN: "had last been seen at tick",
    Source.WITNESSED: "had been seen to happen ({acts}) at tick",
    Source.HEARD: "{speaker} had said at tick",
    Source.EDITED: "had been edited by hand at tick",
}
"""Words for a value that was not current when the holder perceived it, by its source."""


def explanation_lines(element: Element, fact: BaseFact, levels: Iterable[Level]) -> list[str]:
    """Return the fact, then each belief along the path with its reason, line by line."""
    lines = [_fact_text(fact, element)]
    for level in levels:
        lines.append(_belief_text(level, element))
        if level.missed is not None:
            lines.append(_missed_text(level.missed, level, fact, element))
    return lines


def _fact_text(fact: BaseFact, element: Element) -> str:
    where = f"In {path_text(fact.path)}" if fact.path else "In reality"
    if fact.forked_at is not None:
        where += f", on branch {fact.branch!r} since tick {fact.forked_at}"
    state = _state_text(fact.value, fact.block, element)
    if fact.since is None:
        begin = "the start" if fact.forked_at is None else "the fork"
        return f"{where}, {state}; that has not changed since {begin}."
    how = _how(fact.acts, fact.edited)
    return f"{where}, {state} since tick {fact.since}" + (f": {how}." if how else ".")


def _belief_text(level: Level, element: Element) -> str:
    outer = "".join(f"{name} believes that " for name in level.path[:-1])
    holder, name = level.holder, _named(element, level.block)
    given_up = "" if level.since is None else _given_up(level, element)
    if level.value is None and element.kind != "container":
        return f"{outer}{holder} knows nothing of {name}.{given_up}"
    sentence = f"{holder} believes that {_state_text(level.value, level.block, element)}"
    if isinstance(level.value, Contents) and not (level.value.items or level.value.complete):
        sentence = f"{holder} does not know what {name} holds"
    elif level.value is None and level.block is None:
        sentence = f"{holder} knows nothing of a container at {_place(element)}"
    if not level.reasons:
        return f"{outer}{sentence}.{given_up}"
    now = " That is current." if level.current else ""
    return f"{outer}{sentence}: {_reasons_text(level, name)}.{now}"


def _given_up(level: Level, element: Element) -> str:
    view = "" if len(level.path) == 1 else f", {_knows(level)[:-2]},"
    begin = f" At tick {level.since}{view} {_standing(level.holder, level.stood)}"
    if element.kind == "agent":
        return f"{begin} saw {element.where} not to be where it was believed to be."
    return f"{begin} gave up what it had believed."


def _reasons_text(level: Level, name: str) -> str:
    """Return in words what a belief rests on, in the order in which it came."""
    first, *later = level.reasons
    is_percept = not isinstance(first, ValueGround) or first.basis.source not in _GIVEN
    text = f"{_knows(level) if is_percept else ''}{_reason_text(level, first, name)}"
    if later:
        view = "" if is_percept or len(level.path) == 1 else f", {_knows(level)[:-2]},"
        text += f"; since then{view} "
        text += "; and ".join(_reason_text(level, each, name) for each in later)
    last = level.reasons[-1]
    if level.weighed and isinstance(last, HeardClaim) and last.speaker != level.holder:
        text += "" if last.refuted else f"; nothing that {level.holder} perceived contradicted it"
    return text


def _reason_text(level: Level, reason: Reason, name: str) -> str:
    match reason:
        case ValueGround():
            return _ground_text(level, reason, name)
        case HeardClaim():
            return _told_text(level, reason)
        case SeenElsewhere():
            return _elsewhere_text(level, reason)


def _ground_text(level: Level, ground: ValueGround, name: str) -> str:
    """Return a perception, a prior belief or an edit in words."""
    tick, source, holder = ground.basis.observed_at, ground.basis.source, level.holder
    acts = _acts_text(ground.acts) or kind_words(ground.basis.event)
    who = _standing(holder, ground.stood)
    last = "last " if ground is level.reasons[-1] else ""
    verb = "saw what happened at"
    if any(act.actor == holder for act in ground.acts):
        verb = f"{last}perceived it at"
    if not ground.tells_contents and source is Source.PRIOR:
        return f"that it is there is a prior belief, held since tick {tick}"
    if not ground.tells_contents and source is Source.SEEN:
        return f"{who} first saw {name} at tick {ground.since}, but not what it holds"
    text = {
        Source.PRIOR: f"a prior belief, held since tick {tick}",
        Source.EDITED: f"edited by hand at tick {tick}",
        Source.WITNESSED: f"{who} {verb} tick {tick}: {acts}",
    }.get(source, f"{who} {last}saw {name} at tick {tick}")
    if ground.handed_on:
        was = _HANDED_ON[source].format(speaker=ground.basis.speaker or "a sign", acts=acts)
        text = f"{who} perceived at tick {ground.since} what {was} {tick}"
    return text if last or ground.found is None else f"{text} (then {_contents(ground.found)})"


def _told_text(level: Level, heard: HeardClaim) -> str:
    """Return a claim that the holder heard or read, in words."""
    holder, speaker = level.holder, heard.speaker
    wrong = f", which {holder} perceived at tick {heard.refuted} to be wrong"
    what = f"at tick {heard.tick} that {heard.claim}{'' if heard.refuted is None else wrong}"
    if heard.sign is None:
        said = f"{holder} said" if speaker == holder else f"{speaker} told {holder}"
        return f"{said} {what}"
    sign = f"the sign at {_point(heard.sign)}"
    if speaker == holder:
        return f"{holder} wrote on {sign} {what}"
    by = "" if speaker is None else f", which {speaker} wrote,"
    return f"{holder} read on {sign}{by} {what}"


def _elsewhere_text(level: Level, seen: SeenElsewhere) -> str:
    """Return in words where else the holder perceived a unique item."""
    if seen.edited:
        where = _point(seen.where) if isinstance(seen.where, tuple) else "another place"
        return f"the only {seen.item} was put at {where} by hand at tick {seen.tick}"
    begin = f"{level.holder} perceived at tick {seen.tick}"
    if seen.where is None:
        return f"{begin} that the only {seen.item} was moved"
    if isinstance(seen.where, str):
        return f"{begin} that {seen.where} has the only {seen.item}"
    return f"{begin} the only {seen.item} at {_point(seen.where)}"


def _missed_text(missed: Missed, level: Level, fact: BaseFact, element: Element) -> str:
    """Return in words why a change did not reach a belief."""
    never = level.basis is None
    name, holder = _named(element, level.block or fact.block), level.holder
    begin = f"At tick {missed.tick}"
    if missed.absence is not None:
        view = as_known_to(level.path[:-2])
        text = f"{begin}{',' if view else ''} {view}{_absence_text(missed, level)}"
    elif missed.saw_acts:
        return (
            f"{begin} {_teller(level)}{_standing(holder, missed.stood)} saw this, which does not "
            f"show what {name} holds: {_change_text(missed, name, level)}."
        )
    else:
        looks = _looks_text(missed.sightings, "what it holds" if never else "this")
        text = f"{begin} {_teller(level)}{_standing(holder, missed.stood)} {looks}"
    if never:
        return f"{text}."
    return f"{text}. So {holder} missed this: {_change_text(missed, name, level)}."


def _looks_text(looks: Iterable[Sighting], hidden: str) -> str:
    """Return in words what looks showed; what is seen does not show what is hidden."""
    clauses = []
    for look in looks:
        if look.view is View.SEEN:
            clauses.append(f"saw {_target(look)}, which does not show {hidden}")
        else:
            clauses.append(f"could not see {_look_text(look)}")
    return "; and ".join(clauses)


def _absence_text(missed: Missed, level: Level) -> str:
    absence = missed.absence
    if absence is None:
        raise AssertionError("there is no absence to explain")
    if len(level.path) == 1:
        return f"{level.holder} was not there"
    parent = level.path[-2]
    text = f"{parent} could not tell what {level.holder} saw"
    if absence.last_seen is None:
        text += f": {parent} has never known where {level.holder} is"
    else:
        place = "" if missed.stood is None else f", at {_point(missed.stood)}"
        text += f": {parent} last saw {level.holder} at tick {absence.last_seen}{place}"
    if absence.sighting is not None:
        text += f", and could not see {_look_text(absence.sighting)}"
    return text


def _look_text(look: Sighting) -> str:
    """Return the target of a failed look, and the reason."""
    if look.at is None:
        return f"{look.target}, whose place is not known"
    match look.view:
        case View.TOO_FAR:
            why = f"it is {look.distance:.1f} blocks away, which is too far"
        case View.OUTSIDE_VIEW:
            why = "that is outside the field of view"
        case _ if look.blocker is None:
            why = "it is hidden"
        case _:
            why = f"the {look.blocker_name or 'block'} at {_point(look.blocker)} blocks it"
    return f"{_target(look)}: {why}"


def _change_text(missed: Missed, name: str, level: Level) -> str:
    how = _how(missed.acts, missed.edited)
    if how:
        return how
    if missed.after is None:
        return f"{name} became unknown"
    if isinstance(missed.after, str):
        return f"{name} became {missed.after}"
    if isinstance(missed.after, tuple):
        was = "" if missed.before is None else f" from {_value_point(missed.before)}"
        return f"{name} moved{was} to {_point(missed.after)}"
    return _contents_change(missed.after, name, level)


def _contents_change(after: Contents, name: str, level: Level) -> str:
    """Return new contents in words: a fact, or what the believer around the level believed."""
    if len(level.path) == 1:
        return f"{name} came to hold {_contents(after)}"
    parent = level.path[-2]
    if not after.items and not after.complete:
        return f"{parent} no longer believed anything about what {name} holds"
    return f"{parent} came to believe that {name} holds {_contents(after)}"


def _how(acts: Iterable[PerceivedEvent], edited: bool) -> str:
    if edited:
        return "it was edited by hand"
    return _acts_text(acts)


def _acts_text(acts: Iterable[PerceivedEvent]) -> str:
    all_ = list(acts)
    # An act and the block update that it causes are both recorded: tell the act alone.
    deeds = [act for act in all_ if act.actor is not None or act.kind is not EventKind.BLOCK_UPDATE]
    words = (f"{act.actor or 'something'} {did(act)}" for act in deeds or all_)
    return ", then ".join(dict.fromkeys(words))


def _state_text(value: Value, block: str | None, element: Element) -> str:
    name = _named(element, block)
    if isinstance(value, str):
        return f"the block at {_place(element)} is {value}"
    if isinstance(value, tuple):
        return f"{name} is at {_point(value)}"
    if value is not None:
        return f"{name} holds {_contents(value)}"
    if element.kind == "container":
        there = "what is there is not known" if block is None else f"{block} is there"
        return f"there is no container at {_place(element)} ({there})"
    return f"{name} is not there"


def _contents(value: Contents) -> str:
    items = items_words(value.items, " and ", ids=True)
    if value.complete:
        return items or "nothing"
    return f"{items}, and perhaps more" if items else "what is not known"


def _named(element: Element, block: str | None) -> str:
    if isinstance(element.where, str):
        return element.where
    name = element.label or (block if element.kind == "container" else None) or element.kind
    return f"{with_the(name)} at {_place(element)}"


def _place(element: Element) -> str:
    return str(element.where) if isinstance(element.where, str) else _point(element.where)


def _target(look: Sighting) -> str:
    if look.at is not None and all(isinstance(number, int) for number in look.at):
        return f"the {look.target} at {_point(look.at)}"
    return look.target if look.at is None else f"{look.target}, at {_point(look.at)}"


def _standing(holder: str, stood: tuple[float, ...] | None) -> str:
    return holder if stood is None else f"{holder}, at {_point(stood)},"


def _value_point(value: Value) -> str:
    return _point(value) if isinstance(value, tuple) else str(value)


def _point(point: Iterable[float]) -> str:
    return point_words(point, digits=3)


def _knows(level: Level) -> str:
    """Return a clause that names the believers in whose view the holder perceives."""
    return as_known_to(level.path[:-1])


def as_known_to(believers: Sequence[str]) -> str:
    """Return a clause that names the believers in whose view a sentence is true.

    Args:
        believers: Agent names from the outermost believer inwards; empty: the sentence is a fact.

    Returns:
        For example `as far as b knows, ` or `a believes that as far as b knows, `.
    """
    outer = "".join(f"{name} believes that " for name in believers[:-1])
    return f"{outer}as far as {believers[-1]} knows, " if believers else ""


def _teller(level: Level) -> str:
    """Return a clause about the believers who know of a look, such as `a saw that `."""
    names = level.path[:-1]
    return "" if not names else " believes that ".join(names) + " saw that "
