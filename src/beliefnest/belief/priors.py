"""Merge of all initial beliefs that apply to one node."""

from collections.abc import Sequence

from beliefnest.belief.grounds import InitialBelief
from beliefnest.world.paths import AND_BELOW, BeliefPath


def merged_belief(initial: Sequence[InitialBelief], node: BeliefPath) -> InitialBelief:
    """Return the initial beliefs of a node, merged from all that apply to it.

    Where two speak of the same element, the more precise path counts; see `InitialBelief.path`.
    """
    beliefs = [belief for belief in initial if _is_about(belief.path, node)]
    merged = InitialBelief(node)
    for belief in sorted(beliefs, key=_precision):
        merged = InitialBelief(
            node,
            {**merged.containers, **belief.containers},
            {**merged.blocks, **belief.blocks},
            {**merged.agents, **belief.agents},
            {**merged.inventories, **belief.inventories},
        )
    return merged


def _precision(belief: InitialBelief) -> tuple[int, bool]:
    is_exact = AND_BELOW not in belief.path
    return len(belief.path) - (not is_exact), is_exact


def _is_about(path: BeliefPath, node: BeliefPath) -> bool:
    if path[-1:] == (AND_BELOW,):
        return node[: len(path) - 1] == path[:-1]
    return path == node
