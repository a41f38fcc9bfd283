"""What SUMO's road users do amiss: vanish in sight, stand on crosswalks, overlap, jump aside, brake hard.

    python benchmarks/sumo_conduct.py --folder net/ [--run RUN] [--random N] [--minutes M] [--seed S]

``net/`` comes from `linden map sumo Linden -o net/`. RUN is the folder of any run on Linden: its vehicle under test is
mirrored in SUMO along its recorded places. Without RUN, SUMO drives alone. The poses are those of `basu_sumo.Bridge`;
no simulator takes part. The table shows the same seed without and with the shuttle.
"""

import argparse
import json
import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from importlib import resources
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import carla
import numpy as np
import pyarrow.parquet as pq
from live import STEP_S
from shapely import STRtree
from shapely.affinity import rotate, translate
from shapely.geometry import Point, Polygon, box

from basu_sumo.bridge import Bridge
from basu_sumo.link import in_process
from basu_sumo.random_trips import RandomTrips
from basu_sumo.road_users import RoadUser
from basu_sumo.scenario import config_in
from linden.maps.facts import derive
from linden.maps.navigation.areas import crosswalks
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import LaneType
from linden_maps.sumo.net import read_net

SHUTTLE_ID, SHUTTLE = 1, "vehicle.easymile.ez10"
FAST_MPS, SIGHT_M = 5.0, 150.0
EDGE_M = 15.0  # from the end of a dead end: there the network ends
STANDS_MPS, STANDS_S = 0.1, 1.0
BESIDE_M = 60.0  # of the shuttle
NEAR_CROSSWALK_M = 25.0  # a junction with a marked crosswalk
ON_CROSSWALK_M = 0.75  # beside its outline a person is still on it
JUMP_M = 0.3  # sideways in a tick: 6 m/s
TOUCH_M2 = 0.05
SAMPLE_TICKS = 10
HARD_MPS2 = 0.3  # beyond the deceleration of its type, an emergency
ROUNDING_MPS = 1.0  # SUMO's last steps before it stands brake 0.4 m/s2 harder than the type does


class Map:
    """The map's marked crosswalks and roadways, the signs' lines and the network's ends, in CARLA's frame."""

    def __init__(self, folder: Path) -> None:
        text = (resources.files("linden") / "data" / "Linden.xodr").read_text()
        self.facts = derive(text)
        types = self.facts.lanes["type_bits"]
        found = crosswalks(parse(text.encode()), self.facts.ground, self.facts.lane_of_triangle, types)
        self.outlines = [Polygon(shapes[0][:, :2]) for shapes in found]
        self.crosswalks = STRtree(self.outlines)
        net = read_net(next(folder.glob("*.net.xml")))
        x_m, y_m = net.offset_m
        lanes = [(edge, lane) for edge in net.car_edges() for lane in edge.car_lanes]
        ends = [
            lane.shape[at]
            for edge, lane in lanes
            for node, at in ((edge.start, 0), (edge.end, -1))
            if node in net.outer
        ]
        self.ends_m = np.array([(end[0] - x_m, y_m - end[1]) for end in ends]).reshape(-1, 2)

    def is_end(self, at_m: tuple[float, float]) -> bool:
        """Return whether the network ends here."""
        return bool((np.hypot(*(self.ends_m - at_m).T) < EDGE_M).any())

    def beside_crosswalk(self, at_m: tuple[float, float, float]) -> str | None:
        """Return where a person on a roadway is: "on", "beside" a marked crosswalk, "far"; None off the roadways."""
        _, (triangle,) = self.facts.ground.surfaces_under([at_m])
        if triangle < 0:
            return None
        lane = self.facts.lanes[self.facts.lane_of_triangle[triangle]]
        if not lane["type_bits"] & int(LaneType.DRIVING):
            return None
        point = Point(*at_m[:2])
        near = self.crosswalks.query(point.buffer(NEAR_CROSSWALK_M), predicate="intersects")
        if any(self.outlines[number].distance(point) < ON_CROSSWALK_M for number in near):
            return "on"
        return "beside" if len(near) else "far"


