"""Options of environments, and their checks."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Literal

import msgspec

from beliefnest.env.bounds import Phrases
from beliefnest.errors import InputError, PathError
from beliefnest.facts.reading import ClaimLike, as_claims
from beliefnest.nest.face.nest import Nest
from beliefnest.timeline.run_records import Senses
from beliefnest.world.claims import Claim
from beliefnest.world.paths import parse_path, path_text, paths_below
from beliefnest.world.seeds import checked_seed
from beliefnest.world.texts import fault_of
from beliefnest.world.values import Position
from beliefnest.worlds.names import check_world

RENDER_MODES = ("human", "rgb_array")


class EnvironmentOptions(msgspec.Struct, frozen=True):
    """Options of an environment; the arguments of `parallel_env`, with the same names."""

    world: str = "scripted"
    actions: Literal["skills", "programs", "flat"] = "skills"
    observations: Literal["arrays", "dict"] = "arrays"
    agents: tuple[str, ...] | None = None
    nested: int | tuple[str, ...] = ()
    phrases: Mapping[str, Sequence[ClaimLike]] | Sequence[str] = ()
    items: tuple[str, ...] = ()
    cells: tuple[Position, ...] = ()
    sizes: Mapping[str, int] = msgspec.field(default_factory=dict)
    reward: Callable[[Nest, str], float] | None = None
    ends: Callable[[Nest], bool] | None = None
    max_steps: int | None = None
    step_ticks: int | None = None
    timeout_ticks: int | None = None
    plays_script: bool = False
    senses: Senses | None = None
    render_mode: Literal["rgb_array", "human"] | None = None
    render_path: str = "/"
    seed: int = 0

    def __post_init__(self) -> None:
        check_world(self.world, servers=False)
        if self.senses not in (None, "world", "percepts"):
            raise InputError(f"senses is {self.senses!r}; it is 'world' or 'percepts'")
        if self.actions not in ("skills", "programs", "flat"):
            raise InputError(f"actions is {self.actions!r}; it is 'skills', 'programs' or 'flat'")
        if self.observations not in ("arrays", "dict"):
            raise InputError(f"observations is {self.observations!r}; it is 'arrays' or 'dict'")
        if self.render_mode not in (None, *RENDER_MODES):
            raise InputError(
                f"render_mode is {self.render_mode!r}; it is {' or '.join(RENDER_MODES)}, or None"
            )
        env_seed(self.seed)
        if self.cells and self.actions != "flat":
            raise InputError("cells are numbers of actions='flat' alone; other actions name places")
        if isinstance(self.nested, int) and (isinstance(self.nested, bool) or self.nested < 0):
            raise InputError(f"nested is {self.nested!r}; give paths, or a depth from 0 on")
        self._check_phrases()
        if self.agents is not None and len(set(self.agents)) < len(self.agents):
            raise InputError(f"agents is {list(self.agents)}; name each agent once")
        counts = ("max_steps", "step_ticks", "timeout_ticks")
        for name in counts:
            number = getattr(self, name)
            if number is not None and (type(number) is not int or number < 1):
                raise InputError(f"{name} is {number!r}; give a whole number from 1 on, or None")
        for name, function in (("reward", self.reward), ("ends", self.ends)):
            if function is not None and not callable(function):
                raise InputError(f"{name} is {function!r}; give a function, or None")

    def _check_phrases(self) -> None:
        is_mapping = isinstance(self.phrases, Mapping)
        phrases = texts("phrases", list(self.phrases) if is_mapping else self.phrases)
        if len(set(phrases)) < len(phrases):
            raise InputError(f"phrases is {list(phrases)!r:.100}; name each phrase once")
        if faults := list(filter(None, map(fault_of, phrases))):
            raise InputError(f"phrases has {faults[0]}")
        for phrase, claims in self.said.items():
            is_list = isinstance(claims, list | tuple)
            if not is_list or not all(isinstance(each, Claim) for each in claims):
                raise InputError(
                    f"phrases[{phrase!r}] is {claims!r:.100}; give a list of claims, each as "
                    "bn.Claim or as a fact"
                )

    def check_scenario(self) -> None:
        """Check options that only tasks can have.

        Raises:
            InputError: Steps with a fixed number of ticks are not possible.
        """
        if self.step_ticks and (self.actions == "programs" or self.world != "scripted"):
            raise InputError(
                "step_ticks is for tasks, and for calls of skills in the scripted world; elsewhere "
                "a step ends with the last program: leave it out"
            )

    def check_task(self) -> None:
        """Check that no option is given that tasks do not have.

        Raises:
            InputError: An option has no effect in tasks.
        """
        if self.senses == "world" or self.timeout_ticks is not None or self.plays_script:
            raise InputError(
                "a task is played with the knowledge of each agent, in rounds of step_ticks, after "
                "its script: leave senses and timeout_ticks out, and plays_script"
            )

    @property
    def said(self) -> Phrases:
        """Utterances with their claims."""
        if not isinstance(self.phrases, Mapping):
            return dict.fromkeys(self.phrases, ())
        return {phrase: as_claims(claims) for phrase, claims in self.phrases.items()}


def texts(name: str, values: object) -> tuple[str, ...]:
    """Return the texts that an argument lists; raise InputError for a text alone and for others."""
    listed = None if isinstance(values, str) or not isinstance(values, Iterable) else tuple(values)
    if listed is None or not all(isinstance(each, str) for each in listed):
        raise InputError(f"{name} is {values!r:.100}; give a list of texts")
    return listed


def env_seed(seed: object) -> int:
    """Return a seed as Gymnasium has them; raise InputError for others."""
    try:
        number = -1 if isinstance(seed, bool) else checked_seed(seed)
    except InputError:
        number = -1
    if number < 0:
        raise InputError(
            f"seed is {seed!r:.50}; environments take whole numbers from 0 to 2**63 - 1"
        )
    return number


def nested_paths(
    nested: int | Sequence[str], acting: Sequence[str], agents: Sequence[str]
) -> tuple[tuple[str, ...], ...]:
    """Return the paths of the beliefs for the infos, the deepest first."""
    if isinstance(nested, int):
        chosen = {
            path
            for agent in acting
            for path in paths_below((agent,), max(0, nested - 1), agents)[1:]
        }
    else:
        chosen = {parse_path(path, agents) for path in nested}
        for path in chosen:
            if len(path) < 2 or path[0] not in acting:
                raise PathError(
                    f"{path_text(path)!r} is not a belief of an acting agent about another's; "
                    f"name one such as /{acting[0]}/{agents[-1]}"
                )
    return tuple(sorted(chosen, key=lambda path: (-len(path), path)))
