"""Rules without any belief about others: shortcuts that a task must not reward.

A rule fetches, puts and switches what the agent's goal names. Of several places it takes the one
that its key ranks first, such as the nearest. It reads the agent's own belief and the goals that
the agent knows, and nothing of what others believe.
"""

import math
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from beliefnest.episodes.agent_view import GO_ON, AgentView
from beliefnest.episodes.imagination import Imagination
from beliefnest.episodes.policies.candidates import calls_of, claims_of_mind, items_of, said
from beliefnest.errors import UnknownNameError
from beliefnest.scenarios.goals import Goal
from beliefnest.skills.calls import Call, program_of
from beliefnest.world.claims import Claim
from beliefnest.world.texts import quoted
from beliefnest.world.values import Position

Tells = Literal["", "tell", "tell-all"]

KEYS = ("nearest", "farthest", "first", "last", "last-seen", "copy", "any")
"""Keys of places. `nearest` and `farthest` may name an agent: `nearest-bob`."""
_PLAN = "plan"
"""Put in place of a key: after speaking, the agent plans as `search:0` does."""
_FORMS = (
    f"rules are {', '.join(KEYS)}, nearest-AGENT, farthest-AGENT and linear=W/W/...; "
    "nearest+farthest takes from the one and puts into the other; first:tell and first:tell-all "
    "speak before they act, and first+plan:tell then acts as search:0"
)
_TELLS: Mapping[str, Tells] = {"": "", "tell": "tell", "tell-all": "tell-all"}


@dataclass(frozen=True)
class Rule:
    """Policy that follows a rule: it chooses its program once and plays it to its end.

    Attributes:
        take: Key of the place to take from, to switch at or to go to.
        put: Key of the place to put into, where the goal leaves it open.
        tells: `tell`: first says one thing, of the place that `take` ranks first; `tell-all`: all
            things. They are true, or what the goal wants others to believe falsely.

    With `plan` as `put`, the agent only speaks by the rule and then acts as `search:0` does.
    """

    take: str
    put: str = "nearest"
    tells: Tells = ""

    def act(self, view: AgentView) -> str:
        """Return the program of the rule."""
        if self.put == _PLAN:
            return self._planned(view)
        if any(view.before):
            return GO_ON if view.last.how == "cut" else ""
        if "copy" in (self.take, self.put) and not view.round:
            # Look first where the partner goes.
            return ""
        mind = view.imagine(0)
        calls = [*self._told(view, mind), *self._deeds(view, mind)]
        return program_of(calls)

    def _planned(self, view: AgentView) -> str:
        if not any(view.before) and not view.round:
            return program_of(list(self._told(view, view.imagine(0))))
        if view.last.how == "cut" and "say(" in view.last.program:
            return GO_ON
        from beliefnest.episodes.policies.search import Search

        return Search(0).act(view)

    def _told(self, view: AgentView, mind: Imagination) -> Iterator[Call]:
        if not self.tells or not view.may_speak:
            return
        claims = _sayable(view, mind)
        if self.tells == "tell" and claims:
            place = chosen(self.take, list(claims.values()), view)
            yield said(next(claim for claim, at in claims.items() if at == place))
        else:
            yield from map(said, claims)

    def _deeds(self, view: AgentView, mind: Imagination) -> Iterator[Call]:
        goals = _goals_of(view)
        inventory = mind.world.agents[view.agent].inventory
        for item in items_of(goals):
            source = None
            if not inventory.get(item, 0) and (sources := places_of(view, mind, item)):
                source = chosen(self.take, sources, view)
                yield Call("getItemFromChest", (source, {item: 1}))
            sinks = _sinks(view, mind, goals, item, source)
            if sinks and (source is not None or inventory.get(item, 0)):
                yield Call("depositItemIntoChest", (chosen(self.put, sinks, view), {item: 1}))
        for skill in ("turnOnLever", "goToPosition"):
            calls = [call for call in calls_of(mind, view.agent, goals) if call.skill == skill]
            if calls:
                place = chosen(self.take, [call.args[0] for call in calls], view)
                yield next(call for call in calls if call.args[0] == place)
                return


def rule_of(text: str) -> Rule:
    """Return the rule of a name, such as `nearest`, `nearest+farthest` or `first:tell`.

    Raises:
        UnknownNameError: There is no such rule.
    """
    keys, _, tells = text.partition(":")
    take, _, put = keys.partition("+")
    for key, others in ((take, KEYS), (put or "nearest", (*KEYS, _PLAN))):
        order, _, rest = key.partition("-")
        is_known = key in others or (order in ("nearest", "farthest") and bool(rest))
        if not is_known and not _weights(key):
            raise UnknownNameError(f"there is no rule {quoted(key)}; {_FORMS}")
    if tells not in _TELLS:
        raise UnknownNameError(
            f"{quoted(tells)} in the rule {quoted(text)} is unknown; give tell or tell-all"
        )
    return Rule(take, put or "nearest", _TELLS[tells])


