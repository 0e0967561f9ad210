"""Participants whom researchers exclude, with reasons."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from beliefnest.errors import InputError
from beliefnest.studies.participants.answers import PersonAnswer
from beliefnest.studies.sheets import read_sheet, spoilt_text
from beliefnest.world.texts import quoted
from beliefnest.world.words import counted

_IDS = ("participant", "id")
_REASON = "reason"


def read_exclusions(file: Path, answers: Sequence[PersonAnswer]) -> dict[str, str]:
    """Return the reason for each excluded participant, from a CSV file.

    Args:
        file: The file, with the columns `participant` (or `id`) and `reason`.
        answers: All answers, also those of the excluded participants.

    Raises:
        InputError: The file has another form, or names somebody who gave no answer; the message
            names line and column.
    """
    sheet = read_sheet(file, (_REASON,))
    column = next((name for name in _IDS if name in sheet.columns), None)
    if column is None:
        raise InputError(
            f"{file}:1 has no column {quoted(_IDS[0])}; give the ids of participants in it"
        )
    participants = {answer.participant for answer in answers}
    exclusions: dict[str, str] = {}
    for line, row in sheet.rows:
        participant, reason = row[column].strip(), " ".join(row[_REASON].split())
        where = f"{file}:{line}, column"
        if participant not in participants:
            spoilt = spoilt_text(participant)
            harm = f", which is {spoilt} that a spreadsheet made" if spoilt else ""
            raise InputError(
                f"{where} {column}: nobody who answered is {quoted(participant)}{harm}; correct "
                "the id, and give the files of all participants, also of excluded ones"
            )
        if not reason:
            raise InputError(
                f"{where} {_REASON}: is empty; say why {quoted(participant)} is excluded"
            )
        if exclusions.setdefault(participant, reason) != reason:
            raise InputError(
                f"{where} {_REASON}: {quoted(participant)} is excluded for "
                f"{quoted(exclusions[participant])} as well; give one reason"
            )
    return exclusions


def excluded_words(reasons: Mapping[str, int]) -> str:
    """Return how many participants were excluded for which reasons, in words."""
    texts = [f"{count} for {quoted(reason)}" for reason, count in sorted(reasons.items())]
    return f"{counted(sum(reasons.values()), 'participant')} by a list ({', '.join(texts)})"
