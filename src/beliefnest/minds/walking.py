"""Courses of a modelled agent, sampled action by action from the planner's policy."""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from random import Random

import msgspec
import numpy as np

from beliefnest.minds.alternatives import AgentPose, AlternativeWorld, AlternativeWorlds
from beliefnest.minds.hypotheses import Hypotheses, conditioned
from beliefnest.minds.mind_model import MindModel
from beliefnest.minds.planner import Knowledge
from beliefnest.minds.stage import Stage
from beliefnest.minds.surroundings import Surroundings
from beliefnest.perception.sight import Sight
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Items, Position


class Draw(msgspec.Struct, frozen=True):
    """Drawn hypothesis, as indices.

    Attributes:
        rationality: Number of the rationality.
        utility: Row of the utilities.
        credence: Row of the initial credences.
        actual: Number of the actual alternative.
    """

    rationality: int
    utility: int
    credence: int
    actual: int


class WalkChanges(msgspec.Struct, frozen=True):
    """Changes in a history since its start.

    Attributes:
        blocks: Indices of cells with the new block states.
        moved: Container, item, and the change of the item's count since then.
    """

    blocks: tuple[tuple[tuple[int, int, int], int], ...] = ()
    moved: tuple[tuple[Position, str, int], ...] = ()


class WalkStep(msgspec.Struct, frozen=True):
    """Step into a cell. Into its own cell: the agent stays or is blocked."""

    cell: Position


class Open(msgspec.Struct, frozen=True):
    """A look into a container."""

    place: Position


class WalkAct(msgspec.Struct, frozen=True):
    """Act on a goal, which ends the course, and the item that it takes, if any."""

    item: str | None


