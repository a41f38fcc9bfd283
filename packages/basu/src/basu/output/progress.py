"""Progress bars: `ProgressBar` for one run with its distance and score, `drives_bar` for commands with many drives."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any

from tqdm import tqdm

from basu.managers.base_manager import BaseManager

if TYPE_CHECKING:
    from basu.managers import Live
    from basu.managers.base_manager import Frame, Run

UPDATE_TICKS = 20  # a second of simulated time
SCORE_TICKS = 2000  # scoring anew costs some ms
QUIET_S = 10.0  # between two lines without a terminal (a log file)


def drives_bar(total: int, unit: str, *, initial: int = 0, quiet: bool = False) -> Any:  # noqa: ANN401 - tqdm's
    """Return the bar of a command with many drives: how many are done, and the time left; it is a context manager.

    Without a terminal a line is printed every ten seconds, and none for a shorter command.
    """
    is_seen = sys.stderr.isatty()
    return tqdm(
        total=total,
        initial=initial,
        unit=unit,
        disable=quiet,
        file=sys.stderr,
        mininterval=0.1 if is_seen else QUIET_S,
        delay=0.0 if is_seen else QUIET_S,
    )


class ProgressBar(BaseManager):
    """Kilometres of the route, simulated against wall time, and the driving score so far."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self._score = "score so far -"
        self._bar: Any = None  # tqdm is generic to the type checker only

    def setup(self, run: Run) -> None:
        """Draw the bar."""
        self._step_s = run.step_s
        self._bar = tqdm(
            total=round(run.route.length_m / 1000.0, 3),
            unit="km",
            bar_format="{desc}|{bar:30}| {n:.2f}/{total:.2f} km [{elapsed}<{remaining}{postfix}]",
            mininterval=0.1 if sys.stderr.isatty() else QUIET_S,
            desc="driving ",
        )
        self._began_s = time.perf_counter()

    def tick(self, frame: Frame) -> None:
        """Move the progress bar by one frame."""
        if frame.tick % UPDATE_TICKS or self._bar is None:
            return
        if frame.tick and frame.tick % SCORE_TICKS == 0:
            self._score = f"score so far {self._live.metrics.scores_so_far().driving:.3f}"
        self._show(frame.tick)

    def close(self) -> None:
        """Bring way and score up to the last tick, and leave the bar so."""
        if self._bar is None:
            return
        ticks = self._live.metrics.ticks
        if ticks:
            self._score = f"score {self._live.metrics.scores_so_far().driving:.3f}"
            self._show(ticks)
        self._bar.close()
        self._bar = None

    def _show(self, ticks: int) -> None:
        """Bring the bar to where the vehicle is."""
        faster = ticks * self._step_s / max(1e-6, time.perf_counter() - self._began_s)
        self._bar.set_postfix_str(f"{self._score}, {faster:.0f}x real time", refresh=False)
        self._bar.update(self._live.routes.progress.s_m / 1000.0 - self._bar.n)
