"""Options of SUMO's traffic in a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal

from basu.conditions import Sumo, Traffic
from basu.errors import UserError
from basu.options.conditions import ConditionOptions
from basu.settings.option import option

SUMO_OFF, SUMO_DEMAND, SUMO_RANDOM = "none", "demand", "random"
RANDOM_VEHICLES = 50  # of --sumo random without --vehicles


@dataclass(frozen=True, kw_only=True)
class SumoOptions(ConditionOptions):
    """The conditions of a drive, with SUMO."""

    GROUP = "conditions"
    GONE: ClassVar[Mapping[str, str]] = {
        "sumo_sublane": 'write <lateral-resolution value="0.8"/> into the .sumocfg and name it with --sumo'
    }

    sumo: str | None = option(
        None,
        "drive amid SUMO's traffic: FILE.sumocfg, random (--vehicles N on random trips), demand (of the "
        "town) or none; without a word: demand",
        metavar="WHAT",
        bare=SUMO_DEMAND,
        default_text="as the agent says",
        advice="an agent is named before --sumo, as in `basu run basic --sumo`",
    )
    sumo_radius_m: float | None = option(
        None,
        "show SUMO's vehicles within this of the vehicle under test; the others drive on in SUMO",
        above=0.0,
        default_text="show all",
    )
    sumo_lights: Literal["carla", "sumo", "none"] = option(
        "carla", "which side has the traffic lights; none: each its own"
    )
    sumo_port: int | None = option(
        None, "TraCI port of a running SUMO on this machine", least=1, most=65_535, default_text="SUMO in this process"
    )
    sumo_hour: float | None = option(
        None,
        "hour of the day of the demand that is made, such as 17.5",
        least=0.0,
        most=23.99,
        default_text="the hour that the route stands for",
    )
    sumo_scale: float | None = option(None, "so many times the demand", least=0.0, default_text="the demand as it is")
    sumo_output: bool = option(False, "keep SUMO's own outputs in the run's folder: trip information, safety measures")

    @property
    def traffic(self) -> Traffic:
        """The other road users of the run that the simulator's client drives."""
        return Traffic(0 if self.sumo == SUMO_RANDOM else self.vehicles, self.walkers, self.traffic_density)

    def sumo_of(self, folder: str | None, beside: Path | None) -> Sumo | None:
        """What SUMO is to do for an agent that names ``folder``; None where it is to do nothing."""
        if self.sumo == SUMO_OFF or (self.sumo is None and self.sumo_port is None and folder is None):
            return None
        is_file = self.sumo not in (None, SUMO_DEMAND, SUMO_RANDOM)
        return Sumo(
            file=Path(str(self.sumo)) if is_file else None,
            is_random=self.sumo == SUMO_RANDOM,
            vehicles=self.vehicles or RANDOM_VEHICLES,
            radius_m=self.sumo_radius_m,
            lights=self.sumo_lights,
            port=self.sumo_port,
            folder=folder,
            beside=beside,
            hour=self.sumo_hour,
            scale=self.sumo_scale,
            has_output=self.sumo_output,
        )

    def check(self) -> None:
        """Check the options of SUMO.

        Raises:
            UserError: the file is no configuration of SUMO, or options contradict each other.
        """
        words = (None, SUMO_OFF, SUMO_DEMAND, SUMO_RANDOM)
        if self.sumo not in words and not str(self.sumo).endswith(".sumocfg"):
            raise UserError(f"--sumo {self.sumo}: it may be a FILE.sumocfg, random, demand or none")
        if self.sumo not in words and not Path(str(self.sumo)).is_file():
            raise UserError(f"--sumo {self.sumo}: there is no such file; write one with `linden map sumo TOWN -o DIR`")
        if self.sumo == SUMO_RANDOM and self.traffic_density is not None:
            raise UserError("--sumo random keeps --vehicles N on the road; --traffic-density goes without it")
        self._check_demand_of_sumo(is_file=self.sumo not in words)
        super().check()

    def _check_demand_of_sumo(self, *, is_file: bool) -> None:
        """Check the options of SUMO's demand and outputs.

        Raises:
            UserError: there is no demand to which it applies.
        """
        said = {
            "--sumo-hour": self.sumo_hour is not None,
            "--sumo-scale": self.sumo_scale is not None,
            "--sumo-output": self.sumo_output,
        }
        named = [flag for flag, given in said.items() if given]
        if named and self.sumo_port is not None:
            raise UserError(f"{named[0]} is for a SUMO that basu starts; give yours at --sumo-port its own options")
        if self.sumo == SUMO_RANDOM and (self.sumo_hour is not None or self.sumo_scale is not None):
            raise UserError(f"{named[0]} is for a demand; --sumo random keeps --vehicles N on the road")
        if is_file and self.sumo_hour is not None:
            raise UserError(f"--sumo-hour is for a demand that basu makes; {self.sumo} has its own")