def _sayable(view: AgentView, mind: Imagination) -> dict[Claim, Position]:
    """Return what an agent may say, each claim with the place of what it is about.

    An agent whose goal is that others believe what is not so says that; any other says the truth.
    """
    truths = claims_of_mind(mind, list(view.brief.considered), lies=False)
    true = {claim: claim.cell for claim in truths}
    places = {claim.item: at for claim, at in true.items()}
    wanted = {
        Claim.located(item, each.fact.store)
        for each in view.goal.reach
        if each.path and each.fact.store is not None
        for item in each.fact.items
    }
    false = {claim for claim in wanted - set(true) if claim.item in places}
    lies = claims_of_mind(mind, [view.goal], lies=True)
    return {claim: places[claim.item] for claim in lies if claim in false} or true


def places_of(view: AgentView, mind: Imagination, item: str) -> list[Position]:
    """Return the containers in reach that hold an item, or else those that may hold it."""
    near = [at for at in sorted(mind.world.containers) if mind.may_reach(view.agent, at)]
    contents = view.state.containers
    holds = [at for at in near if at in contents and contents[at].items.get(item, 0)]
    return holds or [at for at in near if at not in contents or not contents[at].complete]


def _sinks(
    view: AgentView, mind: Imagination, goals: Sequence[Goal], item: str, source: Position | None
) -> list[Position]:
    """Return the containers into which an item may be put: its store if that is in reach."""
    facts = [c.fact for goal in goals for c in goal.conditions if item in c.fact.items]
    if any(fact.holder == view.agent for fact in facts):
        return []
    stores = [fact.store for fact in facts if fact.store is not None]
    near = [at for at in sorted(mind.world.containers) if mind.may_reach(view.agent, at)]
    return [at for at in stores if at in near] or [at for at in near if at != source]


def _goals_of(view: AgentView) -> list[Goal]:
    """Return the goal of the agent, or those of an agent whose goal it does not know."""
    goal = view.goal
    return [goal] if goal.conditions else list(view.brief.considered)


def chosen(key: str, places: Sequence[Position], view: AgentView) -> Position:
    """Return the place that a key ranks first; of equal ones the first in order."""
    ordered = sorted(set(places))
    score = _score(key, view)
    if score is None:
        number = random.Random(f"{view.brief.seed} {view.agent} {ordered}").randrange(len(ordered))
        return ordered[number]
    weights = _weights(key)
    if weights:
        return ordered[int(np.argmax(features_of(ordered, view) @ np.array(weights)))]
    return min(ordered, key=score)


def _score(key: str, view: AgentView) -> Callable[[Position], float] | None:
    """Return the function of a place whose least value a key chooses; None: a draw."""
    if key == "any":
        return None
    order, _, name = key.partition("-")
    apart = _apart(_partner(view) if key == "copy" else name or view.agent, view)
    scores: Mapping[str, Callable[[Position], float]] = {
        "last": lambda place: -float(np.dot(place, (1e6, 1e3, 1))),
        "last-seen": lambda place: -_seen_at(place, view),
        "copy": apart,
        "nearest": apart,
        "farthest": lambda place: -apart(place),
    }
    return scores.get(key) or scores.get(order) or (lambda place: 0.0)


def _apart(name: str, view: AgentView) -> Callable[[Position], float]:
    agent = view.state.agents.get(name)
    feet = None if agent is None else agent.position
    if feet is None:
        return lambda place: 0.0
    return lambda place: math.dist(feet, (place[0] + 0.5, place[1], place[2] + 0.5))


def _partner(view: AgentView) -> str:
    """Return the nearest other agent of known place; the agent itself if there is none."""
    others = [name for name in view.brief.agents if name != view.agent]
    feet = view.state.agents[view.agent].position
    names = [n for n in others if view.state.agents[n].position is not None]
    if feet is None or not names:
        return view.agent
    return min(names, key=lambda name: math.dist(feet, view.state.agents[name].position or feet))


def _seen_at(place: Position, view: AgentView) -> float:
    content = view.state.containers.get(place)
    basis = content.basis if content is not None else view.state.blocks.basis(place)
    return -1.0 if basis is None else float(basis.observed_at)


def features_of(places: Sequence[Position], view: AgentView) -> npt.NDArray[np.float64]:
    """Return the features of places, a row each, scaled to mean 0 and deviation 1 among them.

    Features are the distances from all agents, x, z, the order, and the tick of the last look.
    """
    agents = [_apart(name, view) for name in (view.agent, *_others(view))]
    rows = [
        [*(apart(at) for apart in agents), at[0], at[2], number, _seen_at(at, view)]
        for number, at in enumerate(places)
    ]
    table = np.array(rows, dtype=np.float64)
    spread = table.std(axis=0)
    scaled: npt.NDArray[np.float64] = (table - table.mean(axis=0)) / np.where(spread, spread, 1.0)
    return scaled


def _others(view: AgentView) -> list[str]:
    return [name for name in view.brief.agents if name != view.agent]


def linear_key(weights: Sequence[float]) -> str:
    """Return the key of the place with the greatest weighted sum of features."""
    return "linear=" + "/".join(f"{weight:.2f}" for weight in weights)


def _weights(key: str) -> tuple[float, ...]:
    """Return the weights in the key `linear=W/W/...`; empty: it is another key."""
    kind, equals, rest = key.partition("=")
    if kind != "linear" or not equals:
        return ()
    try:
        return tuple(float(text) for text in rest.split("/"))
    except ValueError:
        return ()
