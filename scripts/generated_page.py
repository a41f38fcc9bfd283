"""`write_or_check`: the main function of the scripts that generate pages; `replaced` fills one place of a page."""

import argparse
import re
import sys
from collections.abc import Callable, Mapping
from pathlib import Path


def write_or_check(script: str, described: str | None, make: Callable[[], Mapping[Path, str]]) -> int:
    """Write the files of a script, or with --check print which are out of date, and return 1 if any is.

    Args:
        script: its ``__file__``.
        described: its ``__doc__``, for the help.
        make: returns the text of each file.
    """
    arguments = argparse.ArgumentParser(description=described)
    arguments.add_argument("--check", action="store_true", help="write nothing; fail if a file is not up to date")
    check = arguments.parse_args().check
    old = {path: text for path, text in make().items() if not path.is_file() or path.read_text("utf-8") != text}
    if not check:
        for path, text in old.items():
            path.write_text(text, "utf-8")
        return 0
    if old:
        names = ", ".join(path.name for path in old)
        print(f"out of date: {names}; run `python scripts/{Path(script).name}`", file=sys.stderr)
    return 1 if old else 0


def replaced(page: str, name: str, text: str) -> str:
    """Return the page with ``text`` between the marks of ``name``.

    Raises:
        SystemExit: it does not have these marks once.
    """
    found, number = re.subn(
        f"(<!-- {re.escape(name)} -->\n).*?(<!-- /{re.escape(name)} -->)",
        lambda match: f"{match[1]}\n{text}\n\n{match[2]}",
        page,
        flags=re.DOTALL,
    )
    if number != 1:
        raise SystemExit(f"the page has {number} places for '{name}'; it must have one")
    return found
