"""The seat before the window: who sits in it, and the sessions of keys that are played and recorded there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.agents.human import HumanAgent
from basu.errors import UserError
from basu.managers.base_manager import BaseManager
from basu.manual.devices import Devices, check_display
from basu.manual.person import Person
from basu.manual.session import Session, Setting, Tape, read_session, write_session
from basu.utils.packaged import find

if TYPE_CHECKING:
    from pathlib import Path

    from basu.agents.autonomous_agent import AutonomousAgent
    from basu.managers.base_manager import Frame, Live, Run
    from basu.manual.inputs import InputSource
    from basu.options import RunOptions


def person_for(options: RunOptions, agent_class: type[AutonomousAgent]) -> Person | None:
    """Whoever sits before this run's window, or plays keys; None where an agent drives unwatched.

    Raises:
        UserError: no window can be opened, or there is no such session.
    """
    by_hand = issubclass(agent_class, HumanAgent)
    has_window = options.hud is not None or (by_hand and options.keys is None)
    if has_window:
        check_display()
    if options.keys is None and not has_window:
        if options.record_keys is not None:
            raise UserError("--record-keys records what a person does, and nobody sits there; add --hud")
        return None
    source: InputSource = Devices() if options.keys is None else read_session(find(options.keys, "session of keys"))
    return Person(
        source if options.record_keys is None else Tape(source),
        drives_first=by_hand,
        taken_by_any_input=by_hand,
        live=options.keys is None,
    )


def onlookers_for(options: RunOptions, live: Live) -> list[BaseManager]:
    """Those who look on at a run with this person and window."""
    found: list[BaseManager] = []
    person = live.agents.person
    if person is not None:
        found.append(KeysManager(person, options.record_keys))
    return found


class KeysManager(BaseManager):
    """Checks that a session of keys is played where it was recorded, and writes down one that is driven."""

    def __init__(self, person: Person, path: Path | None) -> None:
        self._person, self._path = person, path
        self._here: Setting | None = None

    def setup(self, run: Run) -> None:
        """Compare where we are with where the session was recorded."""
        self._here = here = Setting(
            town=run.route.town, route=run.route.id, vehicle=run.vehicle.type_id, step_s=run.step_s
        )
        played = self._person.source
        if isinstance(played, Session):
            played.check(here)

    def tick(self, frame: Frame) -> None:
        """The tape turns by itself."""

    def close(self) -> None:
        """Write the session, where one was recorded."""
        tape = self._person.source
        if self._path is not None and self._here is not None and isinstance(tape, Tape):
            write_session(self._path, Session(setting=self._here, inputs=tuple(tape.inputs)))
