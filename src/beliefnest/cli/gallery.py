"""Pictures of the cells of a run, each drawn in a thread while the next cell is played."""

from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from beliefnest.cli.folder import ConditionFolder
from beliefnest.files import replace_file
from beliefnest.pictures.overview import ConditionPicture, overview


class Gallery:
    """Pictures of the cells that were played.

    Attributes:
        pictures: The pictures, in the order of play.
    """

    def __init__(self) -> None:
        self.pictures: list[ConditionPicture] = []
        self._thread = ThreadPoolExecutor(1)
        self._last: Future[None] | None = None

    def add(
        self, picture: ConditionPicture, place: ConditionFolder, result: Mapping[str, Any]
    ) -> None:
        """Begin to draw the picture of a cell; its result is written when the picture is there.

        Raises:
            InputError: The picture before it could not be written.
        """
        self._wait()
        self.pictures.append(picture)
        self._last = self._thread.submit(_draw, picture, place, result)

    def close(self) -> None:
        """Wait for the last picture, and raise its error."""
        self._thread.shutdown()
        self._wait()

    def _wait(self) -> None:
        if self._last is not None:
            self._last.result()


def _draw(picture: ConditionPicture, place: ConditionFolder, result: Mapping[str, Any]) -> None:
    figure = overview([picture], picture.title)
    figure.save(place.picture)
    replace_file(place.picture_svg, figure._repr_html_())
    # A cell with a result is not played again.
    place.write_result(result)
