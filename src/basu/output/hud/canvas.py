"""The window that is drawn on: pygame behind a handful of words, so that what is drawn can be read without it."""

from __future__ import annotations

import contextlib
import io
from typing import TYPE_CHECKING, Any

from basu.agents.manual.devices import import_pygame

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

Colour = tuple[int, int, int]
Box = tuple[float, float, float, float]  # left, top, width, height in pixels
WHITE, GREY, BLACK = (245, 245, 245), (150, 154, 160), (0, 0, 0)
GREEN, YELLOW, RED, BLUE = (96, 200, 120), (240, 190, 60), (235, 80, 70), (80, 150, 230)
TEXT = 17  # of pygame's own font, about 12 pixels high


class Canvas:
    """A window of ``size`` pixels; nothing is seen before ``show``."""

    def __init__(self, size: tuple[int, int], title: str) -> None:
        self._pygame = pygame = import_pygame()
        pygame.display.init()
        pygame.font.init()
        pygame.display.set_caption(title)
        self._surface: Any = pygame.display.set_mode(size)
        self._fonts: dict[int, Any] = {}
        self._zoom = 1  # drawn pixels a pixel of the window
        self.size = size

    @contextlib.contextmanager
    def smoothly(self) -> Iterator[None]:
        """What is drawn in here has smooth edges: it is drawn twice as large, and made smaller at the end."""
        window, self._zoom = self._surface, 2
        self._surface = self._pygame.Surface((2 * self.size[0], 2 * self.size[1]))
        try:
            yield
            window.blit(self._pygame.transform.smoothscale(self._surface, self.size), (0, 0))
        finally:
            self._surface, self._zoom = window, 1

    def fill(self, colour: Colour) -> None:
        """Paint everything over."""
        self._surface.fill(colour)

    def picture(self, bgra: bytes, size: tuple[int, int]) -> None:
        """A camera's picture over the whole window."""
        image = self._pygame.image.frombuffer(bgra, size, "BGRA")
        if size != self.size:
            image = self._pygame.transform.smoothscale(image, self.size)
        image = image.convert(24)  # a picture without alpha, whatever the server writes into the fourth byte
        self._surface.blit(image, (0, 0))

    def shade(self, box: Box, strength: float) -> None:
        """Darken a part of what is there; 1 is black."""
        sheet = self._pygame.Surface((box[2], box[3]))
        sheet.set_alpha(round(255 * strength))
        self._surface.blit(sheet, (box[0], box[1]))

    def text(
        self, at: tuple[float, float], text: str, colour: Colour = WHITE, *, size: int = TEXT, align: float = 0.0
    ) -> None:
        """A line of text; ``align`` of its width lies left of ``at``."""
        size *= self._zoom
        if size not in self._fonts:
            self._fonts[size] = self._pygame.font.Font(None, size)
        line = self._fonts[size].render(text, True, colour)
        self._surface.blit(line, (self._zoom * at[0] - align * line.get_width(), self._zoom * at[1]))

    def rectangle(self, box: Box, colour: Colour, *, border: int = 0, rounded: int = 0) -> None:
        """Filled, or a frame of ``border`` pixels."""
        self._pygame.draw.rect(self._surface, colour, box, border, border_radius=rounded)

    def polygon(self, points: NDArray[np.float64], colour: Colour) -> None:
        """Filled; (N, 2) in pixels."""
        self._pygame.draw.polygon(self._surface, colour, (self._zoom * points).tolist())

    def line(self, points: NDArray[np.float64], colour: Colour, width: float = 1.0) -> None:
        """Through (N, 2) points."""
        if len(points) > 1:
            thick = max(1, round(self._zoom * width))
            self._pygame.draw.lines(self._surface, colour, False, (self._zoom * points).tolist(), thick)

    def circle(self, at: tuple[float, float], radius: float, colour: Colour) -> None:
        """Filled."""
        centre = self._zoom * at[0], self._zoom * at[1]
        self._pygame.draw.circle(self._surface, colour, centre, self._zoom * radius)

    def show(self) -> None:
        """Bring what was drawn before eyes."""
        self._pygame.display.flip()

    def png(self) -> bytes:
        """What is drawn, as a file's content."""
        buffer = io.BytesIO()
        self._pygame.image.save(self._surface, buffer, "hud.png")
        return buffer.getvalue()

    def close(self) -> None:
        """Take the window away."""
        self._pygame.display.quit()
