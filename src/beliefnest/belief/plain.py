"""States as plain data, for JSON and tables."""

from collections.abc import Iterable

from beliefnest.belief.grounds import Basis
from beliefnest.belief.view import State
from beliefnest.world.values import Position


def state_json(state: State) -> dict[str, object]:
    """Return a state as the STATE object of the public surface."""
    return {
        "containers": {
            place_key(place): {
                "items": dict(sorted(container.items.items())),
                "complete": container.complete,
            }
            for place, container in sorted(state.containers.items())
        },
        "agents": {
            name: {"position": _list(agent.position), "current": agent.current}
            for name, agent in sorted(state.agents.items())
        },
        "chat": [list(line) for line in state.chat],
        "addressees": list(state.addressees),
        **_signs(state),
    }


def belief_json(state: State) -> dict[str, object]:
    """Return a state without its blocks: the object of `state_json` with the bases of beliefs."""
    return {
        **state_json(state),
        "containers": {
            place_key(place): {
                "items": dict(sorted(container.items.items())),
                "complete": container.complete,
                "current": container.current,
                **_basis_json(container.basis),
            }
            for place, container in sorted(state.containers.items())
        },
        "agents": {
            name: {
                "position": _list(agent.position),
                "yaw": agent.yaw,
                "pitch": agent.pitch,
                "current": agent.current,
                **_basis_json(agent.basis),
                "equipment": agent.equipment and dict(sorted(agent.equipment.items())),
                "inventory": dict(sorted(agent.inventory.items())),
                "inventory_complete": agent.inventory_complete,
            }
            for name, agent in sorted(state.agents.items())
        },
        "thoughts": [list(line) for line in state.thoughts],
    }


def _signs(state: State) -> dict[str, object]:
    """Return the known texts of signs under one key; an empty object if there are none."""
    signs = {place_key(place): text for place, text in state.signs.items()}
    return {"signs": signs} if signs else {}


def place_key(place: Position) -> str:
    """Return a block's position as the key of a JSON object."""
    return ",".join(map(str, place))


def _basis_json(basis: Basis | None) -> dict[str, object]:
    if basis is None:
        return {"observed_at": None, "source": None}
    speaker = {} if basis.speaker is None else {"speaker": basis.speaker}
    return {"observed_at": basis.observed_at, "source": basis.source.value, **speaker}


def _list(point: Iterable[float] | None) -> list[float] | None:
    return None if point is None else list(point)
