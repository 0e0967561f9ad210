"""Places of a nest's simulators in Minecraft, for people who visit them."""

import msgspec

from beliefnest.world.values import Position


class Standing(msgspec.Struct, frozen=True):
    """Place of one simulator in Minecraft.

    Attributes:
        path: Belief path; `/` is the real world.
        low: Lowest corner of its box, in Minecraft's coordinates.
        high: Highest corner of its box, in Minecraft's coordinates.
        origin: Minecraft's x and z of the scenario position (0, y, 0).
        command: Command to type in the game to go there.
        lag: Greatest delay so far, in ticks, with which a change was shown. Ticks between two calls
            of the nest count.
    """

    path: str
    low: Position
    high: Position
    origin: tuple[int, int]
    command: str
    lag: int = 0


class Layout(tuple[Standing, ...]):
    """Places of all simulators that stand in Minecraft; as a text, one line for each."""

    __slots__ = ()

    def __repr__(self) -> str:
        width = max(len(each.path) for each in self)
        return "\n".join(
            f"{each.path:{width}}  {_corner(each.low)} to {_corner(each.high)}  {each.command}"
            for each in self
        )


def _corner(position: Position) -> str:
    return "{} {} {}".format(*position)
