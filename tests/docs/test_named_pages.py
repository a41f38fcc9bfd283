"""Claims about the pages that messages and docstrings name: they exist."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = re.compile(r"\bdocs/[\w/-]+\.md\b")
FOLDERS = ("packages", "examples", "scripts", "benchmarks")


def test_every_page_that_the_code_names_is_there() -> None:
    files = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.suffix in {".py", ".j2", ".xml"}]
    named = [(path, page) for path in files for page in PAGE.findall(path.read_text(encoding="utf-8"))]
    assert len(named) > 20
    missing = [f"{path.relative_to(ROOT)}: {page}" for path, page in named if not (ROOT / page).is_file()]
    assert missing == []