class Strategy:
    """Policy of a model's agent, for all hypotheses and all changes of its world.

    Args:
        model: The hypotheses.
        scene: All alternatives at the start of the histories.
        agrees: The alternatives that agree with the observer's node, as a set of bits.
        step_ticks: Ticks that an action takes.
        sight: Rules of sight.
        transparent: True if agents that see a container perceive its contents.
    """

    def __init__(
        self,
        model: MindModel,
        scene: Surroundings,
        agrees: int,
        step_ticks: int,
        sight: Sight,
        *,
        transparent: bool,
    ) -> None:
        self.model, self.step_ticks = model, step_ticks
        self._scene, self._sight, self._transparent = scene, sight, transparent
        self._hypotheses = Hypotheses.of(model, step_ticks)
        weights = model.actual_weights
        self._actual = [
            float(agrees >> a & 1) if weights is None else weights[name]
            for a, name in enumerate(model.alternative_names)
        ]
        self._prior = np.cumsum(model.prior_weights.reshape(-1))
        self._scenes: dict[WalkChanges, Surroundings] = {WalkChanges(): scene}
        self._sums: dict[tuple[Stage, Position, Knowledge, int, int, int], list[float]] = {}
        self._looks: dict[tuple[int, AgentPose], list[int]] = {}

    def draw_actual(self, chance: Random) -> int:
        """Draw the number of the actual alternative."""
        return chance.choices(range(len(self._actual)), self._actual)[0]

    def draw(self, chance: Random, actual: int) -> Draw:
        """Draw a hypothesis from the prior."""
        _, credences = self.model.prior_weights.shape
        number = int(np.searchsorted(self._prior, chance.random() * self._prior[-1], "right"))
        number = min(number, len(self._prior) - 1)
        rationality = chance.randrange(len(self.model.rationalities))
        return Draw(rationality, number // credences, number % credences, actual)

    def scene(self, changes: WalkChanges) -> Surroundings:
        """Return all alternatives, with what has changed in a history since it began."""
        scene = self._scenes.get(changes)
        if scene is None:
            scene = self._scenes[changes] = self._changed(changes)
        return scene

    def sums(self, stage: Stage, cell: Position, knowledge: Knowledge, draw: Draw) -> list[float]:
        """Return the cumulative probabilities of all actions."""
        key = (stage, cell, knowledge, draw.rationality, draw.utility, draw.credence)
        cumulated = self._sums.get(key)
        if cumulated is None:
            policy = self._hypotheses.log_policy(stage, cell, knowledge)
            credence = draw.credence if policy.shape[3] > 1 else 0
            column = policy[:, draw.rationality, draw.utility, credence]
            cumulated = self._sums[key] = np.cumsum(np.exp(column)).tolist()
        return cumulated

    def alike(self, scene: Surroundings, pose: AgentPose, actual: int) -> int:
        """Return the alternatives with the same percept from a pose as the actual one."""
        if self._sight.field_of_view >= 360:
            pose = (pose[0], 0.0, 0.0)
        key = (id(scene), pose)
        likenesses = self._looks.get(key)
        if likenesses is None:
            likenesses = self._looks[key] = scene.worlds.alike(*pose, all_round=False)
        return likenesses[actual]

    def told(self, draw: Draw) -> dict[str, float | str]:
        """Return a hypothesis by the names of its factors."""
        model = self.model
        report: dict[str, float | str] = {
            f"utility.{goal}": float(model.utility_rows[draw.utility, n])
            for n, goal in enumerate(model.goals)
        }
        if model.doubt is not None:
            row = model.credence_rows[draw.credence]
            report |= {
                f"credence.{name}": float(row[n]) for n, name in enumerate(model.alternative_names)
            }
            report["actual"] = model.alternative_names[draw.actual]
        if len(model.rationalities) > 1:
            report["rationality"] = model.rationalities[draw.rationality]
        return report

    def _changed(self, changes: WalkChanges) -> Surroundings:
        before = self._scene.worlds
        made: dict[int, Terrain] = {}
        worlds = []
        for world in before.worlds:
            if id(world.blocks) not in made:
                draft = world.blocks.draft()
                for index, state in changes.blocks:
                    draft[index] = state
                made[id(world.blocks)] = draft.terrain()
            contents = {place: dict(items) for place, items in world.contents.items()}
            for place, item, count in changes.moved:
                content = contents.setdefault(place, {})
                content[item] = max(0, content.get(item, 0) + count)
            kept = {place: _without_nothing(items) for place, items in contents.items()}
            worlds.append(AlternativeWorld(made[id(world.blocks)], kept, world.agents))
        changed = AlternativeWorlds(
            self._sight,
            before.box,
            worlds,
            before.items,
            self.model.agent,
            transparent=self._transparent,
        )
        return self._scene.with_worlds(changed, repr(changes).encode())


class Walker:
    """An agent under way, whose course is sampled from the planner's policy.

    Args:
        strategy: How it chooses.
        draw: Its hypothesis.
        pose: Where it begins.
        cell: The cell it begins in.
    """

    def __init__(self, strategy: Strategy, draw: Draw, pose: AgentPose, cell: Position) -> None:
        self.strategy, self.draw, self.cell = strategy, draw, cell
        self.is_over = False
        everyone = (1 << len(strategy.model.alternatives)) - 1
        self._scene = strategy.scene(WalkChanges())
        self._knowledge: Knowledge = (everyone, everyone)
        self._perceive(pose)

    @property
    def name(self) -> str:
        """The agent."""
        return self.strategy.model.agent

    def again(self) -> "Walker":
        """Return the same once more, to go another way."""
        other = Walker.__new__(Walker)
        other.__dict__.update(self.__dict__)
        return other

    def choose(self, chance: Random, changes: WalkChanges) -> WalkStep | Open | WalkAct:
        """Choose the next action in the world as it is now."""
        self._scene = self.strategy.scene(changes)
        stage = self._scene.stage(self.cell)
        sums = self.strategy.sums(stage, self.cell, self._knowledge, self.draw)
        action = min(bisect_right(sums, chance.random() * sums[-1]), len(sums) - 1)
        steps = stage.moves.shape[2]
        if action <= steps:
            if action == 0:
                return WalkStep(self.cell)
            number = stage.index[self.cell]
            return WalkStep(stage.cells[int(stage.moves[self.draw.actual, number, action - 1])])
        if action <= steps + len(stage.boxes):
            box = action - 1 - steps
            self._learn(int(stage.content[box, self.draw.actual]))
            return Open(stage.boxes[box])
        self.is_over = True
        goal = list(self.strategy.model.goal_values.values())[action - 1 - steps - len(stage.boxes)]
        return WalkAct(goal.item)

    def in_reach(self, places: Sequence[Position]) -> list[Position]:
        """Return those of some places that it reaches."""
        return self._scene.in_reach(self.draw.actual, self.cell, places)

    def arrive(self, pose: AgentPose, cell: Position) -> None:
        """Be in a cell, and perceive from there."""
        self.cell = cell
        self._perceive(pose)

    def _perceive(self, pose: AgentPose) -> None:
        self._learn(self.strategy.alike(self._scene, pose, self.draw.actual))

    def _learn(self, mask: int) -> None:
        if self._knowledge[0] & mask != self._knowledge[0]:
            self._knowledge = conditioned(self._knowledge, mask)


def _without_nothing(items: Mapping[str, int]) -> Items:
    return {name: count for name, count in items.items() if count > 0}
