"""One path for skills: an environment's action, a program, a policy and a planner do the same."""

from collections.abc import Callable, Mapping

import pytest
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.env import parallel_env
from beliefnest.env.actions import Call
from beliefnest.episodes.imagination import Performer
from beliefnest.scenarios.scenario import Scenario

OFF, ON = ("lever[face=floor,facing=north,powered=" + on + "]" for on in ("false", "true"))
SPOTS = {"near": (2, 1), "behind a wall": (7, 1), "high up": (3, 8)}
PEOPLE = {"near": "cat", "behind a wall": "bob", "high up": "dan"}
ROWS = {"chest": 1, "lever": 3, "on": 5, "button": 7, "gate": 9, "sign": 11}
BLOCKS = {
    "lever": OFF,
    "on": ON,
    "button": "stone_button[face=floor]",
    "gate": "oak_fence_gate[facing=east]",
}
SWITCHES = ("lever", "on", "gate")
EVENTS = ("open_container", "press_button")
PHRASE = "hello"


def at(kind: str, thing: str) -> tuple[int, int, int]:
    return (*SPOTS[kind], ROWS[thing])


def scene(*, has_goal: bool = False) -> Scenario:
    """Return Ann on one side of a wall, with the same things near, behind it, and high up."""
    things = [
        {"block": text, "at": list(at(kind, name))}
        for kind in SPOTS
        for name, text in BLOCKS.items()
    ]
    stone = [([0, 0, 0], [12, 0, 14]), ([6, 1, 0], [6, 11, 14]), ([3, 7, 0], [3, 7, 14])]
    people = {PEOPLE[kind]: {"position": [x + 0.5, y, 2.5]} for kind, (x, y) in SPOTS.items()}
    goal = {"reach": [{"agent": "ann", "at": [0, 1, 14]}]}
    chests = [{"at": list(at(kind, "chest")), "items": {"apple": 1}} for kind in SPOTS]
    return Scenario.from_mapping(
        {
            "name": "doors",
            "box": [[0, 0, 0], [12, 11, 14]],
            "blocks": [*({"block": "stone", "fill": list(each)} for each in stone), *things],
            "containers": chests,
            "signs": [{"at": list(at(kind, "sign")), "text": "old"} for kind in SPOTS],
            "agents": {
                "ann": {"position": [4.5, 1, 4.5], "inventory": {"diamond": 1}},
                **people,
            },
            "static_blocks": ["stone"],
            "perception": {"max_visible_distance": 64},
            # Everybody knows where everything is, so that only the hands differ.
            "initial_beliefs": [
                {
                    "path": "/**",
                    "blocks": things,
                    "containers": [{**each, "complete": True} for each in chests],
                    "signs": [{"at": list(at(kind, "sign")), "text": "old"} for kind in SPOTS],
                    "agents": {name: each["position"] for name, each in people.items()},
                }
            ],
            **({"episode": {"goal": goal, "rounds": 60}} if has_goal else {}),
        }
    )


def skills(kind: str) -> Mapping[str, tuple[str, dict[str, object]]]:
    """Return the parts of an action for each skill that uses something of a kind."""
    return {
        "take": (
            "getItemFromChest",
            {"container": at(kind, "chest"), "item": "apple", "count": 1},
        ),
        "put": (
            "depositItemIntoChest",
            {"container": at(kind, "chest"), "item": "diamond", "count": 1},
        ),
        "look in": ("openContainer", {"container": at(kind, "chest")}),
        "switch on": ("turnOnLever", {"lever": at(kind, "lever")}),
        "switch off": ("turnOffLever", {"lever": at(kind, "on")}),
        "press": ("pressButton", {"button": at(kind, "button")}),
        "open": ("openDoor", {"door": at(kind, "gate")}),
        "write": ("writeSign", {"sign": at(kind, "sign"), "phrase": PHRASE}),
        "give": ("giveItemToOther", {"agent": PEOPLE[kind], "item": "diamond", "count": 1}),
    }


def told(nest: bn.Nest) -> dict[str, object]:
    """Return what skills can change."""
    state = nest["/"].state
    return {
        "blocks": [state.blocks[at(kind, name)] for kind in SPOTS for name in SWITCHES],
        "held": {name: dict(each.inventory) for name, each in state.agents.items()},
        "containers": {place: dict(each.items) for place, each in state.containers.items()},
        "signs": dict(state.signs),
        # A button comes out again while the rest of a round passes.
        "events": [each.detail for each in state.events if each.kind.value in EVENTS],
    }


Outcome = tuple[bool, dict[str, object]]


def environment(*, has_goal: bool = False, **options: object) -> Callable[..., Outcome]:
    def act(skill: str, parts: Mapping[str, object]) -> Outcome:
        env = parallel_env(scene(has_goal=has_goal), agents=["ann"], phrases=[PHRASE], **options)
        env.reset(seed=0)
        *_, infos = env.step({"ann": env.action(skill, **parts)})
        while infos["ann"]["busy"]:
            *_, infos = env.step({})
        found = (not infos["ann"]["error"], told(env.nest))
        env.close()
        return found

    return act


def call_of(skill: str, parts: Mapping[str, object]) -> Call:
    env = parallel_env(scene(), agents=["ann"], phrases=[PHRASE])
    env.reset(seed=0)
    return env._calls.read(env.known("ann"), env.action(skill, **parts))


def program(senses: str) -> Callable[..., Outcome]:
    def run(skill: str, parts: Mapping[str, object]) -> Outcome:
        with bn.Nest.open(scene(), world="scripted") as nest:
            ok = nest["/"].run("ann", call_of(skill, parts).program, senses=senses).ok
            return ok, told(nest)

    return run


class Once:
    """Policy with one program, in its first round."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.ended = ""

    def act(self, view: bn.AgentView) -> str:
        self.ended = view.last.how
        return "go on" if view.last.how == "cut" else "" if view.round else self.text


def policy(skill: str, parts: Mapping[str, object]) -> Outcome:
    once = Once(call_of(skill, parts).program)
    with bn.Episode(bn.Task.of(scene(has_goal=True)), {"ann": once}, world="scripted") as episode:
        episode.play(1)
        while once.ended in ("", "cut", "none"):
            episode.play(1)
        return once.ended not in ("failed", "no_way"), told(episode.nest)


def planner(skill: str, parts: Mapping[str, object]) -> Outcome:
    with bn.Nest.open(scene(), world="scripted") as nest:
        mind, mine = nest["/ann"].imagination(0, 1), Performer([call_of(skill, parts)])
        mind.play({"ann": mine}, 300, lambda: mine.is_done)
        return not mine.failed, {}


DOORS = {
    "program with the world's senses": program("world"),
    "action": environment(senses="percepts"),
    "action with the world's senses": environment(),
    "action in steps": environment(senses="percepts", step_ticks=3),
    "action of a task": environment(has_goal=True),
    "policy": policy,
    "planner": planner,
}


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("skill", few_by_day(skills("near"), 3))
def test_every_door_leads_as_far_as_a_program(skill: str, door: str) -> None:
    for kind in SPOTS:
        call = skills(kind)[skill]
        is_done, changed = program("percepts")(*call)
        assert is_done is (kind == "near"), kind
        ok, after = DOORS[door](*call)
        assert ok is is_done, kind
        if after:
            assert after == changed, kind
