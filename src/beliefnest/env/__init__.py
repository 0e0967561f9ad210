"""Scenarios as multi-agent environments of PettingZoo (extra `pettingzoo`)."""

import functools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from beliefnest.errors import InputError, MissingExtraError

if TYPE_CHECKING:  # Imported when an environment is made.
    from beliefnest.env.environment import BeliefEnv
    from beliefnest.env.learners import LearnerEnv
    from beliefnest.env.options import EnvironmentOptions
    from beliefnest.env.playing import Instances
    from beliefnest.env.turns import TurnsEnv
    from beliefnest.env.vector import BeliefVectorEnv
    from beliefnest.episodes.task import Task
    from beliefnest.facts.reading import ClaimLike
    from beliefnest.nest.face.nest import Nest
    from beliefnest.scenarios.scenario import Scenario
    from beliefnest.timeline.run_records import Senses
    from beliefnest.world.values import Position

__all__ = ["aec_env", "parallel_env", "sb3_env", "vector_env"]


def parallel_env(
    scenario: "str | Path | Scenario | Task",
    *,
    parameters: "Mapping[str, Any] | None" = None,
    condition: int | None = None,
    world: str = "scripted",
    actions: Literal["skills", "programs", "flat"] = "skills",
    observations: Literal["arrays", "dict"] = "arrays",
    agents: Sequence[str] | None = None,
    nested: int | Sequence[str] = (),
    phrases: "Mapping[str, Sequence[ClaimLike]] | Sequence[str]" = (),
    items: Sequence[str] = (),
    cells: "Sequence[Position]" = (),
    sizes: "Mapping[str, int] | None" = None,
    reward: "Callable[[Nest, str], float] | None" = None,
    ends: "Callable[[Nest], bool] | None" = None,
    max_steps: int | None = None,
    step_ticks: int | None = None,
    timeout_ticks: int | None = None,
    plays_script: bool = False,
    senses: "Senses | None" = None,
    render_mode: Literal["rgb_array", "human"] | None = None,
    render_path: str = "/",
    seed: int = 0,
) -> "BeliefEnv":
    """Return a scenario or a task as a PettingZoo parallel environment.

    The observation of an agent is its own belief. See docs/pettingzoo.md for the layout of the
    arrays. A task, or a scenario with a goal under `episode`, is played by its own rules: they give
    the agents, rewards and ends, and a joint step is a round.

    Args:
        scenario: Name of a built-in task or scenario, path of a file of either, a scenario, or a
            task. A built-in task, and a file with `instances`, has an instance for each seed.
        parameters: Parameters of the task or scenario of a name or file, such as `{"far": 20}`.
        condition: Number of a condition, if `scenario` is a name or a path; None for the
            scenario as written.
        world: `scripted`, without physics, or `embedded`, Minecraft.
        actions: `skills`, calls of skills in a structured space; `flat`, one number for each call
            of a skill and each claim, with a mask; or `programs`, JavaScript.
        observations: `arrays` of a fixed layout, or a `dict` of plain data.
        agents: Agents that act; None for all, in tasks for the players.
        nested: Beliefs about beliefs that observations hold too, as do infos under `beliefs`:
            paths such as `/anne/sally`, or a number for all paths up to this depth (2 for beliefs
            about others' beliefs; 1 is the observation itself, and adds nothing).
        phrases: Utterances to choose from; a mapping gives the claims of each, as `Claim` or as
            facts.
        items: Names of items that may appear later but that no agent or container has at the
            start.
        cells: Cells that `flat` actions can be about: to go and stand there, to break or place a
            block, to say what is there. Those of blocks and places in goals are among them anyway.
        sizes: Greatest numbers of things of a kind (`agents`, `items`, `containers`, `doors`,
            `levers`, `buttons`, `signs`), by kind; for others, those of the first instances.
        reward: Function of the nest and an agent that returns its reward after a step; None for
            the task's rewards, or 0.
        ends: Function of the nest that returns True if the episode is over; None: only tasks end.
        max_steps: Number of joint steps after which an episode is truncated; None: 100, or the
            task's `rounds`.
        step_ticks: Ticks of a joint step; actions then continue in later steps. None: in tasks
            `round_ticks`, otherwise a step lasts until all actions have ended. Without a task only
            for skills in the scripted world.
        timeout_ticks: Ticks after which an unfinished action is stopped, if a step lasts until
            all actions have ended; None: 1200.
        plays_script: True to begin episodes after the scenario's script, False before it.
        senses: `percepts`: skills plan and programs read with the knowledge of their agent only;
            `world`: with the actual world. None: `percepts` in tasks, otherwise `world`. See
            docs/programs.md.
        render_mode: `rgb_array`: `render` returns a picture; `human`: `render`, `reset` and `step`
            print a line.
        render_path: Path of the simulator that is shown: the real world, or a belief.
        seed: Seed of the first episode, if `reset` gets none.

    Raises:
        MissingExtraError: PettingZoo is not installed.
        UnknownNameError: There is no such scenario, world or item.
        ScenarioError: The scenario is invalid.
        PathError: There is no such agent or belief.
        InputError: Another argument is invalid.
    """
    if agents is not None and not agents:
        raise InputError("agents is empty; name agents that act, or leave it out for all")
    made, described, _ = _classes()
    from beliefnest.env.options import texts

    options = described(
        world=world,
        actions=actions,
        observations=observations,
        agents=None if agents is None else texts("agents", agents),
        nested=nested if isinstance(nested, int) else texts("nested", nested),
        phrases=phrases,
        items=texts("items", items),
        cells=tuple(cells),
        sizes=dict(sizes or {}),
        reward=reward,
        ends=ends,
        max_steps=max_steps,
        step_ticks=step_ticks,
        timeout_ticks=timeout_ticks,
        plays_script=plays_script,
        senses=senses,
        render_mode=render_mode,
        render_path=render_path,
        seed=seed,
    )
    source = _loaded(scenario, condition, parameters or {}, max_steps, step_ticks)
    return made(source, options)


