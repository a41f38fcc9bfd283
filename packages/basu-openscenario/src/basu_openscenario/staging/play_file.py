"""`PlayFile`: the node that plays a storyboard on a stage: the agent's entity is followed, the others are led."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.scenarios.actions import Action
from basu.scenarios.stage import EGO, ActorSpec, Controls, Pose
from basu_openscenario.playing.condition_tests import signal_state
from basu_openscenario.playing.mover import Given
from basu_openscenario.reading.entities import BoundingBox
from basu_openscenario.staging.bodies import blueprint_of, middle_of, reference_of
from basu_openscenario.staging.refusals import light_of

if TYPE_CHECKING:
    from basu.scenarios.stage import ActorBox
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.player import Player

SUBSTEP_S = 0.01
"""The longest step of the storyboard: conditions are checked as often as in esmini's examples."""
DROP_M = 0.1
"""Above the road, so that no wheel begins inside of it."""
JUMP_M = 2.0
"""An entity that the storyboard moves farther than this in a frame, beyond its speed, is put there."""
STOPPED = Controls(0.0, 0.0, 0.0)


class PlayFile(Action):
    """Plays the storyboard to its end, or for ``longest_s``. An agent may drive the entity ``ego``."""

    def __init__(self, player: Player, ego: str, *, by_agent: bool, longest_s: float) -> None:
        """Take a player that has done its init actions."""
        super().__init__("play the storyboard")
        self.player, self.ego, self.by_agent, self.longest_s = player, ego, by_agent, longest_s
        self.lights: dict[str, str] = {}
        self.traffic: set[str] = set()
        """The vehicles of traffic that are in the simulator."""

    def begin(self) -> None:
        """Seed the traffic, and give the entity of the ego the box and the speed of the vehicle that drives."""
        self.player.world.traffic.seed(self.stage.rng.getrandbits(64))
        mover, body = self.player.world.mover(self.ego), self.stage.ego
        box = mover.entity.box
        size = BoundingBox(box.centre_m, 2.0 * body.half_length_m, 2.0 * body.half_width_m, box.height_m)
        mover.entity = replace(mover.entity, box=size)
        speed_mps = mover.speed_mps
        if self.by_agent:
            self.stage.move(EGO, speed_mps * math.cos(body.yaw_rad), speed_mps * math.sin(body.yaw_rad), 0.0)
        else:
            self.stage.disturb("as written", lambda _: STOPPED)
        self.first = True

    def act(self) -> str | None:
        """Advance the storyboard by a frame; say so once it is over."""
        if self.by_agent:
            self._follow()
        over_s = self._advance()
        if over_s is not None:
            return f"the storyboard came to its end at {over_s:.2f} s"
        new = self._bring()
        for name, mover in self.player.world.movers.items():
            if name in new or (name == self.ego and self.by_agent):
                continue
            self._lead(EGO if name == self.ego else name, mover)
        self._switch()
        return None

    def leave(self, *, broken_off: bool) -> None:
        """Give the agent its controls back, and lead the ego no more."""
        del broken_off
        self.stage.let_go(EGO)
        self.stage.disturb("as written", None)

    def _follow(self) -> None:
        """Take the motion of the vehicle that the agent drives."""
        mover, body = self.player.world.mover(self.ego), self.stage.ego
        at = reference_of(body.x_m, body.y_m, body.yaw_rad, mover.entity)
        if self.first:  # the first frame shows it at rest, before its speed is given to it
            speed_mps = mover.speed_mps
            velocity = (speed_mps * math.cos(at.h_rad), speed_mps * math.sin(at.h_rad))
        else:
            velocity = (body.velocity_x_mps, -body.velocity_y_mps)
            self.stage.let_go(EGO)
        self.first = False
        mover.given = Given(at.x_m, at.y_m, at.h_rad, *velocity)

    def _advance(self) -> float | None:
        """Play a frame's steps; return the time at which the storyboard is over."""
        count = max(1, round(self.stage.step_s / SUBSTEP_S))
        for _ in range(count):
            if not self.player.step(self.stage.step_s / count) or self.player.world.time_s > self.longest_s:
                return self.player.world.time_s
        return None

    def _bring(self) -> frozenset[str]:
        """Let the simulator have the vehicles of traffic that the storyboard has; return the new ones.

        A vehicle for which the simulator has no room leaves the storyboard too.
        """
        world, stage = self.player.world, self.stage
        for name in sorted(self.traffic - world.traffic.drivers.keys()):
            stage.remove(name)
            self.traffic.remove(name)
        before = frozenset(self.traffic)
        for name in [name for name in world.traffic.drivers if name not in before]:
            mover, there = world.mover(name), middle_of(world.mover(name))
            back_m = mover.speed_mps * stage.step_s  # it is there in the next frame
            x_m, y_m = there.x_m - back_m * math.cos(there.yaw_rad), there.y_m - back_m * math.sin(there.yaw_rad)
            pose = there._replace(x_m=x_m, y_m=y_m)
            try:
                stage.add(ActorSpec(name, blueprint_of(mover.entity), pose, speed_mps=mover.speed_mps))
            except ScenarioError:
                world.traffic.remove(world, name)
            else:
                self.traffic.add(name)
        return frozenset(self.traffic - before)

    def _lead(self, name: str, mover: Mover) -> None:
        """Lead an entity to where the storyboard has it in the next frame."""
        stage = self.stage
        if not mover.is_there:
            if stage.is_there(name) and name != EGO:
                stage.remove(name)
            return
        body, there = stage.body(name), middle_of(mover)
        gap_m = math.hypot(there.x_m - body.x_m, there.y_m - body.y_m)
        turn_rad = math.remainder(there.yaw_rad - body.yaw_rad, math.tau)
        if mover.entity.kind == "miscellaneous":
            if gap_m > 0.01 or abs(turn_rad) > 0.01:
                stage.put(name, there)
        elif gap_m > JUMP_M + 2.0 * abs(mover.speed_mps) * stage.step_s:
            stage.put(name, there._replace(z_m=there.z_m + DROP_M))
        elif mover.entity.kind == "pedestrian":
            stage.walk(name, *self._velocity(body, there))
        else:
            still = abs(mover.speed_mps) < 1e-3 and gap_m < 0.02
            velocity = (0.0, 0.0) if still else self._velocity(body, there)
            stage.move(name, *velocity, 0.0 if still else turn_rad / stage.step_s)

    def _velocity(self, body: ActorBox, there: Pose) -> tuple[float, float]:
        """Return the velocity that leads a body to a place within a frame."""
        return (there.x_m - body.x_m) / self.stage.step_s, (there.y_m - body.y_m) / self.stage.step_s

    def _switch(self) -> None:
        """Let traffic lights show what the storyboard and its controllers say."""
        world = self.player.world
        for signal in world.network.signals:
            state = signal_state(world, signal, world.time_s)
            light = light_of(state) if state else None
            if light is not None and self.lights.get(signal) != light:
                self.lights[signal] = light
                self.stage.set_light(signal, light)