class Watch:
    """The counts of one drive."""

    def __init__(self, the_map: Map, sizes: Mapping[str, tuple[float, float]]) -> None:
        self.map, self.sizes = the_map, sizes
        self.counts: Counter[str] = Counter()
        self.most: dict[str, float] = defaultdict(float)
        self.nearest_m = math.inf
        self.tick = 0
        self._before: dict[str, tuple[RoadUser, float]] = {}
        self._stood: dict[str, int] = defaultdict(int)
        self._touching: set[tuple[str, str]] = set()
        self._braking: dict[str, float] = {}
        self.brakings: list[tuple[float, str, float, float]] = []

    def see(self, users: Mapping[str, RoadUser], shuttle_m: tuple[float, float], link: Any, parked: set[str]) -> None:  # noqa: ANN401
        """Take in one tick."""
        vehicles = {name: user for name, user in users.items() if not user.look.is_person}
        self._come_and_go(vehicles, shuttle_m)
        now = {}
        for name, user in vehicles.items():
            speed_mps = self._moved(name, user)
            now[name] = (user, speed_mps)
            self._stand(name, user, speed_mps, is_parked=name in parked)
            self._brake(name, user, shuttle_m, link)
        self._before = now
        if self.tick % SAMPLE_TICKS == 0:
            self._overlap({name: vehicles[name] for name in parked if name in vehicles})
            for user in users.values():
                if user.look.is_person and (where := self.map.beside_crosswalk(user.pose[:3])):
                    self.counts[f"people {where}"] += 1
        self.tick += 1

    def _come_and_go(self, vehicles: Mapping[str, RoadUser], shuttle_m: tuple[float, float]) -> None:
        for name, (user, speed_mps) in self._before.items():
            if name not in vehicles:
                self._note("vanished", user, speed_mps, shuttle_m)
                self._stood.pop(name, None)
        for name, user in vehicles.items():
            if name not in self._before and self.tick > 1:
                self._note("appeared", user, user.speed_mps, shuttle_m)

    def _note(self, what: str, user: RoadUser, speed_mps: float, shuttle_m: tuple[float, float]) -> None:
        at_m = user.pose[:2]
        self.counts[what] += 1
        if self.map.is_end(at_m):
            self.counts[f"{what} at the edge"] += 1
            return
        away_m = math.dist(at_m, shuttle_m)
        self.counts[f"{what} within sight"] += away_m < SIGHT_M
        if what == "vanished" and speed_mps > FAST_MPS:
            self.counts["vanished fast"] += 1
            self.counts["vanished fast within sight"] += away_m < SIGHT_M
            self.nearest_m = min(self.nearest_m, away_m)

    def _moved(self, name: str, user: RoadUser) -> float:
        """Return the speed; count a jump."""
        if name not in self._before:
            return 0.0
        was, yaw = self._before[name][0].pose, math.radians(user.pose.yaw_deg)
        dx_m, dy_m = user.pose.x_m - was.x_m, user.pose.y_m - was.y_m
        aside_m = abs(dy_m * math.cos(yaw) - dx_m * math.sin(yaw))
        if aside_m > JUMP_M and abs((user.pose.yaw_deg - was.yaw_deg + 180.0) % 360.0 - 180.0) < 5.0:
            self.counts["jumps"] += 1
            self.most["jump"] = max(self.most["jump"], aside_m)
        return math.hypot(dx_m, dy_m) / STEP_S

    def _stand(self, name: str, user: RoadUser, speed_mps: float, *, is_parked: bool) -> None:
        stands = speed_mps < STANDS_MPS
        self._stood[name] = self._stood[name] + 1 if stands else 0
        if self._stood[name] == round(STANDS_S / STEP_S) and not is_parked:
            self.counts["stops"] += 1
            shape = self._shape(user)
            on = [n for n in self.map.crosswalks.query(shape, predicate="intersects")
                  if self.map.outlines[n].intersection(shape).area > TOUCH_M2]  # fmt: skip
            self.counts["stops on crosswalks"] += bool(on)
            for number in on:
                self.counts[f"crosswalk {number}"] += 1

    def _brake(self, name: str, user: RoadUser, shuttle_m: tuple[float, float], link: Any) -> None:  # noqa: ANN401
        api = link.api.vehicle
        beyond_mps2 = -api.getAcceleration(name) - api.getDecel(name)
        if beyond_mps2 > HARD_MPS2 and api.getSpeed(name) > ROUNDING_MPS:
            if name not in self._braking:
                at = f"{name} on {api.getLaneID(name)} behind {(api.getLeader(name) or ('nothing',))[0] or 'nothing'}"
                self.brakings.append((self.tick * STEP_S, at, beyond_mps2, math.dist(user.pose[:2], shuttle_m)))
            self._braking[name] = beyond_mps2
        else:
            self._braking.pop(name, None)

    def _overlap(self, parked: Mapping[str, RoadUser]) -> None:
        names = sorted(parked)
        shapes = [self._shape(parked[name]) for name in names]
        for one, other in STRtree(shapes).query(shapes, predicate="intersects").T if shapes else ():
            area_m2 = shapes[one].intersection(shapes[other]).area
            if one < other and area_m2 > TOUCH_M2:
                self._touching.add((names[one], names[other]))
                self.most["overlap"] = max(self.most["overlap"], area_m2)
        self.counts["overlaps"] = len(self._touching)
        self.counts["parked"] = max(self.counts["parked"], len(names))

    def _shape(self, user: RoadUser) -> Polygon:
        length_m, width_m = self.sizes[user.look.blueprint]
        flat = box(-0.5 * length_m, -0.5 * width_m, 0.5 * length_m, 0.5 * width_m)
        return translate(rotate(flat, user.pose.yaw_deg, origin=(0, 0)), user.pose.x_m, user.pose.y_m)


