"""Scenario as a multi-agent environment with PettingZoo's parallel interface."""

import hashlib
import math
import sys
import warnings
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from msgspec.structs import replace
from pettingzoo import ParallelEnv

from beliefnest.belief.plain import belief_json
from beliefnest.belief.view import State
from beliefnest.env.acting import Acting, ActionState, ProgramActing, SkillActing
from beliefnest.env.actions import Calls, NamedAction, NotKnownError
from beliefnest.env.bounds import SpaceBounds
from beliefnest.env.flat import ActorMind, FlatActions, checked_cells
from beliefnest.env.layout import layout_of
from beliefnest.env.options import (
    RENDER_MODES,
    EnvironmentOptions,
    env_seed,
    nested_paths,
)
from beliefnest.env.order import KnownOrder, Things
from beliefnest.env.playing import Instances, TaskActing
from beliefnest.env.rendering import line, picture
from beliefnest.env.room import check_arrays, check_nested
from beliefnest.env.saving import Choice, SavedEpisode, check_no_options
from beliefnest.env.spaces import (
    BeliefSpace,
    call_space,
    observation_space,
    program_space,
    space_of,
)
from beliefnest.episodes.agent_view import AgentView, Brief
from beliefnest.episodes.policies.candidates import cells_of, items_of
from beliefnest.episodes.task import Task
from beliefnest.errors import InputError, PathError, UnknownNameError
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.past.history import context_of
from beliefnest.nest.past.setting_codec import encode_start
from beliefnest.owned import Owned
from beliefnest.scenarios.scenario import Scenario
from beliefnest.skills.calls import Call
from beliefnest.timeline.journal import FOLLOW, TimelineInfo
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.values import Position
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.scripted.footpaths import InReach, Near
from beliefnest.worlds.scripted.ground_cache import Grounds
from beliefnest.worlds.scripted.hand import REACH

_MAX_STEPS = 100
_TIMEOUT_TICKS = 1200
_TRIED = 8
"""Number of instances whose things are counted for the sizes of arrays."""
_OF_WORLD = frozenset(
    (
        *("_own", "_worlds", "_nest", "_acting", "_grounds"),
        *("_played", "_by_hand", "_left", "_heard", "_orders", "_cells"),
    )
)
"""Attributes of an environment that belong to its open world."""

Infos = dict[str, Any]
"""Info dictionary of one agent."""


