"""Contents of states as plain values that compare and print."""

from typing import Any

from beliefnest.belief.view import State


def everything(state: State) -> dict[str, Any]:
    """All that a state shows, its path and tick left out."""
    blocks = state.blocks
    return {
        "blocks": {p: (blocks[p], blocks.current(p), blocks.basis(p)) for p in blocks},
        "containers": dict(state.containers),
        "agents": dict(state.agents),
        "items": dict(state.items),
        "events": state.events,
        "chat": tuple(state.chat),
        "thoughts": tuple(state.thoughts),
        "addressees": tuple(state.addressees),
        "signs": dict(state.signs),
    }


def values(state: State) -> dict[str, Any]:
    """Return the content of a state without the grounds of its beliefs."""
    return {
        "blocks": {p: state.blocks[p] for p in state.blocks},
        "signs": dict(state.signs),
        "containers": {p: (c.items, c.complete) for p, c in state.containers.items()},
        "agents": {
            n: (a.position, a.yaw, a.pitch, dict(a.inventory)) for n, a in state.agents.items()
        },
        "events": state.events,
        "chat": tuple(state.chat),
        "thoughts": tuple(state.thoughts),
        "addressees": tuple(state.addressees),
    }
