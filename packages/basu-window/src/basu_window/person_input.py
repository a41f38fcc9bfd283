"""`person_for` chooses a run's input, a browser page or recorded keys; `KeysManager` checks and writes such keys."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.files import find
from basu.managers.base_manager import BaseManager
from basu_window.browser.live import WatchManager
from basu_window.browser.page_input import PageInput
from basu_window.manual.inputs import Person
from basu_window.manual.session import Played, RecordingSource, Session, Setting, read_session, write_session

if TYPE_CHECKING:
    from pathlib import Path

    from basu.managers import Live
    from basu.managers.base_manager import Frame, Run
    from basu.options.drive import DriveOptions
    from basu_window.manual.inputs import InputSource


def person_for(options: DriveOptions, *, by_hand: bool) -> Person | None:
    """Return the person at this run's page or recorded keys; None where an agent drives unwatched.

    ``by_hand`` says whether the person drives at first; without a session of keys, that needs a page.

    Raises:
        UserError: keys are to be recorded and there is no page, or there is no such session.
    """
    path = options.record_keys
    if path is not None and not path.resolve().parent.is_dir():
        raise UserError(f"{path} cannot be written: there is no folder {path.parent}; make it, or name another")
    page = PageInput() if options.watch or (by_hand and options.keys is None) else None
    source: InputSource
    if options.keys is not None:
        source = Played(read_session(find(options.keys, "session of keys")), page)
    elif page is not None:
        source = page
    elif options.record_keys is not None:
        raise UserError("--record-keys records what a person does, and there is no page; add --watch")
    else:
        return None
    return Person(
        source if options.record_keys is None else RecordingSource(source),
        drives_first=by_hand,
        taken_by_any_input=by_hand,
        live=options.keys is None,
        page=page,
    )


def onlookers_for(options: DriveOptions, live: Live, agent: str) -> list[BaseManager]:
    """Return the managers of the page, which names the agent, and of the recorded keys."""
    person = live.agents.person
    if not isinstance(person, Person):
        return []
    found: list[BaseManager] = []
    if options.keys is not None or options.record_keys is not None:
        found.append(KeysManager(person.source, options.record_keys))
    if person.page is not None:
        found.append(WatchManager(live, person, person.page, agent, print))
    return found


class KeysManager(BaseManager):
    """Checks that a session of keys is played where it was recorded, and writes down one that is driven."""

    def __init__(self, source: InputSource, path: Path | None) -> None:
        """Take what a person does; ``path`` is where it is written, None for nowhere."""
        self._path = path
        self._tape = source if isinstance(source, RecordingSource) else None
        played = source if self._tape is None else self._tape.source
        self._played = played.session if isinstance(played, Played) else None
        self._here: Setting | None = None

    def setup(self, run: Run) -> None:
        """Compare where we are with where the session was recorded."""
        self._here = here = Setting(
            town=run.route.town, route=run.route.id, vehicle=run.vehicle.type_id, step_s=run.step_s
        )
        if self._played is not None:
            self._played.check(here)

    def tick(self, frame: Frame) -> None:
        """The tape turns by itself."""

    def close(self) -> None:
        """Write the session, where one was recorded."""
        if self._path is not None and self._here is not None and self._tape is not None:
            with contextlib.suppress(UserError):  # the next write reports a full disk
                write_session(self._path, Session(setting=self._here, inputs=tuple(self._tape.inputs)))