class BeliefEnv(ParallelEnv[str, Any, Any]):  # type: ignore[misc]  # it has no type information
    """A scenario or task in which agents act and get their own beliefs as observations.

    Create one with `beliefnest.env.parallel_env`, which explains the arguments.

    Attributes:
        possible_agents: Agents that can act, sorted.
        agents: Agents that still act in this episode.
        layout: All things of this episode; `known` gives those that an agent numbers.
        skills: Names of the skills; an action's `skill` is an index into them.
        nest: Nest of this episode, for any further query.
    """

    metadata = {  # noqa: RUF012 - as PettingZoo declares it
        "name": "beliefnest_v0",
        "render_modes": list(RENDER_MODES),
        "render_fps": 4,
        "is_parallelizable": True,
    }

    def __init__(self, source: Scenario | Instances, options: EnvironmentOptions) -> None:
        self._source, self._options = source, options
        self._origins: dict[int, str] = {}
        self._task: Task | None = None
        players: Sequence[str] = ()
        if isinstance(source, Instances):
            options.check_task()
            self._drawn = options.seed
            task = self._task = source.of(options.seed)
            scenario, players = task.scenario, task.players
        else:
            options.check_scenario()
            scenario = source
        self._named = scenario.name
        self._arrange(scenario)
        tried = [] if isinstance(source, Scenario) else [source.of(seed) for seed in range(_TRIED)]
        said, items = options.said, options.items
        others = [layout_of(each.scenario.setting, said, items) for each in tried]
        layouts = [self.layout, *others]
        self._given = checked_cells(options.cells, self.layout.box)
        self._bounds = SpaceBounds.of(layouts, options.sizes)
        self._bounds.check(self.layout)
        self._calls = Calls(self._bounds, options.said)
        self.skills = self._calls.skills
        self.possible_agents = sorted(options.agents or players or self.layout.agents)
        for name in self.possible_agents:
            if name not in scenario.setting.snapshot.agents:
                there = ", ".join(sorted(scenario.setting.snapshot.agents))
                raise PathError(f"no agent {name!r} at the start; agents are {there}")
        context = context_of(scenario.setting)
        if isinstance(options.nested, int):
            check_nested(context, self.possible_agents, options.nested)
        self._speaks = any(map(self._may_speak, self.possible_agents))
        cells = (
            self._cells_of(each, a) for each in (self._task, *tried) for a in self.possible_agents
        )
        self._most = {**self._bounds.most, "cells": max(map(len, cells))}
        self._nested = nested_paths(options.nested, self.possible_agents, self.layout.agents)
        own = ((agent,) for agent in self.possible_agents)
        self._reads = [path_text(path) for path in (*own, *self._nested)]
        self._nested_of = {
            agent: tuple(path for path in self._nested if path[0] == agent)
            for agent in self.possible_agents
        }
        rows = max(map(len, self._nested_of.values()))
        depth = max((len(path) - 1 for path in self._nested), default=0)
        self._bounds = replace(self._bounds, nested=(rows, depth))
        self.render_mode = options.render_mode
        self._render_path = path_text(parse_path(options.render_path, self.layout.agents))
        if options.observations == "arrays":
            check_arrays(context, self._bounds, len(self.possible_agents), len(self._nested))
        self.agents: list[str] = []
        self._seed = options.seed - 1
        self._spaces = {each: self._new_spaces() for each in self.possible_agents}
        self._forget()

    @cached_property
    def _flat(self) -> FlatActions:
        return FlatActions(self._calls, self._most, speaks=self._speaks)

    def _forget(self) -> None:
        """Begin a life without a world."""
        self._own = Owned()
        self._worlds: Worlds | None = None
        self._nest: Nest | None = None
        self._acting: Acting | None = None
        self._played: list[Mapping[str, Choice]] = []
        self._by_hand = False
        self._left: TimelineInfo | None = None
        self._heard: dict[str, int] = {}
        self._orders: dict[str, KnownOrder] = {}
        self._cells: dict[str, tuple[Position, ...]] = {}
        self._grounds = Grounds()

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy has: everything but the world, and the episode as it was saved."""
        kept = {name: each for name, each in self.__dict__.items() if name not in _OF_WORLD}
        return {**kept, "saved": None if self._nest is None else self.save()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        saved = state.pop("saved")
        self.__dict__.update(state)
        self._forget()
        if saved is not None:
            self.restore(saved)

    def _arrange(self, scenario: Scenario) -> None:
        """Set what there is in an instance."""
        self.layout = layout_of(scenario.setting, self._options.said, self._options.items)

    def _cells_of(self, task: Task | None, agent: str) -> tuple[Position, ...]:
        """Return the cells that an agent knows by the rules: those given, and those of goals."""
        of_goals: set[Position] = set()
        if task is not None:
            brief = Brief.of(task, self._options.seed, agent)
            of_goals = cells_of(brief.considered, brief.agents)
        return tuple(sorted({*self._given, *of_goals}))

    def known(self, agent: str) -> Things:
        """Return the things that an agent has come to know in this episode, in its order.

        Numbers in its observations and actions, and in its nested beliefs, are indices into them.

        Raises:
            InputError: No episode has begun, or the agent cannot act.
        """
        self._check_actor(agent)
        if agent not in self._orders:
            raise InputError("no episode has begun; call reset() first")
        return self._orders[agent].things

    @property
    def nest(self) -> Nest:
        """Nest of this episode.

        Raises:
            InputError: No episode has begun.
        """
        if self._nest is None:
            raise InputError("no episode has begun; call reset() first")
        return self._nest

    def view(self, agent: str) -> AgentView:
        """Return what a policy of `beliefnest play` gets for the next round of a task.

        A policy that reads it can be trained here and then be played by its name.

        Raises:
            InputError: No episode has begun, the agent does not act now, or this is no task.
        """
        if not isinstance(self._acting, TaskActing):
            reason = "call reset() first" if self._acting is None else "only tasks have rounds"
            raise InputError(f"there is no view of {agent!r}: {reason}")
        if agent not in self.agents:
            raise InputError(f"{agent!r} does not act now; agents are {self.agents}")
        return self._acting.view(agent)

    @property
    def first_seed(self) -> int:
        """Seed of the first episode, if `reset` gets none."""
        return self._options.seed

    @property
    def unwrapped(self) -> "BeliefEnv":
        """The environment itself."""
        return self

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Return the space of an agent's observations; the same object on each call."""
        self._check_actor(agent)
        return self._spaces[agent][0]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Return the space of an agent's actions; the same object on each call."""
        self._check_actor(agent)
        return self._spaces[agent][1]

    def _check_actor(self, agent: str) -> None:
        if agent not in self.possible_agents:
            raise InputError(f"{agent!r} does not act here; agents are {self.possible_agents}")

    @property
    def state_space(self) -> spaces.Space[Any]:
        """Space of `state`: numbers in one row, or plain data as observations are."""
        if self._options.observations == "dict":
            return BeliefSpace()
        return spaces.flatten_space(space_of(self._bounds.own_shapes()))

    def _new_spaces(self) -> tuple[spaces.Space[Any], spaces.Space[Any]]:
        """Return new spaces of an agent's observations and actions."""
        options, offers = self._options, None
        acts: spaces.Space[Any] = call_space(self._calls, self._bounds)
        if options.actions == "programs":
            acts = program_space()
        elif options.actions == "flat":
            offers = len(self._flat.offers)
            acts = spaces.Discrete(offers)
        if options.observations == "dict":
            return BeliefSpace(), acts
        return observation_space(self._bounds, offers), acts

    def action(self, skill: str, /, *, of: str | None = None, **parts: object) -> dict[str, Any]:
        """Return an action of the structured space from names and positions.

        `step` reads the names, so that any agent can be given the action. The numbers in it are
        those of one agent.

        Args:
            skill: Name of a skill.
            of: Agent whose numbers are used; None: the first one that knows the things.
            parts: Its arguments: `position`, `container`, `door` and `sign` as block positions;
                `item`, `agent` and `phrase` as names or texts; `count`.

        Raises:
            UnknownNameError: There is no such skill, or no agent knows such a thing.
            InputError: A part is missing, invalid or not used by the skill.
        """
        if of is not None:
            return self._calls.action(self.known(of), skill, parts)
        fault: UnknownNameError | None = None
        for agent in self.possible_agents:
            try:
                return self._calls.action(self.known(agent), skill, parts)
            except UnknownNameError as unknown:
                fault = fault or unknown
        assert fault is not None  # there is at least one agent
        raise fault

    def reset(
        self, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Infos]]:
        """Begin an episode.

        Args:
            seed: Seed of every random number; None for the last seed plus one.
            options: There are none. An option of the name `options`, which PettingZoo's own tests
                give, means nothing.

        Raises:
            InputError: The seed is not a whole number of 64 bits, or an option is given; the
                current episode continues.
            ForkedError: The world was opened by another process.
            BodyError: The world could not be started.
            ProgramError: The script cannot be played.
        """
        if self._worlds is not None:
            self._own.check_own("the environment")
        check_no_options(options)
        self._seed = self._seed + 1 if seed is None else env_seed(seed)
        self._end_episode()
        if self._worlds is None:
            self._worlds = Worlds(0)
        self._acting = self._begun(self._worlds)
        self.agents = list(self.possible_agents)
        self._played, self._by_hand = [], False
        self._heard = {}
        self._orders = {
            agent: KnownOrder(Things(items=tuple(self._declared(agent)))) for agent in self.agents
        }
        self._cells = {agent: self._cells_of(self._task, agent) for agent in self.agents}
        first = self._told({agent: ActionState() for agent in self.agents}, spoken=True)
        self._left = self._reality()
        if self.render_mode == "human":
            self.render()
        return first

    def calls(self, agent: str) -> tuple[Call | None, ...]:
        """Return what each number of the space `flat` stands for now; None: nothing known.

        Raises:
            InputError: No episode has begun, or the agent cannot act.
        """
        mind = self._mind(agent)
        calls: list[Call | None] = []
        for number in range(len(self._flat.offers)):
            try:
                calls.append(self._flat.call(number, mind))
            except NotKnownError:
                calls.append(None)
        return tuple(calls)

    def action_masks(self, agent: str | None = None) -> npt.NDArray[np.int8]:
        """Return 1 for each action of the space `flat` that can begin as far as its agent knows.

        Args:
            agent: Name of the agent; None: a row for each of `possible_agents`.

        Raises:
            InputError: No episode has begun, or the agent cannot act.
        """
        if agent is None:
            return np.stack([self.action_masks(each) for each in self.possible_agents])
        return self._flat.mask(self._mind(agent))

    def _mind(self, agent: str, state: State | None = None) -> ActorMind:
        """Return what an agent knows about what it can do; `state` is its belief, if at hand."""
        things, state = self.known(agent), state or self.nest[path_text((agent,))].state
        ground = self._grounds.of(state.box, state.blocks.terrain).with_doors_opened
        feet = state.agents[agent].position

        def may_reach(place: Position, near: float | None) -> bool:
            goal = InReach(place, REACH) if near is None else Near(place, near)
            return feet is not None and ground.may_lead(ground.cell_of(feet), goal)

        speaks = self._may_speak(agent)
        places, cells = self.layout.places, self._cells[agent]
        return ActorMind(agent, state, things, places, cells, speaks, may_reach)

    def _may_speak(self, agent: str) -> bool:
        return self._task is None or agent in self._task.form.speakers

    def save(self) -> SavedEpisode:
        """Return the episode up to now, for `restore` of this environment or of a copy.

        It holds what the agents chose, not the world: it is small and can be pickled.

        Raises:
            InputError: No episode has begun, or its world was changed by hand.
        """
        self._check_timelines()
        if self._by_hand or self._reality() != self._left:
            raise InputError(
                "the world was changed by hand, which no saved episode can repeat: save before, or "
                "let agents act in place of it"
            )
        return SavedEpisode(
            self._named, self._origin(self._task, self._seed), self._seed, tuple(self._played)
        )

    def restore(self, saved: SavedEpisode) -> tuple[dict[str, Any], dict[str, Infos]]:
        """Play a saved episode again up to where it was saved; return what agents were told then.

        Raises:
            InputError: The episode is not one of this environment; the current one continues.
            BodyError: The Minecraft side failed.
        """
        if not isinstance(saved, SavedEpisode) or saved.scenario != self._named:
            name = saved.scenario if isinstance(saved, SavedEpisode) else type(saved).__name__
            raise InputError(
                f"{name!r} is not an episode of {self._named}; give what save() returned"
            )
        task = self._instance(saved.seed)
        if saved.origin != self._origin(task, saved.seed):
            raise InputError(
                f"the saved episode of {self._named} began in another way: its agents, its world, "
                "its parameters, the lengths of its steps or its file differ; restore it in an "
                "environment that is made as the one that saved it"
            )
        self._task, self._drawn = task, saved.seed
        latest = self.reset(saved.seed)
        for chosen in saved.steps:
            latest = self._play(chosen)
        if saved.steps and any(self._ends()):
            self.agents = []
        return latest

    def _reality(self) -> TimelineInfo:
        """Return how long the timeline of the real world is."""
        reality = self.nest["/"]
        return next(each for each in reality.branches() if each.key.branch == reality.branch)

    def _check_timelines(self) -> None:
        """Raise InputError if somebody has switched a simulator that the episode uses."""
        reality = "" if self._left is None else self._left.key.branch
        beliefs = [*((agent,) for agent in self.possible_agents), *self._nested]
        for path in ((), *beliefs):
            text, home = path_text(path), FOLLOW if path else reality
            branch = self.nest[text].branch
            if branch != home:
                raise InputError(
                    f"{text} was switched to the branch {branch!r}; the episode is on {home!r}: "
                    f"env.nest[{text!r}].switch({home!r}) returns to it"
                )

    def _begun(self, worlds: Worlds) -> Acting:
        """Open the nest of an episode; return the executor of its actions."""
        chosen, source = self._options, self._source
        if isinstance(source, Instances):
            task = self._instance(self._seed)
            assert task is not None  # a scenario has none
            self._task, self._drawn = task, self._seed
            self._arrange(task.scenario)
            self._bounds.check(self.layout)
            learners = self.possible_agents
            playing = TaskActing(task, learners, chosen.world, self._seed, worlds, self._reads)
            self._nest = playing.nest
            return playing
        nest = self._nest = Nest.open(source, chosen.world, None, self._seed, worlds)
        if chosen.plays_script:
            nest.play()
        senses, timeout = chosen.senses or "world", chosen.timeout_ticks or _TIMEOUT_TICKS
        if chosen.actions != "programs" and chosen.world == "scripted":
            speech = source.setting.perception.speech_ticks
            return SkillActing(nest, chosen.step_ticks, timeout, senses, speech)
        return ProgramActing(nest, timeout, senses)

    def _instance(self, seed: int) -> Task | None:
        """Return the instance of a seed, the latest one without reading it; None: no task."""
        source = self._source
        if isinstance(source, Scenario) or self._drawn == seed:
            return self._task
        return source.of(seed)

    def _origin(self, task: Task | None, seed: int) -> str:
        """Return a digest of what the episode of a seed begins from."""
        if seed not in self._origins:
            self._origins = {seed: self._new_origin(task)}
        return self._origins[seed]

    def _new_origin(self, task: Task | None) -> str:
        options, source = self._options, self._source if task is None else task.scenario
        assert isinstance(source, Scenario)  # instances have a task
        setting = source.setting
        lengths = (options.step_ticks, options.max_steps, options.timeout_ticks)
        chosen = [self.possible_agents, *lengths, options.plays_script, options.senses]
        # Copies of a form are equal and have the same text, but other JSON: a default is left out.
        rules = repr([*chosen, None if task is None else task.form]).encode()
        return hashlib.sha256(encode_start(setting, options.world) + rules).hexdigest()

    def _declared(self, agent: str) -> Sequence[str]:
        """Return the items that an agent knows by the rules: those named, and those of goals."""
        named = set(self._options.items)
        if self._task is not None:
            named.update(items_of(Brief.of(self._task, self._seed, agent).considered))
        return sorted(named)

    def step(
        self, actions: Mapping[str, Any]
    ) -> tuple[
        dict[str, Any], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Infos]
    ]:
        """Let agents act together; agents without an action begin nothing.

        Raises:
            InputError: An action is not in the space, or its agent does not act; nothing was
                done.
            BodyError: The Minecraft side failed.
        """
        if self._acting is None:
            raise InputError("no episode has begun; call reset() first")
        if not isinstance(actions, Mapping):
            raise InputError(
                f"actions are {type(actions).__name__}; give a dict of agents' names and actions"
            )
        for agent in actions:
            if agent not in self.agents:
                raise InputError(f"{agent!r} does not act now; agents are {self.agents}")
        if not self.agents:
            return {}, {}, {}, {}, {}
        self._check_timelines()
        chosen = {agent: self._chosen(agent, actions) for agent in self.agents}
        self._by_hand |= self._reality() != self._left
        observations, infos = self._play(chosen)
        rewards = {agent: self._reward(agent) for agent in self.agents}
        ended, cut = self._ends()
        terminations = dict.fromkeys(self.agents, ended)
        truncations = dict.fromkeys(self.agents, cut)
        if ended or cut:
            self.agents = []
        if self.render_mode == "human":
            self.render()
        return observations, rewards, terminations, truncations, infos

    def check_action(self, agent: str, action: Any) -> None:
        """Raise InputError if an agent does not act now, or an action is not in its space."""
        if agent not in self.agents:
            raise InputError(f"{agent!r} does not act now; agents are {self.agents}")
        self._chosen(agent, {agent: action})

    def _chosen(self, agent: str, actions: Mapping[str, Any]) -> Choice:
        """Return what an agent begins; nothing if it has no action, or one of nothing known."""
        nothing = "" if self._options.actions == "programs" else Call("doNothing")
        try:
            return Choice(self._read(agent, actions[agent]) if agent in actions else nothing)
        except NotKnownError as error:
            return Choice(nothing, str(error))

    def _play(self, chosen: Mapping[str, Choice]) -> tuple[dict[str, Any], dict[str, Infos]]:
        """Let agents begin what was chosen; return the observations and infos of all agents."""
        assert self._acting is not None  # its callers have begun an episode
        step = self._acting.act({agent: each.action for agent, each in chosen.items()})
        self._played.append(chosen)
        deeds = {
            agent: replace(deed, error=chosen[agent].fault or deed.error)
            for agent, deed in step.deeds.items()
        }
        observations, infos = self._told(deeds, spoken=step.spoken)
        if isinstance(self._acting, TaskActing):
            for info in infos.values():
                info["success"] = self._acting.success
        self._left = self._reality()
        return observations, infos

    def _reward(self, agent: str) -> float:
        reward = self._options.reward
        if reward is not None:
            return _number(reward(self.nest, agent), agent)
        return self._acting.reward(agent) if isinstance(self._acting, TaskActing) else 0.0

    def _ends(self) -> tuple[bool, bool]:
        """Return True if the episode has ended, and True if it was cut."""
        ends = self._options.ends
        ended = ends is not None and _truth(ends(self.nest))
        if isinstance(self._acting, TaskActing):
            is_cut = self._acting.is_cut
            return ended or (self._acting.is_over and not is_cut), is_cut
        return ended, len(self._played) >= (self._options.max_steps or _MAX_STEPS)

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Return a picture of the simulator `render_path` (height, width, 3), or print a line.

        Raises:
            InputError: No episode has begun.
        """
        if self.render_mode == "rgb_array":
            return picture(self.nest, self._render_path)
        if self.render_mode == "human":
            sys.stdout.write(f"{line(self.nest, self._render_path)}\n")
        if self.render_mode is None:
            modes = " or ".join(map(repr, RENDER_MODES))
            warnings.warn(
                f"render shows nothing: make the environment with render_mode={modes}", stacklevel=2
            )
        return None

    def state(self) -> Any:
        """Return the real world: the arrays of an observation in one row, or plain data.

        Things have the order of `layout`, and later ones follow.
        """
        state, order = self.nest["/"].state, KnownOrder(self.layout)
        order.note(state)
        observation = self._form(order, state, ())
        if self._options.observations == "dict":
            return observation
        return spaces.flatten(space_of(self._bounds.own_shapes()), observation)

    def close(self) -> None:
        """End the episode and close the world."""
        self._end_episode()
        if self._worlds is not None:
            self._worlds.__exit__(None, None, None)
            self._worlds = None

    def _end_episode(self) -> None:
        if self._nest is not None:
            self._nest.close()
        self._nest = self._acting = None
        self.agents = []

    def _read(self, agent: str, action: Any) -> Call | str:
        if isinstance(action, Call):
            return action
        if self._options.actions == "programs":
            if not isinstance(action, str | None):
                raise InputError(f"a program is a text, not {type(action).__name__}")
            return action or ""
        if isinstance(action, NamedAction):
            return action.call
        if self._options.actions == "flat":
            return self._flat.call(action, self._mind(agent))
        return self._calls.read(self.known(agent), action)

    def _told(
        self, deeds: Mapping[str, ActionState], *, spoken: bool
    ) -> tuple[dict[str, Any], dict[str, Infos]]:
        """Return the observations and infos of all agents."""
        infos: dict[str, Infos] = {
            agent: {"error": deeds[agent].error, "busy": deeds[agent].busy} for agent in self.agents
        }
        # Folding all of them together costs less than one by one.
        states = self.nest.states(self._reads)
        for agent in self.agents:
            self._orders[agent].note(states[path_text((agent,))])
        observations: dict[str, Any] = {}
        for agent in self.agents:
            state = states[path_text((agent,))]
            below = {
                path: self._belief(states[path_text(path)], spoken=spoken)
                for path in self._nested_of[agent]
            }
            own = self._belief(state, spoken=spoken)
            beliefs = {path_text(path): each for path, each in below.items()}
            if beliefs:
                infos[agent]["beliefs"] = beliefs
            if self._options.observations == "arrays":
                observations[agent] = self._bounds.with_nested(own, self._orders[agent], below)
            else:
                observations[agent] = {**own, "beliefs": beliefs} if beliefs else own
            if self._options.actions == "flat":
                mask = self._flat.mask(self._mind(agent, state))
                infos[agent]["action_mask"] = mask
                observations[agent] = {**observations[agent], "action_mask": mask}
        return observations, infos

    def _belief(self, state: State, *, spoken: bool) -> Any:
        """Return a belief as it is told; an agent's own is noted already."""
        text, order = path_text(state.path), self._orders[state.path[0]]
        lines: Sequence[tuple[int, str, str]] = ()
        if spoken:
            read_before = self._heard.get(text, 0)
            self._heard[text] = len(state.chat)
            lines = state.chat[read_before:]
        if len(state.path) > 1:
            order.note(state)
        return self._form(order, state, lines)

    def _form(self, order: KnownOrder, state: State, lines: Sequence[tuple[int, str, str]]) -> Any:
        if self._options.observations == "dict":
            return {"tick": state.tick, **belief_json(state)}
        return self._bounds.arrays(order, state, lines)


def _number(earned: Any, agent: str) -> float:
    """Return what a function of the user gives as a reward; raise InputError for no number."""
    try:
        if not isinstance(earned, str | bytes) and math.isfinite(earned):
            return float(earned)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"reward returned {earned!r:.100} for {agent}; return a finite number")


def _truth(ended: Any) -> bool:
    """Return what a function of the user says of the end; raise InputError for no truth."""
    if not isinstance(ended, bool | np.bool_ | int):
        raise InputError(f"ends returned {ended!r:.100}; return True or False")
    return bool(ended)
