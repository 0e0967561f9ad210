"""Files of films in the form of the food trucks, and the checks that they pass."""

import itertools
import re
from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.files import decode_json, os_errors_of, read_regular
from beliefnest.minds.infer_entries import MOST_HYPOTHESES
from beliefnest.studies.checking import is_whole
from beliefnest.suites.films.film import (
    NOTHING,
    Film,
    FilmCell,
    FilmParameters,
    JudgedPart,
    event_name,
    grid_for,
)
from beliefnest.world.texts import quoted

_UNKNOWN = "unknown"
_PLACE = re.compile(r"spot[A-Za-z0-9]+")
_JUDGED = re.compile(
    r"(?P<about>desire|belief|location|world|actual)s?_(?:(?P<place>spot[A-Za-z0-9]+)_)?"
    r"(?P<names>.+)_mean(?:_(?P<scale>\w+))?"
)
_KINDS: Mapping[str, JudgedPart] = {
    "desire": "desires",
    "belief": "beliefs",
    "location": "locations",
    "world": "locations",
    "actual": "locations",
}
_RATINGS = "1to7"
_MOST_CELLS = 128 * 128


def read_films(path: str | Path) -> tuple[list[Film], FilmParameters]:
    """Read a file of films, with the parameters that it names.

    Raises:
        InputError: The file is missing or not of the form; the message names the film.
    """
    try:
        with os_errors_of(path, "read"):
            content = decode_json(read_regular(Path(path)), dict[str, Any])
    except msgspec.DecodeError as error:
        raise InputError(f"{path} holds no films in JSON: {error}") from None
    try:
        parameters = parameters_from(content)
        films = films_from(content)
        for film in films:
            _check_size(film, parameters)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return films, parameters


def films_from(content: Mapping[str, Any]) -> list[Film]:
    """Return the films of a decoded file.

    Raises:
        InputError: The content is not of the form.
    """
    worlds = _list(content.get("worlds"), "the file", "worlds")
    entries = _list(content.get("scenarios"), "the file", "scenarios")
    groups = _groups(content.get("groups", {}))
    films = []
    for number, entry in enumerate(entries, 1):
        owner = _owner(entry, number)
        index = entry.get("world_set", 1 if len(worlds) == 1 else None)
        if not is_whole(index) or not 1 <= index <= len(worlds):
            raise InputError(
                f"{owner}: world_set is {quoted(index)}; give the number of a world, 1 to "
                f"{len(worlds)}"
            )
        world = worlds[index - 1]
        if not isinstance(world, Mapping):
            raise InputError(
                f"world {index} is {quoted(world)}; give a mapping with size, wall, spot1"
            )
        # A key that the film lacks is read from its world, and then from the file.
        said = {**content, **world, **entry}
        films.append(_Reader(owner, world, entry, said).film(groups))
    names = [film.name for film in films]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two films have the id {name}; give each its own")
    return films


def parameters_from(content: Mapping[str, Any]) -> FilmParameters:
    """Return the parameters that a decoded file names; published ones where it names none.

    Raises:
        InputError: One of them is not of the form.
    """
    numbers = content.get("parameters", {})
    if not isinstance(numbers, Mapping):
        raise InputError(f"parameters are {quoted(numbers)}; give numbers by name")
    usual = FilmParameters()
    levels = numbers.get("reward_levels", list(usual.rewards))
    by_goal = {}
    if isinstance(levels, Mapping):
        by_goal = {str(goal): _levels(values) for goal, values in levels.items()}
        levels = list(usual.rewards)
    grid, smoothing = _grid(numbers.get("agent_prior_grid"), usual)
    return FilmParameters(
        rewards=_levels(levels),
        rewards_by_goal=by_goal,
        discount=_number(numbers, "discount", usual.discount),
        step_cost=_number(numbers, "move_or_eat_cost", usual.step_cost),
        stay_cost=_number(numbers, "stay_cost", usual.stay_cost),
        rationality=_number(numbers, "beta", usual.rationality),
        grid=grid,
        smoothing=smoothing,
    )


def _levels(levels: object) -> tuple[float, ...]:
    values = [levels] if _is_number(levels) else levels
    if not isinstance(values, list) or not values or not all(map(_is_number, values)):
        raise InputError(
            f"parameters: reward_levels are {quoted(levels)}; give a list of numbers, or one for "
            "each goal"
        )
    return tuple(map(float, values))


