"""Pictures of the cells of a run, each drawn in a thread while the next cell is played."""

from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any

from beliefnest.cli.folder import ConditionFolder
from beliefnest.files import replace_file
from beliefnest.pictures.overview import ConditionPicture, overview
from beliefnest.studies.study_folder import StudyFolder


class Gallery:
    """Pictures of the cells that were played.

    Attributes:
        pictures: The pictures, in the order of play.
    """

    def __init__(self) -> None:
        self.pictures: list[ConditionPicture] = []
        self._thread = ThreadPoolExecutor(1)
        self._last: Future[None] | None = None

    def add(self, picture: ConditionPicture, place: ConditionFolder) -> None:
        """Begin to draw the picture of a cell.

        Raises:
            InputError: The picture before it could not be written.
        """
        self._wait()
        self.pictures.append(picture)
        self.then(partial(_draw, picture, place))

    def then(self, write: Callable[[], None]) -> None:
        """Write something when the last picture is there; nothing if it cannot be drawn."""
        last = self._last

        def after() -> None:
            if last is not None:
                last.result()
            write()

        self._last = self._thread.submit(after)

    def close(self) -> None:
        """Wait for the last picture, and raise its error."""
        self._thread.shutdown()
        self._wait()

    def _wait(self) -> None:
        if self._last is not None:
            self._last.result()


class RunResults(StudyFolder, frozen=True):
    """Results of a run. A cell with a result is not played again, so that its picture is first.

    Attributes:
        gallery: Pictures of the run.
    """

    gallery: Gallery

    def write_cell(self, name: str, content: Mapping[str, Any]) -> None:
        """Write the file of a cell when its picture is there."""
        self.gallery.then(partial(StudyFolder.write_cell, self, name, content))


def _draw(picture: ConditionPicture, place: ConditionFolder) -> None:
    figure = overview([picture], picture.title)
    figure.save(place.picture)
    replace_file(place.picture_svg, figure._repr_html_())
