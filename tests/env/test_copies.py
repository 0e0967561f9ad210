"""Copies of environments, and saved episodes: what comes after is the same, byte for byte."""

import copy
import io
import pickle
import pickletools
import random
from collections.abc import Callable
from contextlib import closing
from typing import Any

import numpy as np
import pytest
from tests.profiles import at_night, few_by_day

import beliefnest as bn
from beliefnest.env import parallel_env, vector_env

HALL = {
    "name": "hall",
    "box": [[0, 0, 0], [8, 3, 8]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]},
        {"block": "bricks", "fill": [[4, 1, 0], [4, 3, 5]]},
    ],
    "containers": [{"at": [2, 1, 2], "items": {"diamond": 1}}, {"at": [7, 1, 2]}],
    "agents": {"ann": {"position": [1.5, 1, 1.5]}, "bob": {"position": [6.5, 1, 6.5]}},
}
EPISODE = {
    "goal": {"reach": [{"agent": "bob", "items": {"diamond": 1}}]},
    "talk": ["ann", "bob"],
    "rewards": {"each_round": -1},
    "rounds": 9,
    "round_ticks": 2,
}
FORMS: dict[str, dict[str, Any]] = {
    "steps": {"step_ticks": 2, "nested": 2, "phrases": ["yes", "no"]},
    "flat": {"step_ticks": 2, "actions": "flat"},
    "whole actions": {"phrases": ["yes", "no"], "observations": "dict"},
    "task": {"nested": 2, "phrases": ["yes", "no"]},
}


def hall(form: str, **options: Any) -> Any:
    """Return an environment of a hall in which Ann and Bob cannot see each other at first."""
    scene = {**HALL, "episode": EPISODE} if form == "task" else HALL
    made = {"max_steps": 9, **FORMS[form], **options}
    return parallel_env(bn.Scenario.from_mapping(scene), **made)


def played(env: Any, steps: int) -> bytes:
    """Play random actions of the environment's own spaces; return all that came of it."""
    told = []
    for _ in range(steps):
        told.append(env.step({agent: env.action_space(agent).sample() for agent in env.agents}))
    return written((told, env.agents, env.nest.tick))


def written(values: object) -> bytes:
    """Return values as bytes, which do not tell if equal values are one object or several."""
    out = io.BytesIO()
    pickler = pickle.Pickler(out)
    pickler.fast = True
    pickler.dump(values)
    return out.getvalue()


