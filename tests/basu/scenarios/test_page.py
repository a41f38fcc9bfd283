"""Claims about docs/scenarios.md: its tables and files are what the code says."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[3]


def test_the_page_is_what_the_code_says() -> None:
    done = subprocess.run(
        [sys.executable, "scripts/make_scenarios_page.py", "--check"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