def aec_env(scenario: "str | Path | Scenario | Task", **options: Any) -> "TurnsEnv":
    """Return a scenario or a task as a PettingZoo environment in which agents act in turn.

    The world moves when all agents have chosen. `unwrapped` is the parallel environment.

    Args:
        scenario: As for `parallel_env`.
        options: Arguments of `parallel_env`.
    """
    env = parallel_env(scenario, **options)
    from beliefnest.env.turns import TurnsEnv

    return TurnsEnv(env)


def vector_env(
    scenario: "str | Path | Scenario | Task", copies: int, *, processes: int = 1, **options: Any
) -> "BeliefVectorEnv":
    """Return copies of an environment as a vector environment of Gymnasium.

    Args:
        scenario: As for `parallel_env`.
        copies: Number of copies; each agent of a copy is one environment of the vector.
        processes: Number of processes that step the copies; 1: this one alone. The observations,
            rewards and infos are the same.
        options: Arguments of `parallel_env`.

    Raises:
        InputError: `copies` or `processes` is below 1 or no whole number, there are more processes
            than copies, or the observations are no arrays.
    """
    *_, vector = _classes()
    return vector(functools.partial(parallel_env, scenario, **options), copies, processes)


def sb3_env(
    scenario: "str | Path | Scenario | Task", copies: int = 1, *, processes: int = 1, **options: Any
) -> "LearnerEnv":
    """Return copies of an environment for stable-baselines3: `PPO`, or `MaskablePPO` with masks.

    Args:
        scenario: As for `parallel_env`.
        copies: Number of copies; each agent of a copy is one environment of the vector.
        processes: Number of processes that step the copies.
        options: Arguments of `parallel_env`; `actions` is `flat`.

    Raises:
        MissingExtraError: stable-baselines3 is not installed.
        InputError: As for `vector_env`, or `actions` is not `flat`.
    """
    flat = {"actions": "flat", **options}
    if flat["actions"] != "flat":
        raise InputError(
            f"actions is {flat['actions']!r}, which learners of stable-baselines3 cannot choose; "
            "leave it out: it is 'flat'"
        )
    env = vector_env(scenario, copies, processes=processes, **flat)
    try:
        from beliefnest.env.learners import LearnerEnv
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "stable_baselines3":
            raise
        raise MissingExtraError("sb3_env needs stable-baselines3", "sb3") from None
    return LearnerEnv(env)


def _classes() -> "tuple[type[BeliefEnv], type[EnvironmentOptions], type[BeliefVectorEnv]]":
    """Import the classes that need PettingZoo."""
    try:
        from beliefnest.env.environment import BeliefEnv
        from beliefnest.env.options import EnvironmentOptions
        from beliefnest.env.vector import BeliefVectorEnv
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("pettingzoo", "gymnasium"):
            raise
        raise MissingExtraError(f"environments need {error.name}", "pettingzoo") from None
    return BeliefEnv, EnvironmentOptions, BeliefVectorEnv


def _loaded(
    scenario: "str | Path | Scenario | Task",
    condition: int | None,
    parameters: "Mapping[str, Any]",
    rounds: int | None,
    round_ticks: int | None,
) -> "Scenario | Instances":
    """Return a scenario without a goal, or else the instances of a task."""
    from beliefnest.env.playing import Instances
    from beliefnest.episodes.task import Task
    from beliefnest.scenarios.rules import GoalEntry
    from beliefnest.scenarios.scenario import Scenario

    scenario = str(scenario) if isinstance(scenario, Path) else scenario
    if not isinstance(scenario, str | Scenario | Task):
        raise InputError(f"{scenario!r:.100} is no scenario; give a name, a file, or an object")
    if not isinstance(parameters, Mapping):
        raise InputError(f"parameters is {parameters!r:.100}; give values by name")
    if isinstance(scenario, str):
        made = _named(scenario, condition, parameters)
    elif parameters or condition is not None:
        raise InputError(
            "parameters are for names and files, as is condition; give the task or scenario its own"
        )
    elif isinstance(scenario, Scenario):
        has_goal = scenario.rules is not None and scenario.rules.goal != GoalEntry()
        made = functools.partial(_same, Task.of(scenario)) if has_goal else scenario
    else:
        made = functools.partial(_same, scenario)
    return made if isinstance(made, Scenario) else Instances(made, rounds, round_ticks)


def _named(
    name: str, condition: int | None, parameters: "Mapping[str, Any]"
) -> "Scenario | Callable[[int], Task]":
    """Return a scenario without a goal, or else a function that returns a task's instances."""
    from beliefnest.episodes.task import Task
    from beliefnest.scenarios.instances import has_instances
    from beliefnest.scenarios.parameters import check_declared, declared_in
    from beliefnest.scenarios.rules import GoalEntry
    from beliefnest.scenarios.scenario import Scenario, warn_of_values

    document = Task.scenario_document(name)
    if document is None:
        return functools.partial(Task.load, name, condition=condition, **parameters)
    is_drawn = has_instances(document)
    scenario = Scenario.varied(document, condition, {} if is_drawn else parameters)
    check_declared(document, declared_in(document, condition), parameters)
    warn_of_values(document, condition, parameters)
    if scenario.rules is None or scenario.rules.goal == GoalEntry():
        return scenario
    if not is_drawn:
        return functools.partial(_same, Task.of(scenario))
    return functools.partial(Task.instance_of, document, condition=condition, parameters=parameters)


def _same(task: "Task", seed: int) -> "Task":
    """Return a task that has no instances."""
    return task
