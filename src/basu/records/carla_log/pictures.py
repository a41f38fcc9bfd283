"""What a metric draws with matplotlib: kept as files where that is asked for, shown where there is a screen."""

from __future__ import annotations

import os
import platform
import warnings
from pathlib import Path

import matplotlib as mpl

from basu.errors import UserError


def off_screen(plot: Path | None) -> None:
    """Draw without a window where pictures are to be kept, or where there is no screen to show them on."""
    if plot is not None and not plot.parent.is_dir():
        raise UserError(f"--plot {plot}: there is no folder {plot.parent}; make it, or name another place")
    if plot is not None or not _screen():
        mpl.use("Agg")
        warnings.filterwarnings("ignore", message=".*is non-interactive, and thus cannot be shown")


def drawn(plot: Path | None) -> list[str]:
    """Keep the figures that are open, and say what became of them, a line each.

    Raises:
        UserError: a picture cannot be written.
    """
    import matplotlib.pyplot as plt  # noqa: PLC0415 - after the backend is chosen

    numbers = plt.get_fignums()
    try:
        if plot is not None:
            return _kept(plot, numbers)
        if not numbers or _screen():
            return []
        several = f"{len(numbers)} figures" if len(numbers) > 1 else "a figure"
        return [f"drew {several}; --plot FILE.png keeps what is drawn"]
    finally:
        plt.close("all")


def _kept(plot: Path, numbers: list[int]) -> list[str]:
    """Write each figure to its file."""
    import matplotlib.pyplot as plt  # noqa: PLC0415 - likewise

    if not numbers:
        raise UserError(f"the metric drew nothing, so there is no {plot}")
    lines = []
    for count, number in enumerate(numbers, start=1):
        path = plot if count == 1 else plot.with_stem(f"{plot.stem}-{count}")
        try:
            plt.figure(number).savefig(path, dpi=150)
        except (OSError, ValueError) as error:
            raise UserError(f"{path} could not be written: {error}") from error
        lines.append(f"plot              {path}")
    return lines


def _screen() -> bool:
    """Whether there is a screen that a window could be on."""
    if platform.system() == "Linux":
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True
