"""The more precise of two initial beliefs counts, for each kind of element."""

import pytest

from beliefnest.belief.grounds import InitialBelief
from beliefnest.belief.priors import merged_belief

ELEMENTS = {
    "containers": ((1, 2, 3), [({"apple": 1}, True), ({}, False)]),
    "blocks": ((1, 2, 3), [4, -1]),
    "agents": ("bob", [(0.5, 1.0, 0.5), (2.5, 1.0, 2.5)]),
    "inventories": ("bob", [{"apple": 1}, {}]),
}


@pytest.mark.parametrize("kind", ELEMENTS)
@pytest.mark.parametrize("paths", [(("**",), ("ann",)), (("ann", "**"), ("ann",))])
def test_the_more_precise_path_counts(kind, paths):
    element, values = ELEMENTS[kind]
    initial = [
        InitialBelief(path, **{kind: {element: value}})
        for path, value in zip(paths, values, strict=True)
    ]
    for beliefs in (initial, initial[::-1]):
        assert getattr(merged_belief(beliefs, ("ann",)), kind) == {element: values[1]}
