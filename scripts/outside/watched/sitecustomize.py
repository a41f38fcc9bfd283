"""Looks over an outside program's shoulder: keeps pictures of its pygame window, and presses keys in it.

Python imports a module of this name when it starts, if its folder is on PYTHONPATH; the program is not touched.
``OUTSIDE_PICTURES`` is the folder of the pictures; ``OUTSIDE_KEYS`` the keys, as ``p n n shift+c``; ``OUTSIDE_PACE_S``
the seconds from one picture, and the key after it, to the next. A window counts from the first time that it is shown.
"""

import os
import time

try:
    import pygame
except ImportError:  # no window then
    pygame = None

MODIFIERS = {"shift": "KMOD_SHIFT", "ctrl": "KMOD_CTRL"}
MOST_PICTURES = 60


class Watch:
    """What is done after each time the window is shown, in the program's own thread."""

    def __init__(self, folder: str, keys: list[str], pace_s: float) -> None:
        self.folder, self.keys, self.pace_s = folder, keys, pace_s
        self.next_s: float | None = None
        self.taken = 0
        self.pressed = ""

    def look(self) -> None:
        """Take the picture that is due, named after the key before it, and press the next."""
        now_s = time.monotonic()
        if self.next_s is None:
            self.next_s = now_s + self.pace_s
        surface = pygame.display.get_surface()
        if now_s < self.next_s or self.taken >= MOST_PICTURES or surface is None:
            return
        self.next_s = now_s + self.pace_s
        name = f"{self.taken:02d}{self.pressed and '-'}{self.pressed.replace('+', '-')}.jpg"
        pygame.image.save(surface, os.path.join(self.folder, name))  # noqa: PTH118 - as little as can be in their process
        self.taken += 1
        self.pressed = self.keys.pop(0) if self.keys else ""
        if self.pressed:
            _press(self.pressed)


def _press(key: str) -> None:
    """Post what pygame posts for a key that goes down and up, under the modifiers before its name."""
    *modifiers, name = key.split("+")
    held = 0
    for modifier in modifiers:
        held |= getattr(pygame, MODIFIERS[modifier])
    pygame.key.set_mods(held)
    code = pygame.key.key_code(name)
    for kind in (pygame.KEYDOWN, pygame.KEYUP):
        pygame.event.post(pygame.event.Event(kind, key=code, mod=held, unicode="", scancode=0))


def _watch() -> None:
    """Put a look behind both of pygame's ways to show a window."""
    keys = os.environ.get("OUTSIDE_KEYS", "").split()
    watch = Watch(os.environ["OUTSIDE_PICTURES"], keys, float(os.environ.get("OUTSIDE_PACE_S", "3")))

    def watched(show):  # noqa: ANN001, ANN202 - pygame's own function, whatever it takes
        def shown(*args, **kwargs):  # noqa: ANN002, ANN003, ANN202
            show(*args, **kwargs)
            watch.look()

        return shown

    pygame.display.flip = watched(pygame.display.flip)
    pygame.display.update = watched(pygame.display.update)


if pygame is not None and "OUTSIDE_PICTURES" in os.environ:
    _watch()
