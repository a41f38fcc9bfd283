"""Sessions of key presses as files: what was held and struck tick by tick, written so that it can be read.

A session is JSON: where and with what it was recorded, and ``keys``, words in lines. A word is a number of ticks and
what was down in them: ``35W`` is 1.75 s of throttle at 20 ticks a second, ``2WA`` throttle and left for two ticks,
``4-`` hands and feet off. W S A D are pedals and wheel, ``_`` is the space bar (hand brake); Q and P are struck in each
tick they stand in. Behind an ``@`` stands a gamepad or wheel in hundredths: ``3-@-12,50,0,0`` is steer -0.12, throttle
0.50, brake 0, hand brake off. A session is played by tick, open loop: no input depends on where the vehicle goes.
"""

from __future__ import annotations

import json
import re
import textwrap
from dataclasses import asdict, dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import loads, write_bytes
from basu_window.manual.inputs import DRIVING_STRIKES, Axes, Held, Input, Strike

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from basu_window.manual.inputs import InputSource

VERSION = 1
MOST_TICKS = 1_000_000  # 14 hours: a longer session is a mistake in a file
LINE_WIDTH = 110
LETTERS: dict[str, Held | Strike] = {
    "W": Held.THROTTLE,
    "S": Held.BRAKE,
    "A": Held.LEFT,
    "D": Held.RIGHT,
    "_": Held.HAND_BRAKE,
    "Q": Strike.REVERSE,
    "P": Strike.AUTOPILOT,
}
WORD = re.compile(r"(\d+)(-|[WSAD_QP]+)(?:@(-?\d+),(\d+),(\d+),([01]))?")


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """What a session was recorded in; elsewhere its keys mean nothing."""

    town: str
    route: str  # its id
    vehicle: str  # blueprint id
    step_s: float  # simulated time from tick to tick


@dataclass(frozen=True, slots=True, kw_only=True)
class Session:
    """A recorded session."""

    setting: Setting
    inputs: tuple[Input, ...]  # one a tick
    by: str = "a person"  # the source of the keys

    def read(self, tick: int) -> Input:
        """What was done in a tick; afterwards nothing."""
        return self.inputs[tick] if tick < len(self.inputs) else Input()

    def check(self, here: Setting) -> None:
        """Compare with where it is to be played.

        Raises:
            UserError: it was recorded in another town, on another route, with another vehicle or step.
        """
        for name, recorded in asdict(self.setting).items():
            wanted = getattr(here, name)
            if recorded != wanted:
                raise UserError(
                    f"the session of keys was recorded with {name} {recorded}, and this run has {wanted}; keys are "
                    "played blindly and would lead nowhere: choose what it was recorded with, or record another"
                )


class Played:
    """A session that is played, with or without a page; the page can still end the run."""

    def __init__(self, session: Session, page: InputSource | None) -> None:
        self.session = session
        self._page = page

    def read(self, tick: int) -> Input:
        """The session's keys, and the page's key that ends the run."""
        done = self.session.read(tick)
        if self._page is None:
            return done
        struck = tuple(strike for strike in self._page.read(tick).strikes if strike not in DRIVING_STRIKES)
        return done._replace(strikes=(*done.strikes, *struck))


class RecordingSource:
    """An input source that records what it passes on."""

    def __init__(self, source: InputSource) -> None:
        self.source = source
        self.inputs: list[Input] = []

    def read(self, tick: int) -> Input:
        """Read and note; the key that ends the run is not noted."""
        done = self.source.read(tick)
        driving = tuple(strike for strike in done.strikes if strike in DRIVING_STRIKES)
        self.inputs.append(done._replace(strikes=driving))
        return done


def read_session(path: Path) -> Session:
    """Read a file.

    Raises:
        UserError: it is not there, or no session.
    """
    try:
        document = loads(path.read_text(encoding="utf-8"))
        if document["version"] != VERSION:
            raise UserError(f"the session of keys {path} has version {document['version']}; this BASU reads {VERSION}")
        return Session(
            setting=_setting(document["recorded"]),
            inputs=tuple(_read_words(" ".join(document["keys"]).split())),
            by=str(document["by"]),
        )
    except OSError as error:
        raise UserError(f"the session of keys {path} cannot be read: {error.strerror}") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise UserError(
            f"{path} is not a session of keys ({error!r}); one is recorded with `basu run human --record-keys FILE`"
        ) from error


def write_session(path: Path, session: Session) -> None:
    """Write a file; it is whole or not there."""
    document: dict[str, Any] = {
        "version": VERSION,
        "by": session.by,
        "recorded": asdict(session.setting),
        "ticks": len(session.inputs),
        "keys": textwrap.wrap(" ".join(_words(session.inputs)), LINE_WIDTH, break_on_hyphens=False),
    }
    write_bytes(path, (json.dumps(document, indent=1, ensure_ascii=False) + "\n").encode())


def _setting(given: dict[str, Any]) -> Setting:
    """The setting out of JSON."""
    return Setting(
        town=str(given["town"]),
        route=str(given["route"]),
        vehicle=str(given["vehicle"]),
        step_s=float(given["step_s"]),
    )


def _words(inputs: Iterable[Input]) -> list[str]:
    """A word for each stretch of equal ticks."""
    return [f"{sum(1 for _ in equal)}{_letters(done)}" for done, equal in groupby(inputs)]


def _letters(done: Input) -> str:
    """What is down in a tick, without the number of ticks."""
    down = "".join(
        letter * (done.strikes.count(meant) if isinstance(meant, Strike) else int(meant in done.held))
        for letter, meant in LETTERS.items()
    )
    if done.axes is None:
        return down or "-"
    steer, throttle, brake, hand_brake = (round(100 * value) for value in done.axes)
    return f"{down or '-'}@{steer},{throttle},{brake},{hand_brake // 100}"


def _read_words(words: Iterable[str]) -> list[Input]:
    """The ticks of all words; ValueError where one is none."""
    inputs: list[Input] = []
    for word in words:
        found = WORD.fullmatch(word)
        if found is None:
            raise ValueError(f"'{word}' is no number of ticks with keys out of {' '.join(LETTERS)}")
        ticks, letters, *axes = found.groups()
        if len(inputs) + int(ticks) > MOST_TICKS:
            raise ValueError(f"there are more than {MOST_TICKS} ticks")
        inputs.extend([_input(letters, axes)] * int(ticks))
    return inputs


def _input(letters: str, axes: list[str | None]) -> Input:
    """One tick."""
    held = Held.NOTHING
    strikes: list[Strike] = []
    for letter in letters.replace("-", ""):
        meant = LETTERS[letter]
        if isinstance(meant, Held):
            held |= meant
        else:
            strikes.append(meant)
    values = [int(value) for value in axes if value is not None]
    return Input(held, tuple(strikes), _axes(*values) if values else None)


def _axes(steer: int, throttle: int, brake: int, hand_brake: int) -> Axes:
    """Axes out of hundredths."""
    return Axes(steer / 100, throttle / 100, brake / 100, bool(hand_brake))