# -- a world that shows nothing


class _Library:
    """The vehicles' and walkers' blueprints, as far as the bridge asks for them."""

    def __init__(self) -> None:
        data = json.loads((resources.files("linden") / "data" / "blueprints.json").read_text())
        self.facts = data["vehicles"]

    def filter(self, pattern: str) -> list[Any]:
        if pattern.startswith("walker"):
            return [SimpleNamespace(id=f"walker.pedestrian.{number:04d}") for number in range(1, 27)]
        return [
            SimpleNamespace(
                id=f"vehicle.{name}",
                has_attribute=lambda _: True,
                get_attribute=lambda _, base=fact["base_type"]: SimpleNamespace(as_str=lambda: base),
            )
            for name, fact in self.facts.items()
        ]

    def find(self, _: str) -> Any:  # noqa: ANN401
        return SimpleNamespace(has_attribute=lambda _: False)


class _World:
    """The world with the shuttle alone, at its recorded places, or empty."""

    def __init__(self, track: np.ndarray | None) -> None:
        self.library, self.track, self.tick = _Library(), track, 0
        half_m = self.library.facts[SHUTTLE.removeprefix("vehicle.")]["half_m"]
        extent = carla.Vector3D(*half_m)
        self._shuttle = SimpleNamespace(
            id=SHUTTLE_ID,
            type_id=SHUTTLE,
            attributes={"role_name": "hero"},
            bounding_box=SimpleNamespace(extent=extent),
        )

    @property
    def timestamp(self) -> Any:  # noqa: ANN401
        """Return the snapshot's time."""
        return SimpleNamespace(elapsed_seconds=self.tick * STEP_S)

    def get_blueprint_library(self) -> _Library:
        return self.library

    def get_actors(self, ids: Any = None) -> list[Any]:  # noqa: ANN401
        return [self._shuttle] if ids else []

    def __iter__(self) -> Iterator[Any]:
        """Yield the actors of the snapshot."""
        return iter([self._shuttle] if self.track is not None else [])

    def find(self, _: int) -> Any:  # noqa: ANN401
        assert self.track is not None
        x_m, y_m, z_m, yaw_rad = self.track[min(self.tick, len(self.track) - 1)]
        pose = carla.Transform(carla.Location(x_m, y_m, z_m), carla.Rotation(0.0, math.degrees(yaw_rad), 0.0))
        return SimpleNamespace(get_transform=lambda: pose)


class _Shown(SimpleNamespace):
    """The users of the last tick, in place of a display."""

    def show(self, users: dict[str, RoadUser], _: Any) -> list[int]:  # noqa: ANN401
        self.users = users
        return []

    def close(self) -> None:
        """Do nothing: there is no actor."""