def _grid(text: object, usual: FilmParameters) -> tuple[int, float]:
    """Return steps and smoothing of a text such as `simplex of step 1/6, b*(1-.075)+.075/3`."""
    if text is None:
        return usual.grid, usual.smoothing
    steps = re.search(r"step 1/(\d{1,3})\b", str(text))
    if steps is None or int(steps[1]) < 1:
        raise InputError(
            f"parameters: agent_prior_grid is {quoted(text)}; write it as "
            "'simplex of step 1/6, shrunk: b*(1-.075)+.075/3'"
        )
    shrunk = re.search(r"\(1-(0?\.\d+)\)", str(text).replace(" ", ""))
    return int(steps[1]), float(shrunk[1]) if shrunk else 0.0


def _number(numbers: Mapping[str, Any], name: str, usual: float) -> float:
    value = numbers.get(name, usual)
    if not _is_number(value):
        raise InputError(f"parameters: {name} is {quoted(value)}; give a number")
    return float(value)


class _Reader:
    """Reader of one film.

    Args:
        owner: The film, in messages.
        world: The world that it is set in.
        entry: Keys of the film.
        said: Keys of the film; missing ones come from its world, then from the file.
    """

    def __init__(
        self,
        owner: str,
        world: Mapping[str, Any],
        entry: Mapping[str, Any],
        said: Mapping[str, Any],
    ) -> None:
        self.owner = owner
        self.world = world
        self.entry = entry
        self.said = said
        human = entry.get("human") or {}
        if not isinstance(human, Mapping):
            raise self.fault(f"human is {quoted(human)}; give judgments by name")
        self.human = human

    def fault(self, text: str) -> InputError:
        """Return an error that names the film."""
        return InputError(f"{self.owner}: {text}")

    def film(self, groups: Mapping[str, str]) -> Film:
        """Return the film, checked."""
        places = {
            key: self.cell(self.world[key], key) for key in self.world if _PLACE.fullmatch(key)
        }
        if not places:
            raise self.fault("its world names no places; give spot1: [x, y] and so on")
        alternatives = self.alternatives(places)
        doubted = tuple(next(iter(alternatives.values())))
        named = {goal for case in alternatives.values() for goal in case.values() if goal}
        goals = self.goals(named)
        stock = self.known([place for place in places if place not in doubted], goals, named)
        present = (goal for goal in stock.values() if goal)
        goals = tuple(dict.fromkeys([*goals, *present])) if goals else ()
        goals = goals or tuple(dict.fromkeys([*(g for g in stock.values() if g), *sorted(named)]))
        if not goals:
            raise self.fault("no goal stands anywhere; name one at a place")
        name = str(self.entry["id"])
        draft = Film(
            name=name,
            size=self.size(),
            walls=frozenset(self.cells("wall", self.world.get("wall", []))),
            places=places,
            known=stock,
            alternatives=alternatives,
            actual=self.actual(alternatives, doubted),
            goals=goals,
            path=tuple(self.cells("path_xy", self.entry.get("path_xy"))),
            ended=self.flag("ends_with_eat"),
            scored=not self.flag("excluded"),
            group=str(self.entry.get("group") or groups.get(name, "")),
        )
        self.check(draft)
        people, errors = self.judgments(draft)
        return replace(draft, people=people, errors=errors)

    def alternatives(self, places: Mapping[str, FilmCell]) -> dict[str, dict[str, str | None]]:
        """Return what may stand at the places in doubt: listed, or every combination."""
        listed = self.said.get("alternatives")
        if listed is not None:
            return self.listed(listed, places)
        doubted = [place for place in places if f"possible_{place}" in self.said]
        if not doubted:
            raise self.fault(
                'nothing is in doubt; give possible_spot2: ["L", "M", null] in its world'
            )
        options = []
        for place in doubted:
            possible = self.said[f"possible_{place}"]
            if not isinstance(possible, list) or not possible:
                raise self.fault(
                    f"possible_{place} is {quoted(possible)}; list goals, null for nothing"
                )
            options.append([self.goal(each, f"possible_{place}") for each in possible])
        combined = [dict(zip(doubted, each, strict=True)) for each in itertools.product(*options)]
        return {_joined(contents.values()): contents for contents in combined}

    def listed(
        self, listed: object, places: Mapping[str, FilmCell]
    ) -> dict[str, dict[str, str | None]]:
        """Return alternatives that are listed: goals by place, with or without names."""
        each_held = list(listed.values()) if isinstance(listed, Mapping) else listed
        if (
            not isinstance(each_held, list)
            or not each_held
            or not all(isinstance(case, Mapping) and case for case in each_held)
            or any(set(case) != set(each_held[0]) or set(case) - set(places) for case in each_held)
        ):
            raise self.fault(
                "alternatives do not all name goals for the same places of its world; give "
                '[{"spot1": "K", "spot2": "L"}, {"spot1": "L", "spot2": "K"}]'
            )
        order = [place for place in places if place in each_held[0]]
        read = [
            {place: self.goal(case[place], "alternatives") for place in order} for case in each_held
        ]
        names = [_joined(case.values()) for case in read]
        if isinstance(listed, Mapping):
            names = [str(name) for name in listed]
        return dict(zip(names, read, strict=True))

    def goals(self, named: Iterable[str]) -> tuple[str, ...]:
        """Return the goals that are named in order, by `goals` or by a key of judgments."""
        listed = self.said.get("goals")
        if listed is not None:
            if not isinstance(listed, list) or not listed or not all(map(_is_name, listed)):
                raise self.fault(f"goals are {quoted(listed)}; list their names")
            return tuple(dict.fromkeys(listed))
        for key in self.human:
            match = _JUDGED.fullmatch(key)
            if match and match["about"] == "desire":
                words = match["names"].split("_")
                if len(words) == 1 and words[0] not in named and words[0].isupper():
                    words = list(words[0])
                return tuple(dict.fromkeys(words))
        return ()

    def known(
        self, places: Sequence[str], goals: Sequence[str], named: Iterable[str]
    ) -> dict[str, str | None]:
        """Return the contents of the places that are not in doubt.

        The file names the contents of some places. The goals that stand at no such place are
        distributed over the other places in order. If there are none, each other place holds a goal
        with the name of the place.
        """
        contents: dict[str, str | None] = {}
        silent = []
        for place in places:
            for key in (f"true_{place}", f"{place}_holds"):
                if key in self.said:
                    contents[place] = self.goal(self.said[key], key)
                    break
            else:
                silent.append(place)
        used = {*named, *contents.values()}
        left = [goal for goal in goals if goal not in used]
        if left and len(left) < len(silent):
            raise self.fault(
                f"{' and '.join(silent)} hold {', '.join(left)}, but the file does not say "
                f"which place holds which; add true_{silent[0]}"
            )
        if len(left) > len(silent) > 0:
            raise self.fault(f"{', '.join(left)} may each be at {silent[0]}; add true_{silent[0]}")
        contents.update(zip(silent, left or silent, strict=False))
        return {place: contents[place] for place in places}

    def actual(
        self, alternatives: Mapping[str, Mapping[str, str | None]], doubted: Sequence[str]
    ) -> tuple[str, ...]:
        """Return the alternatives that the observer holds possible."""
        truth = self.said.get("actual")
        if truth is not None and truth != _UNKNOWN:
            if truth not in alternatives:
                names = ", ".join(alternatives)
                raise self.fault(
                    f"actual is {quoted(truth)}; give {quoted(_UNKNOWN)} or one of {names}"
                )
            return (str(truth),)
        possible = list(alternatives)
        for place in doubted:
            key = f"true_{place}"
            if key not in self.said:
                if truth is None and not self.asks_for_locations:
                    raise self.fault(f'{key} is missing; give a goal, null or "{_UNKNOWN}"')
                continue
            value = self.said[key]
            if value == _UNKNOWN:
                continue
            true = self.goal(value, key)
            options = {case[place] for case in alternatives.values()}
            if true not in options:
                text = ", ".join(sorted(goal or "null" for goal in options))
                raise self.fault(f"{key} is {quoted(value)}, which is none of the possible: {text}")
            possible = [name for name in possible if alternatives[name][place] == true]
        if not possible:
            raise self.fault("no alternative has what its true_spot keys say; correct one of them")
        return tuple(possible)

    @property
    def asks_for_locations(self) -> bool:
        """Return True if people judged locations."""
        matches = filter(None, map(_JUDGED.fullmatch, self.human))
        return any(_KINDS[match["about"]] == "locations" for match in matches)

    def judgments(
        self, film: Film
    ) -> tuple[dict[JudgedPart, dict[str, float]], dict[JudgedPart, dict[str, float]]]:
        """Return judgments of people and their standard errors."""
        people: dict[JudgedPart, dict[str, float]] = {}
        errors: dict[JudgedPart, dict[str, float]] = {}
        for key, values in self.human.items():
            match = _JUDGED.fullmatch(key)
            if match is None:
                if "_mean" in key:
                    raise self.fault(
                        f"human.{key} is not understood; name desire, belief or location, then "
                        "goals or alternatives, as in belief_LMnone_mean_norm"
                    )
                continue
            about = _KINDS[match["about"]]
            names = self.judged(film, key, match, about)
            means = self.numbers(key, values, len(names))
            if about != "desires" and match["scale"] == _RATINGS:
                means = self.normalised(key, means)
            rated = {n: value for n, value in zip(names, means, strict=True) if value is not None}
            if set(rated) & set(people.get(about, {})):
                raise self.fault(f"human.{key} judges again what another key judges; keep one")
            people[about] = {**people.get(about, {}), **rated}
            spread = self.human.get(f"{match['about']}_se")
            if spread is not None and isinstance(spread, list) and len(spread) == len(names):
                spreads = self.numbers(f"{match['about']}_se", spread, len(names))
                pairs = zip(names, spreads, strict=True)
                errors[about] = {name: value for name, value in pairs if value is not None}
        return people, errors

    def judged(self, film: Film, key: str, match: re.Match[str], about: JudgedPart) -> list[str]:
        """Return the subject of a key's values: goals, alternatives, or contents of places."""
        words, place = match["names"].split("_"), match["place"]
        if about == "desires":
            names: list[str] | None = self.spelled(words, film.goals)
            named_there: Iterable[str] = film.goals
        elif all(word in film.alternatives for word in words):
            names, named_there = words, film.alternatives
        else:
            names = self.contents(film, words, place)
            named_there = film.events
        if names is None or len(set(names)) < len(names) or not set(names) <= set(named_there):
            raise self.fault(
                f"human.{key} is not understood: {quoted(match['names'])} does not spell different "
                f"names of {', '.join(named_there)}"
            )
        return names

    def contents(self, film: Film, words: Sequence[str], place: str | None) -> list[str] | None:
        """Return names of events that words spell; None: they spell none."""
        doubted = tuple(next(iter(film.alternatives.values())))
        if place is not None and place not in doubted:
            return None
        spelled = self.spelled(words, (*film.goals, NOTHING))
        if spelled is None:
            return None
        if place is not None and len(doubted) > 1:
            return [event_name(place, goal) for goal in spelled]
        by_contents = {_joined(case.values()): name for name, case in film.alternatives.items()}
        if len(spelled) % len(doubted):
            return None
        chunks = [
            "+".join(spelled[start : start + len(doubted)])
            for start in range(0, len(spelled), len(doubted))
        ]
        return [by_contents.get(chunk, chunk) for chunk in chunks]

    def spelled(self, words: Iterable[str], names: Iterable[str]) -> list[str] | None:
        """Split words into names and return these; None if a word does not consist of names."""
        longest_first = sorted(names, key=len, reverse=True)
        pattern = re.compile("|".join(map(re.escape, longest_first)))
        spelling: list[str] = []
        for word in words:
            parts = pattern.findall(word)
            if "".join(parts) != word:
                return None
            spelling += parts
        return spelling

    def numbers(self, key: str, values: object, count: int) -> list[float | None]:
        """Return numbers, None where one is missing."""
        if (
            not isinstance(values, list)
            or len(values) != count
            or not all(value is None or _is_number(value) for value in values)
        ):
            raise self.fault(
                f"human.{key} is {quoted(values)}; give {count} numbers, null for missing"
            )
        return [None if value is None else float(value) for value in values]

    def normalised(self, key: str, ratings: Sequence[float | None]) -> list[float | None]:
        """Return ratings from 1 to 7, normalised as published: minus 1, divided by their sum."""
        shares = [0.0 if rating is None else rating - 1 for rating in ratings]
        if min(shares) < 0 or sum(shares) <= 0:
            raise self.fault(f"human.{key} has no ratings from 1 to 7; let one be above 1")
        return [
            None if rating is None else share / sum(shares)
            for rating, share in zip(ratings, shares, strict=True)
        ]

    def check(self, film: Film) -> None:
        """Refuse places, walls and steps that are not on the floor."""
        free = {
            (x, y) for x in range(1, film.size[0] + 1) for y in range(1, film.size[1] + 1)
        } - film.walls
        for place, cell in film.places.items():
            if cell not in free:
                raise self.fault(f"{place} at {list(cell)} is off the floor or in a wall")
        if len(set(film.places.values())) < len(film.places):
            raise self.fault("two places are in one cell; move one")
        for number, cell in enumerate(film.path, 1):
            if cell not in free:
                raise self.fault(
                    f"step {number} of path_xy, {list(cell)}, is off the floor or in a wall"
                )
        if not film.path:
            raise self.fault("path_xy is empty; give the cells of the agent, one for each tick")

    def size(self) -> tuple[int, int]:
        """Return the size of the floor."""
        size = self.world.get("size")
        width, height = self.cell(size, "size")
        if min(width, height) < 1 or width * height > _MOST_CELLS:
            raise self.fault(
                f"size is {quoted(size)}; give two numbers from 1, whose product is at "
                f"most {_MOST_CELLS}"
            )
        return width, height

    def flag(self, key: str) -> bool:
        """Return a truth value; a missing one is false."""
        value = self.entry.get(key, False)
        if not isinstance(value, bool):
            raise self.fault(f"{key} is {quoted(value)}; give true or false")
        return value

    def goal(self, value: object, key: str) -> str | None:
        """Return a goal's name, None for nothing."""
        if value is None or value == NOTHING:
            return None
        if not _is_name(value):
            raise self.fault(f"{key} names the goal {quoted(value)}; give a name or null")
        return str(value)

    def cells(self, key: str, listed: object) -> list[FilmCell]:
        """Return a list of cells."""
        if not isinstance(listed, list):
            raise self.fault(f"{key} is {quoted(listed)}; list cells as [x, y]")
        return [self.cell(each, key) for each in listed]

    def cell(self, numbers: object, key: str) -> FilmCell:
        """Return two whole numbers."""
        if not isinstance(numbers, list) or len(numbers) != 2 or not all(map(is_whole, numbers)):
            raise self.fault(f"{key} has {quoted(numbers)}; give two whole numbers [x, y]")
        return int(numbers[0]), int(numbers[1])


