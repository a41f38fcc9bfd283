"""Drives that tests watch and steer in a real browser."""

import re
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from basu_fixtures import BASU

PAD = """navigator.getGamepads = () => [{{id: "Pad", connected: true, mapping: "standard", axes: [{steer}, 0, 0, 0],
  buttons: Array.from({{length: 17}}, (_, at) => ({{value: at === 7 ? {throttle} : at === 6 ? {brake} : 0}}))}}]"""

WHEEL = """navigator.getGamepads = () => [{{id: "G29 Driving Force Racing Wheel", connected: true, mapping: "",
  axes: [{steer}, 0, {throttle}, {brake}, 0, 0], buttons: Array.from({{length: 25}}, () => ({{value: 0}}))}}]"""


@contextmanager
def started(*words: str | Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Run a command until it prints the page's address."""
    process = subprocess.Popen([*BASU, *words], stdout=subprocess.PIPE, text=True)
    try:
        said = ""
        while (found := re.search(r"http://\S+/", said)) is None:
            line = process.stdout.readline()
            assert line, said
            said += line
        yield process, found[0]
    finally:
        process.kill()
        process.wait()
