"""A slow inference, written from the text of the design alone; the minds are checked against it.

It uses dictionaries and plain numbers and shares no code with `beliefnest.minds`. Percepts and
sight come from nests of their own: one small scripted world for each alternative, place and tick.

Scenes have one walkable level; all but the agent stand still and no block changes, so that a node
knows its world from the first moment on. The agent stands in the centre of its cell, one tick is
one action, and sight is all round. Where the design is open, the choice made here is:

* A bump into a wall is an action like any other and leaves the agent in its cell.
* A diagonal step whose corners are not both free is such a bump.
* Without a perceived event, standing still may have been an act that nobody can see (`at`,
  `block`); the agent then stays for ever.
* Neighbouring cells are those that a step leads to: 4, or 8 with diagonal steps.
* `ended=True` asks for an act after the last tick, so the agent had not acted before.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import beliefnest as bn

Cell = tuple[int, int, int]
Knowledge = frozenset[str]
Mind = tuple[Cell, Knowledge, bool]
"""Cell, alternatives that are possible by percepts, and True once the agent has acted."""

STRAIGHT = [(1, 0), (-1, 0), (0, 1), (0, -1)]
CORNERS = [(1, 1), (1, -1), (-1, 1), (-1, -1)]


@dataclass(frozen=True)
class Question:
    """One inference: the arguments of a `MindModel`, and of `infer`."""

    agent: str
    goals: Mapping[str, Mapping[str, Any]]
    utilities: Sequence[Mapping[str, float]]
    doubt: Mapping[str, Mapping[str, Mapping[Any, Any]]]
    credences: Sequence[Sequence[float]]
    actual: Any = None
    rationality: float = 1.0
    discount: float = 0.9
    step_cost: float = 1.0
    stay_cost: float = 0.0
    act_cost: float = 1.0
    diagonal: bool = False
    ended: bool = False


@dataclass(frozen=True)
class Moment:
    """State of the observer's node at one tick, in plain values."""

    tick: int
    box: Any
    blocks: Mapping[Cell, str | None]
    contents: Mapping[Cell, tuple[tuple[tuple[str, int], ...], bool]]
    agents: Mapping[str, tuple[tuple[float, float, float], bool]]
    events: tuple[tuple[str, str, Any], ...]


def moment(state: Any) -> Moment:
    """Copy a state."""
    return Moment(
        state.tick,
        state.box,
        {place: state.blocks[place] for place in state.blocks},
        {
            place: (tuple(sorted(content.items.items())), content.complete)
            for place, content in state.containers.items()
        },
        {
            name: (tuple(agent.position), agent.current)
            for name, agent in state.agents.items()
            if agent.position is not None
        },
        tuple(
            (str(event.kind), event.actor, event.detail)
            for event in state.events
            if event.tick == state.tick
        ),
    )


