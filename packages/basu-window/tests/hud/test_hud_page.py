"""Claims about the manual of the HUD: it has every key of the help page."""

from pathlib import Path

import pytest

from basu_window.hud.panel import KEYS
from basu_window.manual.devices import HELD_BY, STRUCK_BY

PAGE = Path(__file__).parents[4] / "docs" / "how-to" / "hud.md"


@pytest.mark.parametrize(("key", "meaning"), KEYS)
def test_the_page_has_every_key_as_the_help_has_it(key: str, meaning: str) -> None:
    assert f"| {key} | {meaning} |" in PAGE.read_text(encoding="utf-8")


def test_the_help_has_every_key_that_works() -> None:
    shown = " ".join(key.lower() for key, _ in KEYS).replace("arrows", "left right").replace("arrow ", "")
    spelt = {"ESCAPE": "esc", "QUESTION": "?"}
    for keys in (*HELD_BY.values(), *STRUCK_BY.values()):
        for key in keys:
            assert spelt.get(key, key).lower() in shown
