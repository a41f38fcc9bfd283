"""The clock of a run, as ScenarioRunner's ``srunner.scenariomanager.timer`` has it."""

from __future__ import annotations

import datetime as dt
from typing import TYPE_CHECKING, ClassVar

if TYPE_CHECKING:
    import carla


class GameTime:
    """Simulated time since the run began; BASU lets it go on before each step of the agent."""

    _time_s: ClassVar[float] = 0.0
    _carla_time_s: ClassVar[float] = 0.0
    _frame: ClassVar[int] = 0
    _wall: ClassVar[dt.datetime | None] = None

    @staticmethod
    def on_carla_tick(timestamp: carla.Timestamp) -> None:
        """Go on to a step of the simulator; one that is not newer changes nothing."""
        if timestamp.frame <= GameTime._frame:
            return
        steps = timestamp.frame - GameTime._frame if GameTime._frame else 1
        GameTime._time_s += timestamp.delta_seconds * steps
        GameTime._carla_time_s = timestamp.elapsed_seconds
        GameTime._frame = timestamp.frame
        GameTime._wall = dt.datetime.now()  # noqa: DTZ005 - agents subtract it from others without a zone

    @staticmethod
    def restart() -> None:
        """Begin anew."""
        GameTime._time_s = GameTime._carla_time_s = 0.0
        GameTime._frame = 0
        GameTime._wall = None

    @staticmethod
    def get_time() -> float:
        """Simulated time in s since the run began; one step at the first call of ``run_step``."""
        return GameTime._time_s

    @staticmethod
    def get_carla_time() -> float:
        """Simulated time in s since the simulator's episode began."""
        return GameTime._carla_time_s

    @staticmethod
    def get_wallclocktime() -> dt.datetime | None:
        """When the last step was heard of; None before the first."""
        return GameTime._wall

    @staticmethod
    def get_frame() -> int:
        """The simulator's number of the last step."""
        return GameTime._frame
