"""``basu index``: one page over all results of a folder."""

from __future__ import annotations

import argparse
import sys

from tqdm import tqdm

from basu.output.report.index.page import write_index


def run(arguments: argparse.Namespace) -> int:
    """Write index.html, and print its path and what could not be read."""
    often_s = 0.1 if sys.stderr.isatty() else 10.0
    with tqdm(unit=" results", desc="reading", mininterval=often_s, delay=1.0) as bar:
        path, found = write_index(arguments.folder, bar.update)
    for sentence in found.unread:
        print(f"basu: warning: {sentence}", file=sys.stderr)
    print(path)
    return 0
