"""Scenarios as multi-agent environments of PettingZoo (extra `pettingzoo`)."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Literal

from beliefnest.errors import MissingExtraError

if TYPE_CHECKING:  # Imported when an environment is made.
    from beliefnest.adapters.pettingzoo.environment import BeliefEnv, Options
    from beliefnest.adapters.pettingzoo.layout import Phrases
    from beliefnest.nest.face.nest import Nest
    from beliefnest.nest.past.setting import Senses
    from beliefnest.scenarios.scenario import Scenario

__all__ = ["parallel_env"]


def parallel_env(
    scenario: "str | Scenario",
    *,
    condition: int | None = None,
    world: str = "scripted",
    actions: Literal["skills", "programs"] = "skills",
    observations: Literal["arrays", "dict"] = "arrays",
    agents: Sequence[str] | None = None,
    nested: int | Sequence[str] = (),
    phrases: "Phrases | Sequence[str]" = (),
    items: Sequence[str] = (),
    reward: "Callable[[Nest, str], float] | None" = None,
    ends: "Callable[[Nest], bool] | None" = None,
    max_steps: int = 100,
    step_ticks: int | None = None,
    timeout_ticks: int = 1200,
    plays_script: bool = False,
    senses: "Senses" = "world",
    seed: int = 0,
) -> "BeliefEnv":
    """Return a scenario as a PettingZoo parallel environment.

    The observation of an agent is its own belief. See docs/pettingzoo.md for the layout of the
    arrays.

    Args:
        scenario: Name of a built-in scenario, path of a scenario file, or a scenario.
        condition: Number of a condition, if `scenario` is a name or a path; None for the
            scenario as written.
        world: `scripted`, without physics, or `embedded`, Minecraft.
        actions: `skills`, calls of skills in a structured space, or `programs`, JavaScript.
        observations: `arrays` of a fixed layout, or a `dict` of plain data.
        agents: Agents that act; None for all.
        nested: Beliefs about beliefs, which the infos hold under `beliefs`: paths such as
            `/anne/sally`, or the greatest depth of all such paths.
        phrases: Utterances to choose from; a mapping gives the claims of each.
        items: Names of items that may appear later but that no agent or container has at the
            start.
        reward: Function of the nest and an agent that returns its reward after a step; None for
            0.
        ends: Function of the nest that returns True if the episode is over; None: it never is.
        max_steps: Number of joint steps after which an episode is truncated.
        step_ticks: Ticks of a joint step; skills then continue in later steps. None: a step
            lasts until all actions have ended. Only for skills in the scripted world.
        timeout_ticks: Ticks after which an unfinished action is stopped, if `step_ticks` is
            None.
        plays_script: True to begin episodes after the scenario's script, False before it.
        senses: `percepts`: skills plan and programs read with the knowledge of their agent only;
            `world`: with the actual world. See docs/programs.md.
        seed: Seed of the first episode, if `reset` gets none.

    Raises:
        MissingExtraError: PettingZoo is not installed.
        UnknownNameError: There is no such scenario, world or item.
        ScenarioError: The scenario is invalid.
        PathError: There is no such agent or belief.
        InputError: Another argument is invalid.
    """
    made, described = _classes()
    options = described(
        world=world,
        actions=actions,
        observations=observations,
        agents=None if agents is None else tuple(agents),
        nested=nested if isinstance(nested, int) else tuple(nested),
        phrases=phrases,
        items=tuple(items),
        reward=reward,
        ends=ends,
        max_steps=max_steps,
        step_ticks=step_ticks,
        timeout_ticks=timeout_ticks,
        plays_script=plays_script,
        senses=senses,
        seed=seed,
    )
    return made(_loaded(scenario, condition), options)


def _classes() -> "tuple[type[BeliefEnv], type[Options]]":
    """Import the classes that need PettingZoo."""
    try:
        from beliefnest.adapters.pettingzoo.environment import BeliefEnv, Options
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("pettingzoo", "gymnasium"):
            raise
        raise MissingExtraError(f"environments need {error.name}", "pettingzoo") from None
    return BeliefEnv, Options


def _loaded(scenario: "str | Scenario", condition: int | None) -> "Scenario":
    from beliefnest.scenarios.scenario import Scenario

    return Scenario.load(scenario, condition) if isinstance(scenario, str) else scenario
