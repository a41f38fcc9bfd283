"""``python -m basu_leaderboard`` prints the file that the leaderboard and ScenarioRunner want as ``--agent``."""

from __future__ import annotations

import sys
from pathlib import Path

sys.stdout.write(f"{Path(__file__).parent / 'entry' / 'basu_agent.py'}\n")
