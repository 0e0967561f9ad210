"""BeliefNest: nested belief simulators for embodied agents with a Theory of Mind.

`__all__` lists the public surface. Each name is imported on first use, so that `import
beliefnest` is fast.
"""

import importlib
from typing import TYPE_CHECKING

from beliefnest.version import VERSION

if TYPE_CHECKING:  # Each name is imported when it is first used.
    from beliefnest.belief.grounds import InitialBelief
    from beliefnest.episodes.agent_view import GO_ON, AgentView
    from beliefnest.episodes.episode import Episode
    from beliefnest.episodes.record import Budget
    from beliefnest.episodes.task import Task
    from beliefnest.errors import (
        BeliefNestError,
        BodyError,
        BranchError,
        ForkedError,
        InputError,
        ModelError,
        PathError,
        PositionError,
        ProgramError,
        ScenarioError,
        StoreError,
        TemplateError,
        TickError,
        TooLargeError,
        UnknownNameError,
        WorkerError,
        WorldError,
    )
    from beliefnest.minds.imagining.histories import History, Imagined
    from beliefnest.minds.imagining.imagining import ImaginationWarning
    from beliefnest.minds.inference import Inference
    from beliefnest.minds.mind_model import MindModel, simplex_grid
    from beliefnest.nest.explain.comparison import Difference, Pose
    from beliefnest.nest.explain.explanation import Explanation
    from beliefnest.nest.explain.parts import Contents
    from beliefnest.nest.face.exploration import Attempt
    from beliefnest.nest.face.nest import Nest
    from beliefnest.nest.face.simulator import Simulator
    from beliefnest.perception.options import Perception, Radius
    from beliefnest.scenarios.scenario import Scenario
    from beliefnest.studies.result import StudyResult
    from beliefnest.studies.study import Study
    from beliefnest.world.claims import Claim, ClaimKind
    from beliefnest.worlds.process_limits import ProcessLimits
    from beliefnest.worlds.protocol import ProgramResult
    from beliefnest.worlds.scripted.world import ScriptedWorld

__version__ = VERSION

__all__ = [
    "GO_ON",
    "AgentView",
    "Attempt",
    "BeliefNestError",
    "BodyError",
    "BranchError",
    "Budget",
    "Claim",
    "ClaimKind",
    "Contents",
    "Difference",
    "Episode",
    "Explanation",
    "ForkedError",
    "History",
    "ImaginationWarning",
    "Imagined",
    "Inference",
    "InitialBelief",
    "InputError",
    "MindModel",
    "ModelError",
    "Nest",
    "PathError",
    "Perception",
    "Pose",
    "PositionError",
    "ProcessLimits",
    "ProgramError",
    "ProgramResult",
    "Radius",
    "Scenario",
    "ScenarioError",
    "ScriptedWorld",
    "Simulator",
    "StoreError",
    "Study",
    "StudyResult",
    "Task",
    "TemplateError",
    "TickError",
    "TooLargeError",
    "UnknownNameError",
    "WorkerError",
    "WorldError",
    "__version__",
    "simplex_grid",
]

_HOMES = {
    "GO_ON": "beliefnest.episodes.agent_view",
    "AgentView": "beliefnest.episodes.agent_view",
    "Attempt": "beliefnest.nest.face.exploration",
    "Budget": "beliefnest.episodes.record",
    "Claim": "beliefnest.world.claims",
    "ClaimKind": "beliefnest.world.claims",
    "Contents": "beliefnest.nest.explain.parts",
    "Difference": "beliefnest.nest.explain.comparison",
    "Episode": "beliefnest.episodes.episode",
    "Explanation": "beliefnest.nest.explain.explanation",
    "History": "beliefnest.minds.imagining.histories",
    "ImaginationWarning": "beliefnest.minds.imagining.imagining",
    "Imagined": "beliefnest.minds.imagining.histories",
    "Inference": "beliefnest.minds.inference",
    "InitialBelief": "beliefnest.belief.grounds",
    "MindModel": "beliefnest.minds.mind_model",
    "Nest": "beliefnest.nest.face.nest",
    "Perception": "beliefnest.perception.options",
    "Pose": "beliefnest.nest.explain.comparison",
    "ProcessLimits": "beliefnest.worlds.process_limits",
    "ProgramResult": "beliefnest.worlds.protocol",
    "Radius": "beliefnest.perception.options",
    "Scenario": "beliefnest.scenarios.scenario",
    "ScriptedWorld": "beliefnest.worlds.scripted.world",
    "Simulator": "beliefnest.nest.face.simulator",
    "Study": "beliefnest.studies.study",
    "StudyResult": "beliefnest.studies.result",
    "Task": "beliefnest.episodes.task",
    "simplex_grid": "beliefnest.minds.mind_model",
}


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"beliefnest has no {name!r}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(_HOMES.get(name, "beliefnest.errors")), name)


def __dir__() -> list[str]:
    return __all__