def drive(folder: Path, the_map: Map, track: np.ndarray, options: argparse.Namespace, *, with_shuttle: bool) -> Watch:
    """Let SUMO drive, and watch."""
    config = config_in(folder, is_random=options.random is not None)
    link = in_process(config, step_s=STEP_S, seed=options.seed)
    world = _World(track if with_shuttle else None)
    bridge = Bridge(link, None, world, None, lights="none")
    bridge.display = shown = _Shown(actors={}, users={}, waiting={}, shown=0)
    if options.random is not None:
        bridge.before_step = RandomTrips(link, options.random, options.seed, bridge.viewers_m, bridge.held).fill
    sizes = {f"vehicle.{name}": (2 * fact["half_m"][0], 2 * fact["half_m"][1])
             for name, fact in world.library.facts.items()}  # fmt: skip
    watch = Watch(the_map, sizes)
    for tick in range(round(options.minutes * 60.0 / STEP_S)):
        world.tick = tick
        bridge.step(world)
        parked = {
            name for name in shown.users if not name.startswith("person ") and link.api.vehicle.isStoppedParking(name)
        }
        at = track[min(tick, len(track) - 1)]
        watch.see(shown.users, (float(at[0]), float(at[1])), link, parked)
    bridge.close()
    return watch


ROWS = (
    ("vehicles that vanished", "vanished"),
    ("  at the network's edge", "vanished at the edge"),
    (f"  elsewhere within {SIGHT_M:g} m of the shuttle's way", "vanished within sight"),
    (f"  elsewhere above {FAST_MPS:g} m/s", "vanished fast"),
    (f"  elsewhere above {FAST_MPS:g} m/s within {SIGHT_M:g} m", "vanished fast within sight"),
    ("vehicles that appeared", "appeared"),
    ("  at the network's edge", "appeared at the edge"),
    (f"  elsewhere within {SIGHT_M:g} m of the shuttle's way", "appeared within sight"),
    (f"stops of {STANDS_S:g} s", "stops"),
    ("  of those on a marked crosswalk", "stops on crosswalks"),
    ("most parked vehicles at a time", "parked"),
    ("  pairs that overlap", "overlaps"),
    (f"jumps sideways of more than {JUMP_M:g} m in a tick", "jumps"),
    ("samples of people on a roadway, on a marked crosswalk", "people on"),
    (f"  beside one, up to {NEAR_CROSSWALK_M:g} m", "people beside"),
    ("  far from any", "people far"),
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--run", type=Path)
    parser.add_argument("--random", type=int, metavar="N")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    table = (
        pq.read_table(options.run / "history.parquet", columns=["x_m", "y_m", "z_m", "yaw_rad"])
        if options.run
        else None
    )
    track = np.full((1, 4), 1e5) if table is None else np.column_stack([column.to_numpy() for column in table.columns])
    the_map = Map(options.folder)
    ways = (False, True) if options.run else (False,)
    watches = [drive(options.folder, the_map, track, options, with_shuttle=each) for each in ways]
    print(" " * 62 + "".join(f"{'with' if each else 'without':>10}" for each in ways))
    rows: list[tuple[str, list[str]]] = [(said, [str(watch.counts[key]) for watch in watches]) for said, key in ROWS]
    rows += [
        ("nearest fast vanishing to the shuttle, m", [f"{watch.nearest_m:.0f}" for watch in watches]),
        ("greatest overlap of parked vehicles, m2", [f"{watch.most['overlap']:.1f}" for watch in watches]),
        ("farthest jump, m", [f"{watch.most['jump']:.2f}" for watch in watches]),
        ("emergency brakings", [str(len(watch.brakings)) for watch in watches]),
        (f"  within {BESIDE_M:g} m of the shuttle's way",
         [str(sum(away_m < BESIDE_M for *_, away_m in watch.brakings)) for watch in watches]),
    ]  # fmt: skip
    for said, values in rows:
        print(f"{said:62}" + "".join(f"{value:>10}" for value in values))
    for watch in watches if options.verbose else ():
        print(
            *(
                f"braking at {t:.2f} s: {name}, {more:.1f} m/s2 beyond its type, {away:.0f} m"
                for t, name, more, away in watch.brakings
            ),
            sep="\n",
        )
        print({key: value for key, value in watch.counts.items() if key.startswith("crosswalk ")})


if __name__ == "__main__":
    main()
