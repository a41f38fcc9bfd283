"""A session of the official client with a little of everything that scripts do: ``python session.py PORT``.

A process of its own, because some calls of the client keep Python's lock, and whoever listens in needs it too.
"""

import sys

import carla


def main(port: int) -> None:
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(20.0)
    world = client.get_world()
    library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
    wished = world.get_settings()
    wished.synchronous_mode, wished.fixed_delta_seconds = True, 0.05
    world.apply_settings(wished)
    world.set_weather(carla.WeatherParameters.HardRainNoon)
    car = world.spawn_actor(library.find("vehicle.tesla.model3"), points[0])
    imu = world.spawn_actor(library.find("sensor.other.imu"), carla.Transform(), attach_to=car)
    physics = car.get_physics_control()
    physics.mass = 1500.0
    car.apply_physics_control(physics)
    car.apply_control(carla.VehicleControl(throttle=0.5, steer=0.1))
    car.apply_ackermann_control(carla.VehicleAckermannControl(speed=5.0))
    car.set_light_state(carla.VehicleLightState(carla.VehicleLightState.Brake))
    car.add_impulse(carla.Vector3D(1.0, 2.0, 3.0))
    car.set_target_velocity(carla.Vector3D(5.0, 0.0, 0.0))
    car.set_transform(points[1])
    spawn, then = carla.command.SpawnActor, carla.command.FutureActor
    walker = spawn(library.filter("walker.*")[0], points[5]).then(carla.command.SetSimulatePhysics(then, True))
    others = client.apply_batch_sync([walker, spawn(library.find("vehicle.easymile.ez10"), points[9])], True)
    client.apply_batch([carla.command.ApplyVehicleControl(others[1].actor_id, carla.VehicleControl(throttle=1.0))])
    world.tick()
    for light in world.get_actors().filter("traffic.traffic_light"):
        light.set_state(carla.TrafficLightState.Green)
    client.apply_batch_sync([carla.command.DestroyActor(other.actor_id) for other in others], True)
    for actor in (imu, car):
        actor.destroy()
    world.tick()


if __name__ == "__main__":
    main(int(sys.argv[1]))
