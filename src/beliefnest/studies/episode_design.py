"""Checked design of a study of episodes: the values that it combines."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

import msgspec

from beliefnest.episodes.policies import with_query
from beliefnest.llm.budget import RunLimits
from beliefnest.studies.checking import (
    StudyKeyError,
    check_cells,
    check_count,
    check_once,
    checked_lists,
    is_count,
)
from beliefnest.studies.episode_rows import policy_named
from beliefnest.world.texts import quoted
from beliefnest.worlds.names import check_world

Order = int | Literal["omniscient"]
Policies = str | Mapping[str, str | Mapping[str, str]]
"""A policy of all players, policies by agent, or a name for the table with policies by agent."""


class Player(msgspec.Struct, frozen=True):
    """Player of a study: a policy at an order.

    Attributes:
        name: `search`, `model:MODEL`, the name of a policy, or that of policies by agent.
        order: Order of Theory of Mind; None: the name is complete without it.
        policies: A policy as the command line takes it, or policies by agent.
        place: Key of the study, and number of the entry that names the player.
    """

    name: str
    order: Order | None
    policies: str | Mapping[str, str]
    place: tuple[str, int]

    @property
    def text(self) -> str:
        """Return the policies as one text."""
        return self.policies if isinstance(self.policies, str) else self.name


_ORDERED = ("search", "infer")
"""Policies that play at each of the orders of a study."""


class EpisodeDesign(msgspec.Struct, frozen=True):
    """Design of a study of episodes.

    Attributes:
        tasks: Names of built-in tasks or scenarios, or paths of files of either.
        policies: Policies of all players, or mappings from agent to policy. `search` and `infer`
            are played at each of the `orders`; other names are as on the command line.
        models: Names of models that play, each at each of the `orders`.
        orders: Orders of Theory of Mind; `omniscient` is an upper bound.
        seeds: Numbers of instances; in the first repeat, they are also the seeds of episodes.
        repeats: Number of times that each cell is played.
        variations: Lists of values of parameters; all combinations are played.
        conditions: Numbers of conditions of scenarios; None: the scenario as written.
        world: Name of the world.
        help: Measure help, which plays further branches.
        query: Settings of requests of models, as in the names of policies after `?`.
        limits: Limits of tokens and cost of the whole study.
    """

    tasks: tuple[str, ...]
    policies: tuple[Policies, ...] = ()
    models: tuple[str, ...] = ()
    orders: tuple[Order, ...] = ()
    seeds: tuple[int, ...] = (0,)
    repeats: int = 1
    variations: Mapping[str, Sequence[Any]] = msgspec.field(default_factory=dict)
    conditions: tuple[int, ...] | None = None
    world: str = "scripted"
    help: bool = False
    query: str = ""
    limits: RunLimits = msgspec.field(default_factory=RunLimits)

    def __post_init__(self) -> None:
        for name in ("tasks", "policies", "models", "orders", "seeds"):
            check_once(name, getattr(self, name))
        for name in ("tasks", "seeds"):
            if not getattr(self, name):
                raise StudyKeyError(name, f"a study without {name} has no cells; name at least one")
        if not self.policies and not self.models:
            raise StudyKeyError(
                "policies", "a study of episodes needs policies, or models and orders, that play"
            )
        for policies in self.policies:
            _check_policies(policies)
        if not self.orders and (self.models or any(each in _ORDERED for each in self.policies)):
            raise StudyKeyError(
                "orders",
                "orders is empty; models, search and infer play at the orders named there, such as "
                "orders: [0, 1]",
            )
        named = [player.text for player in self.players]
        if twice := next((name for name in named if named.count(name) > 1), None):
            raise StudyKeyError(
                "policies", f"two of the policies have the name {quoted(twice)}; give each its own"
            )
        for order in self.orders:
            if order != "omniscient" and (isinstance(order, bool) or not isinstance(order, int)):
                raise StudyKeyError(
                    "orders", f"orders has {quoted(order)}; give whole numbers, or 'omniscient'"
                )
        check_count("repeats", self.repeats)
        check_cells("repeats", self.repeats * len(self.seeds))
        checked_lists(self.variations)
        check_world(self.world, servers=False)

    @property
    def players(self) -> tuple[Player, ...]:
        """Return all players in order."""
        return tuple(self._players())

    def _players(self) -> Iterator[Player]:
        for number, policies in enumerate(self.policies):
            place = ("policies", number)
            if isinstance(policies, str) and policies in _ORDERED:
                for order in self.orders:
                    yield Player(policies, order, policy_named(policies, str(order)), place)
            else:
                name, own = _named(policies)
                yield Player(name, None, _with_query(own, self.query), place)
        for number, model in enumerate(self.models):
            for order in self.orders:
                name = f"model:{model}"
                policy = with_query(policy_named(name, str(order)), self.query)
                yield Player(name, order, policy, ("models", number))

    @property
    def setting(self) -> dict[str, Any]:
        """Return the settings that affect the results of all cells."""
        return {"world": self.world, **({"help": True} if self.help else {})}

    @property
    def asked(self) -> tuple[str, ...]:
        """Names of all models that are asked."""
        return self.models

    def plain(self) -> dict[str, Any]:
        """Return the design as plain values for the study's plan."""
        return {
            "tasks": list(self.tasks),
            "players": [player.text for player in self.players],
            "models": list(self.models),
            "orders": list(self.orders),
            "seeds": list(self.seeds),
            "repeats": self.repeats,
            "variations": {name: list(values) for name, values in self.variations.items()},
            "conditions": None if self.conditions is None else list(self.conditions),
            **self.setting,
        }


def _check_policies(policies: object) -> None:
    own = policies
    if isinstance(policies, Mapping) and len(policies) == 1:
        (value,) = policies.values()
        own = value if isinstance(value, Mapping) else policies
    names = own.values() if isinstance(own, Mapping) else [own]
    if not names or not all(isinstance(name, str) for name in names):
        raise StudyKeyError(
            "policies",
            f"policies has {quoted(policies)}; give names as `beliefnest play --agent` takes them, "
            "mappings from agent to such a name, or a mapping from a name to one such mapping",
        )


def _named(policies: Policies) -> tuple[str, str | Mapping[str, str]]:
    """Return the name of policies in the table, and the policies."""
    if isinstance(policies, str):
        return policies, policies
    ((first, value), *_) = policies.items()
    if isinstance(value, Mapping):
        return first, value
    own = {agent: str(policy) for agent, policy in policies.items()}
    return ",".join(f"{agent}={policy}" for agent, policy in own.items()), own


def listed(policies: Sequence[Policies] | Policies) -> tuple[Policies, ...]:
    """Return one or several policies as a tuple."""
    return (policies,) if isinstance(policies, str | Mapping) else tuple(policies)


def _with_query(policies: str | Mapping[str, str], query: str) -> str | Mapping[str, str]:
    if isinstance(policies, str):
        return with_query(policies, query)
    return {agent: with_query(policy, query) for agent, policy in policies.items()}


def seeds_of(seeds: Sequence[int] | int, first: int) -> tuple[int, ...]:
    """Return the numbers of instances: the list `seeds`, or `seeds` numbers from `first` on.

    Raises:
        InputError: `seeds` is neither a count nor a list of whole numbers.
    """
    if isinstance(seeds, int):
        if not is_count(seeds):
            raise StudyKeyError(
                "seeds", f"seeds is {quoted(seeds)}; give at least 1, or a list of seeds"
            )
        check_cells("seeds", seeds)
        return tuple(range(first, first + seeds))
    return tuple(seeds)
