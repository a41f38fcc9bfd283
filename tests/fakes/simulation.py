"""The least world a server can serve: it counts frames. For tests of what is around the simulation."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from linden.errors import Refusal
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import Transform
from linden.protocol.wire.measurements import SensorType, episode_header, sensor_header
from linden.sensors.runtime.measure import EpisodeSensors

EMPTY_MAP = '<?xml version="1.0"?><OpenDRIVE/>'


class FakeEpisode:
    """Stands for its own surroundings, which have no layers and no lamps, and for its own map; it is empty."""

    map = None
    actors: Mapping[int, object] = MappingProxyType({})

    @property
    def surroundings(self) -> "FakeEpisode":
        return self

    def lamp_states(self) -> tuple[()]:
        return ()

    def unload_layers(self, layers: int) -> None:
        assert layers == 0


class FakeSensorScene:
    """There is nothing to see; notes who would have waited for it."""

    def __init__(self, *, is_there: bool = True) -> None:
        self.is_there = is_there
        self.when_built: Callable[[], None] = lambda: None

    def wait(self, at_most_s: float) -> bool:
        assert at_most_s == 0.0
        return self.is_there


@dataclass
class FakeSimulation:
    settings: EpisodeSettings = field(default_factory=EpisodeSettings)
    frame: int = 0
    elapsed_s: float = 0.0
    delta_s: float = 0.0
    episode_id: int = 1
    map_name: str = "Carla/Maps/Plain"
    opendrive_text: str = EMPTY_MAP
    spawn_points: tuple[Transform, ...] = (Transform(),)
    steps_s: list[float] = field(default_factory=list)
    episode: FakeEpisode = field(default_factory=FakeEpisode)
    sensor_scene: FakeSensorScene = field(default_factory=FakeSensorScene)
    sensors: EpisodeSensors = field(default_factory=EpisodeSensors)
    tells_to_read_lamps: bool = False

    def step(self, dt_s: float) -> None:
        self.frame += 1
        self.elapsed_s += dt_s
        self.delta_s = dt_s
        self.steps_s.append(dt_s)

    def measure(self, listened: set[int]) -> list[int]:
        """The one sensor stands for its measurement."""
        return [stream_id for stream_id in listened if stream_id == 2]

    def has_stream(self, stream_id: int) -> bool:
        return stream_id < 1000

    def prepare(self, world_map: str) -> None:
        """Nothing takes time."""

    def load(self, world_map: str, *, reset_settings: bool) -> None:
        self.episode_id += 1
        self.map_name = world_map
        if reset_settings:
            self.settings = EpisodeSettings()


class FakeMaps:
    def __init__(self) -> None:
        self.sent: list[str] = []

    def names(self) -> list[str]:
        return ["/Game/Carla/Maps/Plain"]

    def ready(self, name: str) -> str:
        if name.rsplit("/", 1)[-1] not in ("Plain", *("OpenDriveMap" for _ in self.sent)):
            raise Refusal(f"Map '{name}' not found")
        return f"Carla/Maps/{name.rsplit('/', 1)[-1]}"

    def from_opendrive(self, text: str, *, wall_height_m: float = 0.0, beyond_m: float = 0.0) -> str:
        self.sent.append(text)
        return "OpenDriveMap"

    def keep(self, made: str) -> None:
        """Nothing is made."""


class FakeFrames:
    """The smallest snapshot, with ``padding`` bytes of one row's length behind it, and one sensor on stream 2."""

    def __init__(self, padding_rows: int = 0, sensor_bytes: int = 0) -> None:
        self.padding = bytes(119 * padding_rows)
        self.sensor_bytes = sensor_bytes

    def world_payload(self, simulation: FakeSimulation) -> bytes:
        header = sensor_header(SensorType.WORLD_OBSERVER, simulation.frame, simulation.elapsed_s, Transform())
        return header + episode_header(simulation.episode_id, 0.0, simulation.delta_s) + self.padding

    def sensor_payloads(self, simulation: FakeSimulation, measured: list[int]) -> list[tuple[int, bytes]]:
        return [(stream, bytes(self.sensor_bytes)) for stream in measured if self.sensor_bytes]
