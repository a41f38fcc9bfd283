"""Makes data/human_session.json of basu, the session of keys of the row "human" in the thesis's experiment.

Nobody sat there: a program pressed the keys. It takes the basic driver's wishes for the pedals and the wheel and
answers each tick with those of W, A, S and D that bring the keyboard's pedals and wheel nearest to them, on and off, as
a person who taps them. On three straights it holds W down until the posted limit is well exceeded, and then S.
The stop signs it keeps.

    python scripts/make_human_session.py

drives routes/linden_short.xml once (a quarter of a minute) and writes the file; then

    basu run human --keys data/human_session.json

plays it: no collision, three times too fast. Needed again whenever the physics, the map or the driver change.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import carla
import numpy as np

from basu.agents.builtin.basic import BasicAgent, HumanAgent
from basu.cli import main as basu
from basu.conditions import STEP_S
from basu_window.manual.inputs import Held, Input, PedalsAndWheel, after, steer_after
from basu_window.manual.session import Session, Setting, write_session

if TYPE_CHECKING:
    from collections.abc import Mapping

FILE = Path(__file__).parents[1] / "packages" / "basu" / "src" / "basu" / "data" / "human_session.json"
BY = "scripts/make_human_session.py: a program pressed the keys, on and off, as the basic driver wished"
HASTE = ((198.0, 226.0, 6.0), (325.0, 375.0, 8.0), (570.0, 615.0, 8.0))
"""Straights: from where to where along the route W is held down, and to which speed in m/s S brakes afterwards."""
OVER_MPS = 2.0
"""How far above the posted limit the speed is brought there."""
WHEEL_KEYS = (Held.NOTHING, Held.LEFT, Held.RIGHT)


class KeyPresser(BasicAgent):
    """Drives as a person with four keys would who thinks like the basic driver; ``inputs`` are the keys."""

    def setup(self) -> None:
        """Sit down, feet off the pedals."""
        super().setup()
        self.hands = PedalsAndWheel()
        self.owed_throttle = self.owed_brake = 0.0
        self.haste = list(HASTE)
        self.inputs: list[Input] = []

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Press the keys for what the driver wishes."""
        wish = super().run_step(sensor_data)
        held = self._wheel(wish) | (self._hurry() or self._pedals(wish))
        self.inputs.append(Input(held))
        self.hands = after(self.hands, held, STEP_S)
        return carla.VehicleControl(throttle=self.hands.throttle, steer=self.hands.steer, brake=self.hands.brake)

    def config(self) -> dict[str, str]:
        """What the human agent has."""
        return HumanAgent().config()

    def destroy(self) -> None:
        """Write the session."""
        assert self.route is not None
        setting = Setting(
            town=self.route.town, route=self.route.id, vehicle=self.vehicle.type_id, step_s=self.time_step_s
        )
        write_session(FILE, Session(setting=setting, inputs=tuple(self.inputs), by=BY))

    def _wheel(self, wish: carla.VehicleControl) -> Held:
        """What brings the wheel nearest."""
        off = [abs(steer_after(self.hands.steer, keys, STEP_S) - wish.steer) for keys in WHEEL_KEYS]
        return WHEEL_KEYS[int(np.argmin(off))]

    def _pedals(self, wish: carla.VehicleControl) -> Held:
        """What brings the pedals nearest over time: what one got too little or too much of is carried over."""
        self.owed_throttle = float(np.clip(self.owed_throttle + wish.throttle, -1.0, 1.0))
        self.owed_brake = float(np.clip(self.owed_brake + wish.brake, -1.0, 1.0))
        pressed = after(self.hands, Held.THROTTLE | Held.BRAKE, STEP_S)
        if wish.brake > 0.0 and self.owed_brake >= 0.5 * pressed.brake:
            self.owed_brake -= pressed.brake
            return Held.BRAKE
        if wish.throttle > 0.0 and self.owed_throttle >= 0.5 * pressed.throttle:
            self.owed_throttle -= pressed.throttle
            return Held.THROTTLE
        return Held.NOTHING

    def _hurry(self) -> Held:
        """On a straight that is driven too fast: throttle, and the brake at its end; elsewhere nothing."""
        assert self.driver is not None
        assert self.driver.place is not None
        assert self.route is not None
        s_m, speed_mps = self.driver.place.s_m, self.vehicle.get_velocity().length()
        if not self.haste or s_m < self.haste[0][0]:
            return Held.NOTHING
        _, end_m, slow_mps = self.haste[0]
        if s_m < end_m:
            posted_mps = float(np.interp(s_m, self.route.s_m, self.route.speed_limit_mps))
            return Held.THROTTLE if speed_mps < posted_mps + OVER_MPS else Held.NOTHING
        if speed_mps > slow_mps:
            return Held.BRAKE
        self.haste.pop(0)
        return Held.NOTHING


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        sys.exit(basu(["run", f"{__file__}:KeyPresser", "--output", folder]))
