"""The window that is drawn on: pygame behind a handful of words, so that what is drawn can be read without it."""

from __future__ import annotations

import contextlib
import io
from typing import TYPE_CHECKING, Any

import numpy as np

from basu_window.manual.devices import import_pygame

if TYPE_CHECKING:
    from collections.abc import Iterator

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
        """Give what is drawn inside smooth edges: it is drawn twice as large, and made smaller at the end."""
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

    def picture(self, bgra: bytes, size: tuple[int, int], left: float | None = None) -> None:
        """A camera's picture over the whole window, or as large as fits in the middle of what is right of ``left``."""
        image = self._pygame.image.frombuffer(bgra, size, "BGRA")
        free = self.size[0] - (left or 0.0), self.size[1]
        scale = min(free[0] / size[0], free[1] / size[1])
        wanted = self.size if left is None else (round(scale * size[0]), round(scale * size[1]))
        if size != wanted:
            image = self._pygame.transform.smoothscale(image, wanted)
        image = image.convert(24)  # a picture without alpha, whatever the server writes into the fourth byte
        self._surface.blit(image, ((left or 0.0) + (free[0] - wanted[0]) / 2, (free[1] - wanted[1]) / 2))

    def points(self, places: NDArray[np.float64], colours: NDArray[np.uint8], left: float) -> None:
        """Dots of two by two pixels at (N, 2) places right of ``left``, in (N, 3) colours."""
        pixels = self._pygame.surfarray.pixels3d(self._surface)  # a view: (width, height, 3)
        column, row = np.floor(places).astype(np.int64).T
        inside = (column >= left) & (column < self.size[0] - 1) & (row >= 0) & (row < self.size[1] - 1)
        column, row, colours = column[inside], row[inside], colours[inside]
        for right, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
            pixels[column + right, row + down] = colours

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

    def circle(self, at: tuple[float, float], radius: float, colour: Colour, *, border: int = 0) -> None:
        """Filled, or a ring of ``border`` pixels."""
        centre = self._zoom * at[0], self._zoom * at[1]
        self._pygame.draw.circle(self._surface, colour, centre, self._zoom * radius, border)

    def show(self) -> None:
        """Bring what was drawn before eyes."""
        self._pygame.display.flip()

    def png(self) -> bytes:
        """Return what is drawn, as a file's content."""
        buffer = io.BytesIO()
        self._pygame.image.save(self._surface, buffer, "hud.png")
        return buffer.getvalue()

    def close(self) -> None:
        """Take the window away."""
        self._pygame.display.quit()
