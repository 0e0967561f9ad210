"""Scenarios as environments of several agents (PettingZoo, the extra `pettingzoo`)."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Literal

from beliefnest.errors import MissingExtraError

if TYPE_CHECKING:  # Imported when an environment is made.
    from beliefnest.env.environment import BeliefEnv, Options
    from beliefnest.env.layout import Phrases
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
    """Return a scenario as a parallel environment of PettingZoo's.

    An agent's observation is its own belief. See docs/pettingzoo.md for the layout of arrays.

    Args:
        scenario: Name of a built-in scenario, path of a file, or a scenario.
        condition: Number of a condition, where `scenario` is a name; None: as written.
        world: `scripted`, without physics, or `embedded`, Minecraft.
        actions: `skills`, calls of skills in a structured space, or `programs`, JavaScript.
        observations: `arrays` of a fixed layout, or a `dict` of plain data.
        agents: Who acts; None: everybody.
        nested: Beliefs about beliefs that infos hold, under `beliefs`: paths such as
            `/anne/sally`, or all of them down to a depth.
        phrases: What can be said, each with the claims that it makes if it is a mapping.
        items: Names of items that nobody has at the start and somebody may have later.
        reward: Given the nest and an agent, its reward after a step; None: always 0.
        ends: Given the nest, whether the episode has come to its end; None: it never has.
        max_steps: Joint steps after which an episode is cut off.
        step_ticks: Ticks of a joint step, in which skills go on into the next steps; None: a step
            lasts until all that was begun has ended. For skills in the scripted world.
        timeout_ticks: Ticks after which what an action began is ended, if `step_ticks` is None.
        plays_script: Whether episodes begin after the scenario's script, not before it.
        senses: `percepts`: skills look for ways by what their agent knows, and programs read no
            more than that; `world`: by what is the case. See docs/programs.md.
        seed: Of the first episode that is begun without one.

    Raises:
        MissingExtraError: PettingZoo is not installed.
        UnknownNameError: There is no such scenario, world or item.
        ScenarioError: The scenario is wrong.
        PathError: There is no such agent or belief.
        InputError: An argument is of no use.
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
    """What needs PettingZoo: the environment, and how it is."""
    try:
        from beliefnest.env.environment import BeliefEnv, Options
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("pettingzoo", "gymnasium"):
            raise
        raise MissingExtraError(f"environments need {error.name}", "pettingzoo") from None
    return BeliefEnv, Options


def _loaded(scenario: "str | Scenario", condition: int | None) -> "Scenario":
    from beliefnest.scenarios.scenario import Scenario

    return Scenario.load(scenario, condition) if isinstance(scenario, str) else scenario
