"""Outputs: what shows or writes a drive while it lasts. Plugins bring them: the window, ROS."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

from basu import plugins

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from basu.managers import Live
    from basu.managers.base_manager import BaseManager
    from basu.managers.person import Person
    from basu.options.drive import DriveOptions


class ShownDrive(NamedTuple):
    """The drive that an output shows."""

    live: Live
    agent: str  # the agent's name
    say: Callable[[str], None]  # prints for the user, where the drive is not quiet


class Output(Protocol):
    """An output, the entry point of a plugin in the group "basu.outputs"."""

    def check(self, options: DriveOptions) -> None:
        """Check before a drive that what the output needs is there.

        Raises:
            UserError: something is missing.
        """

    def managers(self, options: DriveOptions, drive: ShownDrive) -> list[BaseManager]:
        """Return the managers that observe a drive with these options; none where it is not to be shown."""


def _wanted(options: DriveOptions, *, has_person: bool) -> dict[str, str]:
    """Return the outputs of this project that a drive needs, each with what needs it."""
    ros = {"--ros2": options.ros2, "--ros1": options.ros1, "--rosbag": options.rosbag is not None}
    found = {"window": "a person at the wheel" if has_person else _flag_of_person(options)}
    found["ros"] = next((flag for flag, is_set in ros.items() if is_set), None)
    return {name: flag for name, flag in found.items() if flag is not None}


def _flag_of_person(options: DriveOptions) -> str | None:
    """Return the option that lets a person or recorded keys drive; None where there is none."""
    flags = {"--watch": options.watch or None, "--keys": options.keys, "--record-keys": options.record_keys}
    return next((flag for flag, value in flags.items() if value is not None), None)


def person_for(options: DriveOptions, *, by_hand: bool) -> Person | None:
    """Return the person at this drive's page or recorded keys; None where an agent drives unwatched.

    ``by_hand`` says whether the person drives at first.

    Raises:
        UserError: the plugin is not installed, or no such session exists.
    """
    flag = _flag_of_person(options)
    if flag is None and not by_hand:
        return None
    made: Person = plugins.load(plugins.PARTS, "person", flag or "a person at the wheel")(options, by_hand=by_hand)
    return made


def _outputs(options: DriveOptions, *, has_person: bool) -> Iterator[Output]:
    """Yield the outputs of a drive: the ones that it needs, and each of other projects' plugins.

    Raises:
        UserError: an output is needed, and its plugin is not installed.
    """
    own, wanted = plugins.DISTRIBUTIONS[plugins.OUTPUTS], _wanted(options, has_person=has_person)
    for name in own:
        if name in wanted:
            yield plugins.load(plugins.OUTPUTS, name, wanted[name])
    for name in plugins.offered(plugins.OUTPUTS):
        if name not in own:
            yield plugins.load(plugins.OUTPUTS, name, name)


def check_outputs(options: DriveOptions) -> None:
    """Check that all outputs that the options need are installed, and have what they need.

    Raises:
        UserError: something is missing.
    """
    for output in _outputs(options, has_person=False):
        output.check(options)


def output_managers(options: DriveOptions, drive: ShownDrive) -> list[BaseManager]:
    """Return the managers of all outputs, in their order: window, ROS, then those of other projects."""
    outputs = _outputs(options, has_person=drive.live.agents.person is not None)
    return [manager for output in outputs for manager in output.managers(options, drive)]