COPIES: dict[str, Callable[[Any], Any]] = {
    "deepcopy": copy.deepcopy,
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("cut", few_by_day(range(at_night(100, 4)), 2))
def test_what_follows_a_cut_is_the_same_in_copies_and_after_restore(cut: int, form: str) -> None:
    chance = random.Random(f"{form} {cut}")
    with closing(hall(form)) as env:
        env.reset(seed=chance.randrange(1000))
        for agent in env.agents:
            env.action_space(agent).seed(cut)
        played(env, chance.randrange(5))
        saved, again = env.save(), pickle.loads(pickle.dumps(env.save()))
        assert saved == again
        copies = [make(env) for make in COPIES.values()]
        other = COPIES["deepcopy"](env)
        after = played(env, 4)
        for each in copies:
            with closing(each):
                assert played(each, 4) == after
        with closing(other):
            # A restored episode is the same in an environment that has played something else.
            spaces = {agent: copy.deepcopy(other.action_space(agent)) for agent in other.agents}
            played(other, 2)
            other.reset(seed=77)
            other.restore(again)
            other._spaces = {agent: (None, spaces[agent]) for agent in spaces}
            assert played(other, 4) == after


def test_a_pickle_names_nothing_that_is_to_be_looked_for_in_every_module() -> None:
    with closing(hall("task")) as env:
        names = [arg for _, arg, _ in pickletools.genops(pickle.dumps(env, 4)) if arg == "UNSET"]
        assert names == []


def test_an_episode_that_is_over_is_over_after_restore_too() -> None:
    with closing(hall("task")) as env:
        env.reset(seed=0)
        while env.agents:
            last = env.step({})
        saved = env.save()
        env.reset(seed=5)
        told = env.restore(saved)
        assert env.agents == []
        assert written(told) == written((last[0], last[-1]))
        # The next episode is the one that would have come next.
        env.reset()
        assert env.save().seed == 1


def test_what_cannot_be_saved_or_restored_is_refused() -> None:
    with closing(hall("task")) as env:
        with pytest.raises(bn.InputError, match=r"no episode has begun; call reset\(\)"):
            env.save()
        assert isinstance(copy.deepcopy(env), type(env))
        env.reset(seed=0)
        for wrong in (None, {}, b"x"):
            with pytest.raises(bn.InputError, match=r"is not an episode of hall; give what save"):
                env.restore(wrong)
        with closing(parallel_env("joint-lift")) as other:
            other.reset(seed=0)
            with pytest.raises(bn.InputError, match="'joint-lift' is not an episode of hall"):
                env.restore(other.save())
        env.nest.scripted_world.set_block((1, 1, 7), "stone")
        with pytest.raises(bn.InputError, match="the world was changed by hand"):
            env.save()
        env.step({})
        with pytest.raises(bn.InputError, match="the world was changed by hand"):
            pickle.dumps(env)
        env.reset(seed=0)
        env.save()


@pytest.mark.parametrize("other", [{"step_ticks": 7}, {"agents": ["ann"]}, {"max_steps": 8}])
def test_an_episode_of_an_environment_that_is_made_otherwise_is_refused(other: Any) -> None:
    with closing(hall("task")) as env, closing(hall("task", **other)) as foreign:
        env.reset(seed=3)
        env.step({})
        foreign.reset(seed=4)
        foreign.step({})
        tick = foreign.nest.tick
        with pytest.raises(bn.InputError, match="the saved episode of hall began in another way"):
            foreign.restore(env.save())
        assert (foreign.nest.tick, foreign.save().seed) == (tick, 4)
        # Other observations and another form of actions change nothing of what happens.
        with closing(hall("task", nested=["/ann/bob"], actions="skills")) as alike:
            alike.restore(env.save())
            assert alike.nest.tick == env.nest.tick


def test_a_file_of_the_same_name_with_other_contents_is_another_scenario() -> None:
    moved = copy.deepcopy(HALL)
    moved["containers"][0]["items"] = {"emerald": 1}
    one, other = (bn.Scenario.from_mapping(each) for each in (HALL, moved))
    with closing(parallel_env(one)) as env, closing(parallel_env(other)) as foreign:
        env.reset(seed=0)
        with pytest.raises(bn.InputError, match="began in another way"):
            foreign.restore(env.save())


@pytest.mark.parametrize("path", ["/", "/ann", "/ann/bob"])
def test_a_switched_timeline_is_refused_until_it_is_switched_back(path: str) -> None:
    with closing(hall("task")) as env:
        env.reset(seed=0)
        env.step({})
        simulator = env.nest[path]
        home, tick = simulator.branch, env.nest.tick
        simulator.switch("plan")
        with pytest.raises(bn.InputError) as fault:
            env.step({})
        assert str(fault.value) == (
            f"{path} was switched to the branch 'plan'; the episode is on {home!r}: "
            f"env.nest[{path!r}].switch({home!r}) returns to it"
        )
        simulator.switch(home)
        env.step({})
        assert env.nest.tick == tick + EPISODE["round_ticks"]


@pytest.mark.parametrize("options", [{"far": 20}, {"seed": 1, "typo": 1}, {3: 4}])
def test_options_of_reset_that_do_not_exist_are_refused_by_name(options: dict[Any, Any]) -> None:
    names = ", ".join(sorted(map(str, options)))
    with closing(hall("steps")) as env, closing(vector_env("joint-lift", 1)) as copies:
        for each in (env, copies):
            with pytest.raises(bn.InputError, match=f"reset was given {names}, and has no such"):
                each.reset(seed=1, options=options)
        # PettingZoo's own tests give this one.
        env.reset(seed=1, options={"options": 1})


def test_options_that_objects_and_tasks_do_not_have_are_refused() -> None:
    scene = bn.Scenario.from_mapping(HALL)
    with pytest.raises(bn.InputError, match="for names and files, as is condition"):
        parallel_env(scene, condition=1)
    with pytest.raises(bn.InputError, match="and plays_script"):
        parallel_env("joint-lift", plays_script=True)


def test_a_mask_resets_the_copies_that_it_names() -> None:
    with closing(vector_env(bn.Scenario.from_mapping({**HALL, "episode": EPISODE}), 2)) as env:
        first = np.array([True, True, False, False])
        with pytest.raises(bn.InputError, match="for copies that have begun; reset all first"):
            env.reset(options={"reset_mask": first})
        begun, _ = env.reset(seed=0)
        later, *_ = env.step(env.action_space.sample())
        told, infos = env.reset(options={"reset_mask": first})
        assert told["tick"][:2].tolist() == begun["tick"][:2].tolist()
        assert told["tick"][2:].tolist() == later["tick"][2:].tolist()
        assert infos["_busy"].tolist() == first.tolist()
        for mask, message in (
            (np.array([True, False, False, False]), "parts the agents of a copy"),
            (np.array([1, 0]), "give an array of 4 truths"),
            ([True], "give an array of 4 truths"),
        ):
            with pytest.raises(bn.InputError, match=message):
                env.reset(options={"reset_mask": mask})


@pytest.mark.parametrize("policy", ["random", "search:0"])
def test_agents_of_the_environment_decide_alike_after_a_restore(policy: str) -> None:
    scene = {**HALL, "episode": {**EPISODE, "players": ["ann"], "policies": {"bob": policy}}}
    with closing(parallel_env(bn.Scenario.from_mapping(scene), nested=2)) as env:
        env.reset(seed=4)
        env.step({})
        saved = env.save()
        told = [env.step({}) for _ in range(3)]
        env.restore(saved)
        assert written([env.step({}) for _ in range(3)]) == written(told)