@dataclass
class Reference:
    """The posterior of one question over the moments of one node.

    Args:
        moments: The observer's node at each tick, without gaps.
        owner: The agent whose belief the node is; None in reality.
        question: What is asked.
        perception: Options of the nest.
    """

    moments: Sequence[Moment]
    owner: str | None
    question: Question
    perception: bn.Perception
    _percepts: dict[Any, Any] = field(default_factory=dict)
    _values: dict[Any, Any] = field(default_factory=dict)
    _moves: dict[Any, Mind] = field(default_factory=dict)
    _choices: dict[Any, list[tuple[Any, ...]]] = field(default_factory=dict)
    _cells: list[Cell] = field(default_factory=list)

    def __post_init__(self) -> None:
        agent = self.question.agent
        self.course = [
            at for at, now in enumerate(self.moments) if now.agents.get(agent, (None, False))[1]
        ]

    # Contents of places.

    def blocks(self, name: str) -> dict[Cell, str | None]:
        return dict(self.moments[0].blocks) | dict(self.question.doubt[name].get("blocks", {}))

    def contents(self, name: str) -> dict[Cell, dict[str, int]]:
        known = {place: dict(items) for place, (items, _) in self.moments[0].contents.items()}
        return known | {
            place: dict(items)
            for place, items in self.question.doubt[name].get("containers", {}).items()
        }

    def walkable(self, name: str, cell: Cell) -> bool:
        x, y, z = cell
        blocks = self.blocks(name)
        floor = blocks.get((x, y - 1, z))
        free = all(blocks.get((x, y + up, z)) in (None, "air") for up in (0, 1))
        return floor not in (None, "air") and free and cell in blocks

    def cells(self) -> list[Cell]:
        if not self._cells:
            self._cells = [
                place
                for place in self.moments[0].blocks
                if place[1] == 1 and any(self.walkable(a, place) for a in self.question.doubt)
            ]
        return self._cells

    def agrees(self, name: str, now: Moment) -> bool:
        """Return True if the node holds nothing that the alternative contradicts."""
        edits = self.question.doubt[name]
        for place, block in edits.get("blocks", {}).items():
            if now.blocks[place] not in (None, block):
                return False
        for place, items in edits.get("containers", {}).items():
            if place in now.contents:
                known, complete = now.contents[place]
                if complete and dict(known) != dict(items):
                    return False
                if any(items.get(item, 0) < count for item, count in known):
                    return False
        for other, feet in edits.get("agents", {}).items():
            if other in now.agents and cell_of(now.agents[other][0]) != cell_of(feet):
                return False
        return True

    # Percepts, from nests of their own.

    def _scene(self, name: str, now: Moment, feet: tuple[float, float, float]) -> bn.ScriptedWorld:
        blocks = {p: b for p, b in self.blocks(name).items() if b not in (None, "air")}
        agents = {who: where for who, (where, _) in now.agents.items()}
        agents |= dict(self.question.doubt[name].get("agents", {}))
        agents[self.question.agent] = feet
        containers = {
            p: i
            for p, i in self.contents(name).items()
            if (blocks.get(p) or "").startswith("chest")
        }
        low, high = now.box.low, now.box.high
        return bn.ScriptedWorld(
            box=(tuple(low), tuple(high)),
            blocks={p: b for p, b in blocks.items() if p not in containers},
            agents=agents,
            containers=containers,
        )

    def percept(self, name: str, cell: Cell) -> Any:
        """All that the agent sees from the centre of a cell in one alternative."""
        now = self.moments[0]
        key = (name, cell)
        if key not in self._percepts:
            world = self._scene(name, now, centre(cell))
            known = self.blocks(name)
            with bn.Nest(world, perception=self.perception) as nest:
                state = nest["/" + self.question.agent].state
                self._percepts[key] = (
                    frozenset(
                        (place, state.blocks[place])
                        for place in state.blocks
                        if state.blocks.current(place) and known[place] is not None
                    ),
                    frozenset(
                        (place, tuple(sorted(content.items.items())))
                        for place, content in state.containers.items()
                        if content.current and content.complete
                    ),
                    frozenset(
                        (who, cell_of(other.position))
                        for who, other in state.agents.items()
                        if other.current and who != self.question.agent
                    ),
                )
        return self._percepts[key]

    def refined(self, known: Knowledge, actual: str, cell: Cell) -> Knowledge:
        truth = self.percept(actual, cell)
        return frozenset(b for b in known if self.percept(b, cell) == truth)

    def looked_in(self, known: Knowledge, actual: str, place: Cell) -> Knowledge:
        truth = self.contents(actual)[place]
        return frozenset(b for b in known if self.contents(b)[place] == truth)

    def sees(self, name: str, cell: Cell) -> bool:
        """Return True if the observer would see the agent in the centre of the cell."""
        if self.owner is None:
            return True
        now = self.moments[0]
        key = ("sees", name, cell)
        if key not in self._percepts:
            world = self._scene(name, now, centre(cell))
            with bn.Nest(world, perception=self.perception) as nest:
                self._percepts[key] = (
                    nest["/" + self.owner].state.agents[self.question.agent].current
                )
        return bool(self._percepts[key])

    def present(self, at: int) -> bool:
        return self.owner is None or self.moments[at].agents[self.owner][1]

    # Planning.

    def there(self, goal: str, name: str, cell: Cell) -> bool:
        """Return True if the goal can be acted on from the cell in one alternative."""
        asked = self.question.goals[goal]
        if "at" in asked:
            return tuple(asked["at"]) == cell
        if "block" in asked:
            return self.blocks(name).get((cell[0], cell[1] - 1, cell[2])) == asked["block"]
        return any(
            items.get(asked["item"], 0) > 0 and self.in_reach(place, cell)
            for place, items in self.contents(name).items()
        )

    def in_reach(self, place: Cell, cell: Cell) -> bool:
        """Return True for the own cell and its neighbours: 4, or 8 with diagonal steps."""
        across = abs(place[0] - cell[0]), abs(place[2] - cell[2])
        return max(across) <= 1 if self.question.diagonal else sum(across) <= 1

    def has_reachable_goal(self) -> bool:
        """Return True if the agent can walk to a goal in at least one alternative."""
        start = cell_of(self.moments[self.course[0]].agents[self.question.agent][0])
        for name in self.question.doubt:
            reached, edge = {start}, [start]
            while edge:
                cell = edge.pop()
                for way in STRAIGHT + (CORNERS if self.question.diagonal else []):
                    to = self.target(name, cell, way)
                    if to not in reached:
                        reached.add(to)
                        edge.append(to)
            if any(
                self.there(goal, name, cell) for goal in self.question.goals for cell in reached
            ):
                return True
        return False

    def target(self, name: str, cell: Cell, way: tuple[int, int]) -> Cell:
        x, y, z = cell
        to = (x + way[0], y, z + way[1])
        free = self.walkable(name, to)
        if way in CORNERS:
            free = free and self.walkable(name, (x + way[0], y, z))
            free = free and self.walkable(name, (x, y, z + way[1]))
        return to if free else cell

    def actions(self, cell: Cell, known: Knowledge) -> list[tuple[Any, ...]]:
        if (cell, known) not in self._choices:
            self._choices[cell, known] = self._actions(cell, known)
        return self._choices[cell, known]

    def _actions(self, cell: Cell, known: Knowledge) -> list[tuple[Any, ...]]:
        ways = STRAIGHT + (CORNERS if self.question.diagonal else [])
        found: list[tuple[Any, ...]] = [("stay",), *(("step", way) for way in ways)]
        if len(known) > 1:
            for place in sorted({p for b in known for p in self.contents(b)}):
                contents = {tuple(sorted(self.contents(b).get(place, {}).items())) for b in known}
                if self.in_reach(place, cell) and len(contents) > 1:
                    found.append(("open", place))
        found += [
            ("act", goal)
            for goal in self.question.goals
            if all(self.there(goal, b, cell) for b in known)
        ]
        return found

    def after(self, action: tuple[Any, ...], name: str, mind: Mind) -> Mind:
        """Return what an action makes of a mind in one alternative."""
        if mind[2]:
            return mind
        key = (action, name, mind)
        if key not in self._moves:
            self._moves[key] = self._after(action, name, mind)
        return self._moves[key]

    def _after(self, action: tuple[Any, ...], name: str, mind: Mind) -> Mind:
        cell, known, _ = mind
        if action[0] == "act":
            return cell, known, True
        if action[0] == "step":
            cell = self.target(name, cell, action[1])
        if action[0] == "open":
            known = self.looked_in(known, name, action[1])
        return cell, self.refined(known, name, cell), False

    def belief(self, row: Sequence[float], known: Knowledge) -> dict[str, float]:
        weights = {
            name: weight
            for name, weight in zip(self.question.doubt, row, strict=True)
            if name in known
        }
        total = sum(weights.values())
        if total <= 0:
            return {name: 1 / len(weights) for name in weights}
        return {name: weight / total for name, weight in weights.items()}

    def values(self, wants: int, row: int, known: Knowledge) -> dict[Cell, float]:
        """Solve the plan of one set of possible alternatives."""
        key = (wants, row, known)
        if key in self._values:
            return self._values[key]
        solved = dict.fromkeys(self.cells(), 0.0)
        if self.question.stay_cost:
            start = -self.question.stay_cost / (1 - self.question.discount)
            solved = dict.fromkeys(solved, start)
        self._values[key] = solved
        change = 1.0
        while change > 1e-14 * max(1.0, *(abs(value) for value in solved.values())):
            change = 0.0
            for cell in solved:
                best = max(self.scores(wants, row, (cell, known, False)).values())
                change = max(change, abs(best - solved[cell]))
                solved[cell] = best
        return solved

    def scores(self, wants: int, row: int, mind: Mind) -> dict[tuple[Any, ...], float]:
        cell, known, _ = mind
        ask = self.question
        found = {}
        for action in self.actions(cell, known):
            if action[0] == "act":
                found[action] = ask.utilities[wants][action[1]] - ask.act_cost
                continue
            cost = {"stay": ask.stay_cost, "step": ask.step_cost, "open": ask.act_cost}[action[0]]
            expected = 0.0
            for name, weight in self.belief(ask.credences[row], known).items():
                if weight:
                    to, learnt, _ = self.after(action, name, mind)
                    expected += weight * self.values(wants, row, learnt)[to]
            found[action] = -cost + ask.discount * expected
        return found

    def policy(self, wants: int, row: int, mind: Mind) -> dict[tuple[Any, ...], float]:
        if mind[0] not in self.cells():
            return {}  # seen where the node knows no floor: no hypothesis explains that
        scores = self.scores(wants, row, mind)
        top = max(scores.values())
        raised = {
            action: math.exp(self.question.rationality * (score - top))
            for action, score in scores.items()
        }
        total = sum(raised.values())
        return {action: value / total for action, value in raised.items()}

    # The posterior.

    def hypotheses(self) -> Iterator[tuple[int, int, str]]:
        for wants in range(len(self.question.utilities)):
            for row in range(len(self.question.credences)):
                for name in self.question.doubt:
                    yield wants, row, name

    def weights(self, at: int) -> dict[str, float]:
        actual, names = self.question.actual, list(self.question.doubt)
        if actual is None:
            agreeing = [
                name
                for name in names
                if all(self.agrees(name, now) for now in self.moments[: at + 1])
            ]
            return {name: 1 / len(agreeing) if name in agreeing else 0.0 for name in names}
        if actual == "unknown":
            return dict.fromkeys(names, 1 / len(names))
        if isinstance(actual, str):
            return {name: float(name == actual) for name in names}
        return {name: float(actual.get(name, 0)) for name in names}

    def filtered(self, wants: int, row: int, name: str, until: int) -> dict[Mind, float]:
        """Return the weight of each mind after the course up to a moment, not normalised."""
        first = self.course[0]
        agent = self.question.agent
        start = cell_of(self.moments[first].agents[agent][0])
        known = self.refined(frozenset(self.question.doubt), name, start)
        minds: dict[Mind, float] = {(start, known, False): 1.0}
        done = False
        for at in range(first + 1, until + 1):
            if done:
                break
            now = self.moments[at]
            seen = now.agents[agent][1]
            events = [(kind, detail) for kind, who, detail in now.events if who == agent]
            minds, done = self._step(minds, wants, row, name, at, seen, events)
        if self.question.ended and until == len(self.moments) - 1 and not done:
            minds = {
                (cell, known, True): weight * self._acts(wants, row, (cell, known, False))
                for (cell, known, ended), weight in minds.items()
                if not ended
            }
        return minds

    def _acts(self, wants: int, row: int, mind: Mind) -> float:
        return sum(p for action, p in self.policy(wants, row, mind).items() if action[0] == "act")

    def _step(
        self,
        minds: Mapping[Mind, float],
        wants: int,
        row: int,
        name: str,
        at: int,
        seen: bool,
        events: Sequence[tuple[str, Any]],
    ) -> tuple[dict[Mind, float], bool]:
        later: dict[Mind, float] = {}
        done = False
        here = cell_of(self.moments[at].agents[self.question.agent][0]) if seen else None
        opened = [tuple(d["position"]) for kind, d in events if kind == "open_container"]
        taken = [d for kind, d in events if kind == "get_item_from_chest"]
        for mind, weight in minds.items():
            _, _, ended = mind
            policy = {("rest",): 1.0} if ended else self.policy(wants, row, mind)
            for action, p in policy.items():
                to = mind if ended else self.after(action, name, mind)
                visible = action[0] == "open" or (
                    action[0] == "act" and "item" in self.question.goals[action[1]]
                )
                if seen:
                    if to[0] != here:
                        continue
                    if opened and (action[0] != "open" or action[1] != opened[0]):
                        continue
                    if taken and (
                        action[0] != "act"
                        or self.question.goals[action[1]].get("item") not in taken[0]["items"]
                    ):
                        continue
                    if visible and not opened and not taken:
                        continue
                elif self.present(at) and self.sees(name, to[0]):
                    continue
                later[to] = later.get(to, 0.0) + weight * p
        if taken:
            done = True
        return later, done

    def joint(self, until: int) -> dict[tuple[int, int, str], float]:
        """Return the weight of each hypothesis: prior times likelihood."""
        weights = self.weights(until)
        each = 1 / (len(self.question.utilities) * len(self.question.credences))
        return {
            (wants, row, name): each
            * weights[name]
            * (sum(self.filtered(wants, row, name, until).values()) if weights[name] else 0.0)
            for wants, row, name in self.hypotheses()
        }

    def evidence(self, until: int) -> float:
        return sum(self.joint(until).values())

    def means(self, until: int) -> dict[str, float]:
        """Return the posterior means of all factors."""
        joint = self.joint(until)
        total = sum(joint.values())
        found: dict[str, float] = {}
        for (wants, row, name), weight in joint.items():
            share = weight / total
            for goal, value in self.question.utilities[wants].items():
                key = f"utility.{goal}"
                found[key] = found.get(key, 0.0) + share * value
            for other, value in zip(self.question.doubt, self.question.credences[row], strict=True):
                key = f"credence.{other}"
                found[key] = found.get(key, 0.0) + share * value
            found[f"actual.{name}"] = found.get(f"actual.{name}", 0.0) + share
            if weight:
                minds = self.filtered(wants, row, name, until)
                for (_, known, _), chance in minds.items():
                    now = self.belief(self.question.credences[row], known)
                    for other in self.question.doubt:
                        key = f"credence_now.{other}"
                        part = weight / total * chance / sum(minds.values()) * now.get(other, 0.0)
                        found[key] = found.get(key, 0.0) + part
        return found

    def prediction(self, until: int, steps: int) -> list[dict[Cell, float]]:
        """Return where the agent is after each of the next actions."""
        weights = self.weights(until)
        total = self.evidence(until)
        found: list[dict[Cell, float]] = [{} for _ in range(steps)]
        each = 1 / (len(self.question.utilities) * len(self.question.credences))
        for wants, row, name in self.hypotheses():
            if not weights[name]:
                continue
            minds = self.filtered(wants, row, name, until)
            for step in range(steps):
                later: dict[Mind, float] = {}
                for mind, weight in minds.items():
                    policy = {("rest",): 1.0} if mind[2] else self.policy(wants, row, mind)
                    for action, p in policy.items():
                        to = mind if mind[2] else self.after(action, name, mind)
                        later[to] = later.get(to, 0.0) + weight * p
                minds = later
                for (cell, _, _), weight in minds.items():
                    part = each * weights[name] * weight / total
                    found[step][cell] = found[step].get(cell, 0.0) + part
        return found


def cell_of(feet: Sequence[float]) -> Cell:
    x, y, z = (math.floor(value) for value in feet)
    return x, y, z


def centre(cell: Cell) -> tuple[float, float, float]:
    return cell[0] + 0.5, float(cell[1]), cell[2] + 0.5
