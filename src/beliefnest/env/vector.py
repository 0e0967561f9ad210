"""Copies of an environment as a vector environment of Gymnasium, in one process or in several."""

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from typing import Any

import gymnasium
import msgspec
import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array, iterate

from beliefnest.env.environment import BeliefEnv
from beliefnest.env.options import env_seed
from beliefnest.env.saving import check_no_options
from beliefnest.env.spaces import BeliefSpace
from beliefnest.errors import BeliefNestError, InputError, WorkerError
from beliefnest.world.words import counted

_Flags = npt.NDArray[np.bool_]
_PATIENCE_S = 30.0
"""Seconds that processes have to close their worlds."""


class RowStep(msgspec.Struct, frozen=True):
    """Joint step of one agent of a copy.

    Attributes:
        observation: Its observation.
        info: Its info.
        reward: Its reward; 0 at the beginning of an episode.
        is_ended: True if the episode was terminated.
        is_cut: True if the episode was truncated.
    """

    observation: Any
    info: dict[str, Any]
    reward: float = 0.0
    is_ended: bool = False
    is_cut: bool = False

    @property
    def is_over(self) -> bool:
        """True if the episode of its copy is over."""
        return self.is_ended or self.is_cut


_Row = tuple[int, str]
"""Copy and agent of a row."""
_Jobs = Mapping[int, int | Mapping[str, Any]]
"""Seed of the episode to begin, or the actions of agents, by copy."""


class CopiesShare(gymnasium.Env[Any, Any]):
    """Copies of an environment that one process steps.

    It is an environment of Gymnasium only in that `AsyncVectorEnv` keeps it in a process.

    Args:
        make: Function that returns a new environment.
        copies: Numbers of the copies.
    """

    observation_space = action_space = spaces.Discrete(1)

    def __init__(self, make: Callable[[], BeliefEnv], copies: Sequence[int]) -> None:
        self._make, self._copies = make, copies
        self.envs: dict[int, BeliefEnv] = {}

    def advance(self, jobs: _Jobs) -> dict[_Row, RowStep]:
        """Begin episodes, and step those that go on."""
        steps: dict[_Row, RowStep] = {}
        for number in self._copies:
            if number in jobs:
                steps |= self._advanced(number, jobs[number])
        return steps

    def pictures(self) -> dict[int, Any]:
        """Return the picture of each copy, as their mode says."""
        return {number: self._env(number).render() for number in self._copies}

    def answer(self, name: str, *arguments: Any) -> Any:
        """Return what a method returns, or an error that is not one of this process."""
        try:
            return getattr(self, name)(*arguments)
        except BeliefNestError as error:
            return error

    def close(self) -> None:
        """Close all copies."""
        for env in self.envs.values():
            env.close()

    def _env(self, number: int) -> BeliefEnv:
        if number not in self.envs:
            self.envs[number] = self._make()
        return self.envs[number]

    def _advanced(self, number: int, job: int | Mapping[str, Any]) -> dict[_Row, RowStep]:
        env = self._env(number)
        if isinstance(job, int):
            observations, infos = env.reset(job)
            return {(number, one): RowStep(observations[one], infos[one]) for one in observations}
        observations, rewards, ended, cut, infos = env.step(job)
        return {
            (number, one): RowStep(seen, infos[one], rewards[one], ended[one], cut[one])
            for one, seen in observations.items()
        }


