"""The bar that shows how far a run is and how well it goes."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

from tqdm import tqdm
from typing_extensions import Self

if TYPE_CHECKING:
    from types import TracebackType

    from basu.managers.base_manager import Frame
    from basu.managers.metrics_manager import MetricsManager
    from basu.managers.routes_manager import RoutesManager

UPDATE_TICKS = 20  # a second of simulated time
SCORE_TICKS = 2000  # scoring anew costs some ms
QUIET_S = 10.0  # between two lines where nobody watches (a log file)


class ProgressBar:
    """Kilometres of the route, simulated against wall time, and the driving score so far."""

    def __init__(self, length_m: float, step_s: float) -> None:
        self._step_s = step_s
        self._bar = tqdm(
            total=round(length_m / 1000.0, 3),
            unit="km",
            bar_format="{desc}|{bar:30}| {n:.2f}/{total:.2f} km [{elapsed}<{remaining}{postfix}]",
            mininterval=0.1 if sys.stderr.isatty() else QUIET_S,
            desc="driving ",
        )
        self._began_s = time.perf_counter()
        self._score = "-"

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.close()

    def tick(self, routes: RoutesManager, metrics: MetricsManager, frame: Frame) -> None:
        """Once a frame."""
        if frame.tick % UPDATE_TICKS:
            return
        if frame.tick and frame.tick % SCORE_TICKS == 0:
            self._score = f"{metrics.scores().driving:.3f}"
        faster = frame.tick * self._step_s / max(1e-6, time.perf_counter() - self._began_s)
        self._bar.set_postfix_str(f"score so far {self._score}, {faster:.0f}x real time", refresh=False)
        self._bar.update(routes.progress.s_m / 1000.0 - self._bar.n)
