"""Films as cells of a plan: each judged by the model, and by the model without a part."""

from collections.abc import Sequence
from typing import Any, ClassVar

import msgspec

from beliefnest.plan.cells import digest
from beliefnest.plan.terms import PlayStage
from beliefnest.studies.suite_cells import SuiteKey, suite_kind
from beliefnest.suites.films.film import WHOLE, Film, FilmParameters, FilmRow
from beliefnest.suites.films.film_inference import LESIONS, Lesion, judge

FILM_KIND = suite_kind(
    "films", FilmRow, ("variant", "about"), is_judged=False, means=("model", "people")
)


class FilmPlay(msgspec.Struct, frozen=True):
    """Film, judged once.

    Attributes:
        key: Identity of the cell.
        film: The film.
        parameters: Parameters of the model.
        lesion: The part that the model lacks; None: none.
    """

    key: SuiteKey
    film: Film
    parameters: FilmParameters
    lesion: Lesion | None
    world: ClassVar[str] = ""
    is_quick: ClassVar[bool] = True

    def plain(self) -> dict[str, Any]:
        """Return the cell as plain values for the plan."""
        return self.key.planned(self.film.name, [self._begun])

    @property
    def _begun(self) -> dict[str, Any]:
        film = self.film
        names = {"film": film.name, "group": film.group or None, "scored": film.scored}
        return {**names, "variant": self.lesion or WHOLE}

    def play(self, stage: PlayStage) -> dict[str, Any]:
        """Act the film out, and return the judgments as plain values.

        Raises:
            InputError: The film does not fit the model.
        """
        judgment, film = judge(self.film, self.parameters, self.lesion), self.film
        rows = [
            FilmRow(
                **self._begun,
                about=about,
                name=name,
                model=value,
                people=film.people.get(about, {}).get(name),
                people_se=film.errors.get(about, {}).get(name),
                impossible=judgment.impossible,
            )
            for about, means in judgment.model.items()
            for name, value in means.items()
        ]
        return {"error": None, "rows": msgspec.to_builtins(rows)}


def film_cells(suite: str, films: Sequence[Film], parameters: FilmParameters) -> list[FilmPlay]:
    """Return the cells of films: each film with the model, and with each that lacks a part."""
    lesions: list[Lesion | None] = [None, *LESIONS]
    return [
        FilmPlay(_key(suite, film, parameters, lesion), film, parameters, lesion)
        for lesion in lesions
        for film in films
    ]


def _key(suite: str, film: Film, parameters: FilmParameters, lesion: Lesion | None) -> SuiteKey:
    plain = {**msgspec.to_builtins(film), "walls": sorted(film.walls)}
    content = digest([plain, msgspec.to_builtins(parameters)])[:16]
    return SuiteKey(suite, content, {"seed": 0, "variant": lesion or WHOLE})
