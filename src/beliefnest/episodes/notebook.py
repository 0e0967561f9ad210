"""Page of a nest inside a notebook of Jupyter."""

import html
from dataclasses import dataclass
from functools import cached_property

from beliefnest.episodes.record import Keeps
from beliefnest.episodes.telling import told_episode
from beliefnest.minds.inference import Inference
from beliefnest.nest.face.reader import Reader
from beliefnest.viewer.page.posteriors import told_inference
from beliefnest.viewer.page.run import About
from beliefnest.viewer.page.static import still_page

# Notebooks remove frames of untrusted content; only this text then remains.
_UNTRUSTED = "The page is shown once this notebook is trusted: File, Trust Notebook."


@dataclass(frozen=True)
class PageView:
    """Page of a nest at the time of its first display, in a frame of its own.

    Attributes:
        reader: Reader of the nest.
        run: The nest, which keeps the rounds of its episode if it has one.
        depth: Depth of the beliefs that are included.
        height: Height of the frame in pixels.
        inference: Posterior that is shown with the nest; None: there is none.
        steps: Number of actions after which the posterior predicts places.
    """

    reader: Reader
    run: Keeps
    depth: int
    height: int
    inference: Inference | None = None
    steps: int = 5

    @cached_property
    def page(self) -> str:
        """Text of the page.

        Raises:
            InputError: The depth is not from 0 to 4, or the page was not built with the package.
        """
        setting = self.reader.setting
        inferences = [] if self.inference is None else [told_inference(self.inference, self.steps)]
        about = About(
            self._title,
            labels=setting.labels,
            episode=lambda: told_episode(self.run),
            inferences=lambda: inferences,
        )
        # Predictions are drawn on the plan.
        first = {"view": "plan"} if inferences else None
        return still_page([(self.reader, about)], self.depth, first)

    @property
    def _title(self) -> str:
        return self.reader.setting.name

    def __repr__(self) -> str:
        return f"<page of {self._title!r}, beliefs to depth {self.depth}; a notebook shows it>"

    def _repr_html_(self) -> str:
        # The frame has no origin, so that its content cannot access the notebook.
        return (
            f'<iframe sandbox="allow-scripts allow-popups" title="{html.escape(self._title)}" '
            f'srcdoc="{html.escape(self.page)}" style="width: 100%; height: {self.height}px; '
            f'box-sizing: border-box; border: 1px solid #ddd">{_UNTRUSTED}</iframe>'
        )