def _check_size(film: Film, parameters: FilmParameters) -> None:
    """Refuse more hypotheses than fit into memory."""
    if grid_for(film, parameters) is None:
        raise InputError(
            f"film {film.name} has more hypotheses than fit into memory, at most "
            f"{MOST_HYPOTHESES:,}; name fewer reward_levels, or fewer alternatives"
        )


def _owner(entry: object, number: int) -> str:
    if not isinstance(entry, Mapping) or not isinstance(entry.get("id"), int | str):
        raise InputError(f"film {number} of scenarios has no id; give it a number")
    return f"film {entry['id']}"


def _groups(groups: object) -> dict[str, str]:
    """Return the group of each film by id."""
    if not isinstance(groups, Mapping) or not all(isinstance(ids, list) for ids in groups.values()):
        raise InputError(f"groups are {quoted(groups)}; give lists of film ids by name")
    return {str(film): str(name) for name, films in groups.items() for film in films}


def _list(listed: object, owner: str, key: str) -> list[Any]:
    if not isinstance(listed, list) or not listed:
        raise InputError(
            f"{owner} has no list of {key}, which a file of films in this format must have"
        )
    return listed


def _joined(goals: Iterable[str | None]) -> str:
    return "+".join(goal or NOTHING for goal in goals)


def _is_name(value: object) -> bool:
    return isinstance(value, str) and value not in ("", _UNKNOWN, NOTHING) and "." not in value


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
