"""Fill the code blocks of README and docs that show a whole file: `make_example_blocks.py [--check]`.

A block stands between ``<!-- file PATH -->`` and ``<!-- /file -->``; PATH is relative to the repository.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
BLOCK = re.compile(r"(<!-- file (\S+) -->\n).*?(<!-- /file -->)", re.DOTALL)
LANGUAGES = {".py": "python", ".xml": "xml", ".json": "json"}


def main() -> int:
    """Write the pages, or check that they are up to date."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--check", action="store_true", help="write nothing; fail if a page is not up to date")
    check = arguments.parse_args().check
    old = [page for page in pages() if filled(page.read_text("utf-8")) != page.read_text("utf-8")]
    for page in old:
        if check:
            print(
                f"{page.relative_to(ROOT)} is out of date; run `python scripts/{Path(__file__).name}`", file=sys.stderr
            )
        else:
            page.write_text(filled(page.read_text("utf-8")), "utf-8")
    return 1 if check and old else 0


def pages() -> list[Path]:
    """Return the pages that may show files."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def filled(text: str) -> str:
    """Return a page with each block replaced by the file that it names."""
    return BLOCK.sub(lambda found: f"{found[1]}\n{block(ROOT / found[2])}\n\n{found[3]}", text)


def block(path: Path) -> str:
    """Return a file as a code block."""
    return f"```{LANGUAGES[path.suffix]}\n{path.read_text('utf-8').strip()}\n```"


if __name__ == "__main__":
    sys.exit(main())
