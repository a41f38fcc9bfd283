"""The style that cards, matrices and maps need in a page, beside that of every report."""

from __future__ import annotations

import functools
from pathlib import Path

from basu.output.report.scenarios.pictures import picture_style
from basu.output.report.scenarios.sweep.success_map import map_style

HERE = Path(__file__).parent


@functools.lru_cache
def card_style() -> str:
    """All of it."""
    return "\n".join([(HERE / "scenarios.css").read_text(encoding="utf-8"), picture_style(), map_style()])
