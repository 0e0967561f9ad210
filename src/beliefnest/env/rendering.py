"""Pictures of one size and lines for a terminal, for people who watch an environment."""

import numpy as np
import numpy.typing as npt
from PIL import Image

from beliefnest.nest.face.nest import Nest
from beliefnest.nest.past.shown_words import state_words
from beliefnest.pictures.palette import PAPER

FRAME = (688, 512)
"""Width and height of pictures in pixels."""
_DPI = 100


def picture(nest: Nest, path: str) -> npt.NDArray[np.uint8]:
    """Return the drawing of a simulator as an array (height, width, 3); see `FRAME`.

    A belief is drawn as its holder has it: nothing tells where it is wrong.
    """
    width, height = (pixels / _DPI * 25.4 for pixels in FRAME)
    drawn = nest[path].figure(against=path).image((width, height), _DPI)
    whole = Image.new("RGB", FRAME, PAPER)
    whole.paste(drawn, (0, 0))
    return np.array(whole)


def line(nest: Nest, path: str) -> str:
    """Return one line about a simulator."""
    state = nest[path].state
    return f"{path}, tick {state.tick}: {state_words(state)}"
