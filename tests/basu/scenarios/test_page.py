"""Claims about docs/reference/scenarios.md: its tables and files are what the code says, and its ids mean cases."""

import re
import subprocess
import sys
from pathlib import Path

from basu.scenarios.cases import by_id

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


def test_every_id_on_the_page_means_a_case() -> None:
    page = (ROOT / "docs" / "reference" / "scenarios.md").read_text("utf-8")
    ids = set(re.findall(r"\b[a-z_]+_\d+:[\w=.,:-]*\w", page))
    assert len(ids) >= 5
    for identity in ids:
        assert by_id(identity).case.name == identity
