"""Where a nest's simulators stand in Minecraft, for people who visit them."""

from dataclasses import dataclass

from beliefnest.errors import InputError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.face.base import NestBase
from beliefnest.nest.face.turns import in_turn
from beliefnest.world.paths import path_text
from beliefnest.world.values import Position

__all__ = ["Layout", "Standing", "Visiting"]


@dataclass(frozen=True, slots=True)
class Standing:
    """Where one simulator stands.

    Attributes:
        path: Its belief path; `/` is the real world.
        low: The lowest corner of its box, in blocks of Minecraft.
        high: The highest one.
        origin: Where scenario (0, y, 0) lies: x and z, in blocks of Minecraft.
        command: What to type in the game to go to it.
        lag: Ticks by which what changed was shown later than it happened, at most so far;
            those between two calls of the nest count.
    """

    path: str
    low: Position
    high: Position
    origin: tuple[int, int]
    command: str
    lag: int = 0


class Layout(tuple[Standing, ...]):
    """Where all simulators stand that do; as a text, one line for each."""

    __slots__ = ()

    def __repr__(self) -> str:
        width = max(len(each.path) for each in self)
        return "\n".join(
            f"{each.path:{width}}  {_corner(each.low)} to {_corner(each.high)}  {each.command}"
            for each in self
        )


class Visiting(NestBase):
    """What a nest offers those who visit beliefs; a part of `Nest`."""

    _engine: Engine

    @in_turn
    def layout(self) -> Layout:
        """Where the real world and all that `Simulator.embody` embodied stand in Minecraft.

        Raises:
            InputError: The real world is not in real time, so that nobody can go to it.
        """
        plots = self._engine.embodying.plots()
        if not plots:
            raise InputError(
                "nothing stands where people could go: this world's time does not go on by itself"
            )
        lags = self._engine.embodying.lags()
        return Layout(
            Standing(
                path_text(path),
                *plot.corners,
                plot.origin,
                "/tp {} {} {}".format(*plot.stand),
                lags.get(path, 0),
            )
            for path, plot in plots.items()
        )


def _corner(position: Position) -> str:
    return "{} {} {}".format(*position)
