"""The person at the wheel, as the benchmark knows one: a plugin brings the page and recorded keys."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from basu import plugins

if TYPE_CHECKING:
    import carla

    from basu.options.drive import DriveOptions


class Person(Protocol):
    """A person that may take over from the agent."""

    @property
    def drives_first(self) -> bool:
        """Whether the person drives when the drive begins."""

    def step(self, tick: int, dt_s: float, agents: carla.VehicleControl) -> carla.VehicleControl | None:
        """Return the person's control in a tick of ``dt_s`` seconds; None while the agent's control counts."""


def person_for(options: DriveOptions, *, by_hand: bool) -> Person | None:
    """Return the person at this drive's page or recorded keys; None where an agent drives unwatched.

    ``by_hand`` says whether the person drives at first.

    Raises:
        UserError: the plugin is not installed, or no such session exists.
    """
    flags = {"--keys": options.keys, "--record-keys": options.record_keys}
    given = ["--watch"] * options.watch + [flag for flag, value in flags.items() if value is not None]
    if not (given or by_hand):
        return None
    made: Person | None = plugins.load(plugins.PARTS, "person", given[0] if given else "a person at the wheel")(
        options, by_hand=by_hand
    )
    return made