class BeliefVectorEnv(VectorEnv[Any, Any, Any]):
    """Copies of an environment that are stepped together; each agent of a copy is a row.

    After the end of a copy's episode its next step begins another one, ignores the actions and
    gives the reward 0 (`AutoresetMode.NEXT_STEP`). Copy i of n plays the seeds s + i, s + i + n,
    s + i + 2n, ..., in however many processes.

    Args:
        make: Function that returns a new environment.
        copies: Number of copies.
        processes: Number of processes that step them; 1: this one alone.

    Attributes:
        rows: Copy and agent of each row.

    Raises:
        InputError: There is no copy, or no copy for a process, or the environment has no arrays.
    """

    def __init__(self, make: Callable[[], BeliefEnv], copies: int, processes: int = 1) -> None:
        for name, number in (("copies", copies), ("processes", processes)):
            if isinstance(number, bool) or not isinstance(number, int) or number < 1:
                raise InputError(f"{name} is {number!r}; give a whole number from 1 on")
        if processes > copies:
            raise InputError(f"{processes} processes cannot share {copies} copies; give fewer")
        first = make()
        agents = first.possible_agents
        self.single_observation_space = first.observation_space(agents[0])
        self.single_action_space = first.action_space(agents[0])
        if isinstance(self.single_observation_space, BeliefSpace):
            raise InputError('copies need observations of a fixed size: use observations="arrays"')
        self.rows = [(number, agent) for number in range(copies) for agent in agents]
        self.num_envs = len(self.rows)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.metadata = {**first.metadata, "autoreset_mode": AutoresetMode.NEXT_STEP}
        self.render_mode = first.render_mode
        self._batch: Any = create_empty_array(self.single_observation_space, self.num_envs)
        self._latest: dict[_Row, RowStep] = {}
        self._seeds = [first.first_seed + number for number in range(copies)]
        self._share = CopiesShare(make, range(copies))
        self._workers = _workers(make, copies, processes) if processes > 1 else None

    @property
    def envs(self) -> list[BeliefEnv]:
        """The copies, from the first `reset` on.

        Raises:
            InputError: They are in other processes.
        """
        if self._workers is not None:
            raise InputError("the copies are in other processes; leave out `processes`")
        return list(self._share.envs.values())

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode in each copy.

        Args:
            seed: Seed of the first copy, or one for each; None: the next ones.
            options: `reset_mask`, an array of True for the rows of copies that begin again; the
                others go on.

        Raises:
            InputError: The seeds are not whole numbers of 64 bits, or not one for each copy; an
                option does not exist, or the mask parts the rows of a copy.
            WorkerError: A process has ended.
        """
        others = dict(options or {})
        chosen = self._masked(others.pop("reset_mask", np.ones(self.num_envs, np.bool_)))
        check_no_options(others)
        if seed is not None:
            seeds = self._seeds_from(seed)
            self._seeds = [
                new if number in chosen else old
                for number, (new, old) in enumerate(zip(seeds, self._seeds, strict=True))
            ]
        steps = self._advance({number: self._seeds[number] for number in chosen})
        return self.batch(), self._infos(steps)

    def step(self, actions: Any) -> tuple[Any, npt.NDArray[np.float64], _Flags, _Flags, Any]:
        """Let all agents of all copies act; see PettingZoo's parallel interface.

        Raises:
            InputError: No episode has begun, or an action is not in the space.
            WorkerError: A process has ended.
        """
        steps = self.advance(actions)
        rows = [self._latest[row] for row in self.rows]
        rewards = np.array([each.reward for each in rows], np.float64)
        ended = np.array([each.is_ended for each in rows], np.bool_)
        cut = np.array([each.is_cut for each in rows], np.bool_)
        return self.batch(), rewards, ended, cut, self._infos(steps)

    def advance(self, actions: Any) -> dict[_Row, RowStep]:
        """Do what `step` does; return what the agent of each row was told."""
        if not self._latest:
            raise InputError("no episode has begun; call reset() first")
        chosen: dict[int, dict[str, Any]] = {}
        each_row = list(iterate(self.action_space, actions))
        if len(each_row) != len(self.rows):
            raise InputError(
                f"step got {counted(len(each_row), 'action')}; give {len(self.rows)}, one for each "
                "agent of each copy"
            )
        over = {number for (number, _), each in self._latest.items() if each.is_over}
        for (number, agent), action in zip(self.rows, each_row, strict=True):
            # Checked before a copy is stepped, so that none is ahead of the others.
            if number not in over and not self.single_action_space.contains(action):
                raise InputError(
                    f"{action!r:.100} of {agent} in copy {number} is not in the action space; "
                    "nothing was done"
                )
            chosen.setdefault(number, {})[agent] = action
        return self._advance(
            {each: self._seeds[each] if each in over else chosen[each] for each in chosen}
        )

    def batch(self) -> Any:
        """Return the latest observations of all rows."""
        rows = [self._latest[row].observation for row in self.rows]
        self._batch = concatenate(self.single_observation_space, rows, self._batch)
        return deepcopy(self._batch)

    def action_masks(self) -> npt.NDArray[np.int8]:
        """Return the masks of all rows; see `BeliefEnv.action_masks`.

        Raises:
            InputError: No episode has begun, or actions are not numbers.
        """
        if not self._latest:
            raise InputError("no episode has begun; call reset() first")
        if not isinstance(self.single_action_space, spaces.Discrete):
            raise InputError('only actions by number have masks: use actions="flat"')
        return np.stack([self._latest[row].observation["action_mask"] for row in self.rows])

    def render(self) -> tuple[Any, ...]:
        """Return the picture of its copy for each row, as the mode of the copies says."""
        shown: dict[int, Any] = {}
        for some in self._ask("pictures"):
            shown |= some
        return tuple(shown[number] for number, _ in self.rows)

    def close_extras(self, **kwargs: Any) -> None:
        """Close all copies, and end the processes."""
        self._share.close()
        if self._workers is not None and not self._workers.closed:
            try:
                self._workers.close(timeout=_PATIENCE_S)
            except (EOFError, OSError):  # one has ended already
                _end(self._workers)

    def _ask(self, name: str, *arguments: Any) -> Sequence[Any]:
        """Return what a method of each share returns."""
        if self._workers is None:
            return [getattr(self._share, name)(*arguments)]
        answers: Sequence[Any] | None = None
        try:
            answers = self._workers.call("answer", name, *arguments)
        except (EOFError, OSError) as error:
            raise WorkerError(
                f"a process that steps copies has ended ({type(error).__name__}), so all were "
                "ended; make a new vector environment, with fewer processes if memory is short"
            ) from error
        finally:
            if answers is None:
                _end(self._workers)
        for each in answers:
            if isinstance(each, BeliefNestError):
                raise each
        return answers

    def _advance(self, jobs: _Jobs) -> dict[_Row, RowStep]:
        """Begin and step episodes; later ones of copies that began get the next seeds."""
        steps: dict[_Row, RowStep] = {}
        for some in self._ask("advance", jobs):
            steps |= some
        for number, job in jobs.items():
            if isinstance(job, int):
                self._seeds[number] += len(self._seeds)
        self._latest |= steps
        return steps

    def _infos(self, steps: Mapping[_Row, RowStep]) -> dict[str, Any]:
        """Return the infos of the rows that were told something, as Gymnasium has them."""
        infos: dict[str, Any] = {}
        for number, row in enumerate(self.rows):
            if row in steps:
                infos = self._add_info(infos, steps[row].info, number)
        return infos

    def _masked(self, mask: Any) -> list[int]:
        """Return the copies that a mask of rows names."""
        of_rows = isinstance(mask, np.ndarray) and mask.shape == (self.num_envs,)
        if not of_rows or mask.dtype != np.bool_:
            raise InputError(f"reset_mask is {mask!r}; give an array of {self.num_envs} truths")
        named = {copy for (copy, _), masked in zip(self.rows, mask, strict=True) if masked}
        rest = {copy for (copy, _), masked in zip(self.rows, mask, strict=True) if not masked}
        if named & rest:
            raise InputError("reset_mask parts the agents of a copy, which begin again together")
        if not self._latest and rest:
            raise InputError("reset_mask is for copies that have begun; reset all first")
        return sorted(named)

    def _seeds_from(self, seed: int | Sequence[int]) -> list[int]:
        if isinstance(seed, Sequence):
            if len(seed) != len(self._seeds):
                raise InputError(f"there are {len(seed)} seeds for {len(self._seeds)} copies")
            return [env_seed(each) for each in seed]
        return [env_seed(seed) + number for number in range(len(self._seeds))]


def _workers(make: Callable[[], BeliefEnv], copies: int, processes: int) -> AsyncVectorEnv:
    """Start processes that step copies: process i of n has the copies i, i + n, i + 2n, ...

    They are started as those of studies: anew, and without a second run of the user's script.
    """
    import joblib.externals.loky  # noqa: F401 - gives the context its name

    shares = [
        lambda mine=range(number, copies, processes): CopiesShare(make, mine)
        for number in range(processes)
    ]
    return AsyncVectorEnv(shares, shared_memory=False, context="loky")


def _end(workers: AsyncVectorEnv) -> None:
    """End processes at once, whatever they do."""
    for process in workers.processes:
        process.terminate()
        process.join()
    for pipe in workers.parent_pipes:
        if pipe is not None:
            pipe.close()
    workers.closed = True
