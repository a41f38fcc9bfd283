"""Claims about the bar that shows how far a run is."""

from types import SimpleNamespace
from typing import Any

import pytest

from basu.output.progress import SCORE_TICKS, ProgressBar


def bar_after(ticks: int, driving: dict[int, float], capsys: pytest.CaptureFixture[str]) -> str:
    """The bar's last line after a run of so many ticks; ``driving`` has the score from each tick on."""
    metrics: Any = SimpleNamespace(ticks=0)
    metrics.scores_so_far = lambda: SimpleNamespace(driving=driving[max(t for t in driving if t <= metrics.ticks)])
    routes = SimpleNamespace(progress=SimpleNamespace(s_m=0.0))
    live: Any = SimpleNamespace(metrics=metrics, routes=routes)
    run: Any = SimpleNamespace(step_s=0.05, route=SimpleNamespace(length_m=1000.0))
    bar = ProgressBar(live)
    bar.setup(run)
    for tick in range(ticks):
        metrics.ticks, routes.progress.s_m = tick + 1, 1000.0 * (tick + 1) / ticks
        bar.tick(SimpleNamespace(tick=tick))  # type: ignore[arg-type]
    bar.close()
    return capsys.readouterr().err.replace("\r", "\n").strip().splitlines()[-1]


def test_the_bar_ends_with_the_score_and_the_way_of_the_last_tick(capsys: pytest.CaptureFixture[str]) -> None:
    last = bar_after(SCORE_TICKS + 150, {0: 0.111, SCORE_TICKS + 140: 0.777}, capsys)
    assert "score 0.777" in last
    assert "1.00/1.00 km" in last


def test_a_short_run_has_a_score_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert "score 0.500" in bar_after(30, {0: 0.5}, capsys)


def test_a_run_without_a_tick_has_none(capsys: pytest.CaptureFixture[str]) -> None:
    assert "score 0" not in bar_after(0, {0: 0.5}, capsys)
