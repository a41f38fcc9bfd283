"""A person steps onto the road from behind a parked bus, in front of a shuttle that has heard of the person or not.

    basu service run examples/hidden_person_agent.py:Warned --beside cooperative --apart 0.6 --open
    basu service run examples/hidden_person_agent.py:Alone --beside behavioral --apart 0.6 --open

The other shuttle is ahead, beyond the bus, and sees the person. `cooperative` tells of people by radio; `behavioral`
has no radio. The bus and the person are actors of this agent, so it needs `--open`.
"""

import carla

from basu.agents.builtin.behavioral import BehavioralAgent
from basu.agents.builtin.cooperative import CooperativeAgent

BUS_S_M, BUS_RIGHT_M = 44.0, 3.4  # its middle along the route, and right of the middle of the lane
PERSON_S_M, PERSON_RIGHT_M = 50.6, 6.5
BEGINS_M = 25.0  # from the shuttle to the person when the person begins to walk
PACE_MPS = 1.4


class Stage:
    def setup(self):
        super().setup()
        library = self.world.get_blueprint_library()
        bus, person = library.find("vehicle.mitsubishi.fusorosa"), library.find("walker.pedestrian.0001")
        self.bus = self.world.spawn_actor(bus, self.beside(BUS_S_M, BUS_RIGHT_M, turn_deg=0.0))
        self.person = self.world.spawn_actor(person, self.beside(PERSON_S_M, PERSON_RIGHT_M, turn_deg=-90.0))
        self.has_begun = False

    def beside(self, s_m, right_m, turn_deg):
        number = min(range(len(self.route.s_m)), key=lambda each: abs(self.route.s_m[each] - s_m))
        pose = self.route.waypoints[number].transform
        right = pose.get_right_vector()
        at = pose.location + carla.Location(right_m * right.x, right_m * right.y, 1.2)
        return carla.Transform(at, carla.Rotation(yaw=pose.rotation.yaw + turn_deg))

    def run_step(self, sensor_data):
        if not self.has_begun and self.vehicle.get_location().distance(self.person.get_location()) < BEGINS_M:
            self.has_begun = True
            way = self.person.get_transform().get_forward_vector()
            self.person.apply_control(carla.WalkerControl(way, PACE_MPS, False))
        return super().run_step(sensor_data)

    def destroy(self):
        for name in ("bus", "person"):
            if hasattr(self, name):
                getattr(self, name).destroy()


class Warned(Stage, CooperativeAgent):
    pass


class Alone(Stage, BehavioralAgent):
    pass
