"""The options of a run, each declared once: its type, default, bounds and meaning."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

from basu.errors import UserError
from basu.settings.option import Option, Settings

STEP_S = 0.05  # simulated time from tick to tick: 20 Hz
HUD_VIEWS = ("camera", "map")

WINDOWS = (640, 480), (7680, 4320)  # pixels; the panel and the help page need the smallest
PICTURES = (64, 48), (3840, 2160)  # of the HUD's camera

SIMULATOR, FOLDERS, ROUTES, CONDITIONS = "simulator", "run folders", "routes and scenarios", "conditions"
AGENT, WINDOW = "agent", "window, viewer and keys"

# Options that several commands share.
Host = Annotated[
    str | None,
    Option(
        help="a running simulator", group=SIMULATOR, metavar="HOST", default_text="start one and end it", repeats=False
    ),
]
Port = Annotated[int, Option(help="port of --host", group=SIMULATOR, metavar="N", least=1, most=65_535, repeats=False)]
Timeout = Annotated[
    float,
    Option(
        help="time to wait for the simulator's answer",
        group=SIMULATOR,
        flag="--timeout",
        metavar="S",
        unit="s",
        above=0.0,
        repeats=False,
    ),
]
Vehicle = Annotated[
    str | None,
    Option(help="blueprint to drive", group=CONDITIONS, metavar="BLUEPRINT", default_text="as the agent says"),
]
StepLimit = Annotated[
    float,
    Option(
        help="wall time for one step of the agent", group=AGENT, flag="--step-limit", metavar="S", unit="s", above=0.0
    ),
]
InProcess = Annotated[
    bool,
    Option(
        help="drive the agent in BASU's own process, for debuggers; an agent that dies there ends everything",
        group=AGENT,
        repeats=False,
    ),
]
AgentMemory = Annotated[
    float | None,
    Option(
        help="memory that the agent's process may use; more is the agent's failure",
        group=AGENT,
        flag="--agent-memory",
        metavar="GB",
        unit="GB",
        above=0.0,
        default_text="no limit",
    ),
]
Output = Annotated[Path, Option(help="parent of the run folders", group=FOLDERS, metavar="DIR", repeats=False)]
Debug = Annotated[bool, Option(help="show the traceback of an agent that fails", group=AGENT, repeats=False)]


class Traffic(NamedTuple):
    """How many others are to be on the road; vehicles by number or, where a density is given, by that."""

    vehicles: int = 0
    walkers: int = 0
    density_per_km: float | None = None  # vehicles on a km of driving lane near the route

    @property
    def is_empty(self) -> bool:
        """Whether the vehicle under test is to be alone."""
        return self == NO_TRAFFIC


NO_TRAFFIC = Traffic()


class Sumo(NamedTuple):
    """What SUMO is to do in a run."""

    file: Path | None = None  # a finished .sumocfg; None: the agent's folder, or one made of the town's map
    is_random: bool = False  # random trips instead of the demand
    vehicles: int = 0  # that random trips keep on the road
    radius_m: float | None = None  # around the vehicle under test, within which vehicles are shown; None: all
    lights: str = "carla"  # which side has the lights
    port: int | None = None  # of a SUMO that runs
    folder: str | None = None  # that the agent's config() names
    beside: Path | None = None  # the agent's file, for relative names
    hour: float | None = None  # of the day, for a demand that is made; None: the hour that the route stands for
    scale: float | None = None  # of the traffic; None: as it is
    is_sublane: bool = False  # vehicles beside each other in a lane
    has_output: bool = False  # SUMO's own outputs in the run's folder


SUMO_OFF, SUMO_DEMAND, SUMO_RANDOM = "none", "demand", "random"
RANDOM_VEHICLES = 50  # of --sumo random without --vehicles


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions(Settings):
    """The options of ``basu run`` without the scoring, which is a model of its own."""

    agent: Annotated[
        str,
        Option(
            help="a name (`basu list`), FILE.py, or FILE.py:Class",
            group=AGENT,
            positional=True,
            flag="--agent",
            metavar="AGENT",
            is_file=True,
        ),
    ] = "basic"
    agent_config: Annotated[
        str | None,
        Option(
            help="text for the setup of an agent of the leaderboard or ScenarioRunner, mostly a file's name",
            group=AGENT,
            metavar="FILE",
            is_file=True,
        ),
    ] = None
    step_limit_s: StepLimit = 10.0
    in_process: InProcess = False
    agent_memory_gb: AgentMemory = None
    debug: Debug = False

    routes: Annotated[
        str | None,
        Option(help="route XML", group=ROUTES, metavar="FILE", default_text="as the agent says", is_file=True),
    ] = None
    route_id: Annotated[
        str | None,
        Option(help="only this route of the file", group=ROUTES, metavar="ID", default_text="all", rival="route"),
    ] = None
    routes_subset: Annotated[
        str | None,
        Option(help="only these routes of the file, such as 0-3,7", group=ROUTES, metavar="LIST", rival="route"),
    ] = None
    with_scenarios: Annotated[
        bool,
        Option(
            help="leave out the scenarios of the route file",
            group=ROUTES,
            flag="--no-scenarios",
            inverted=True,
            default_text="drive with them",
        ),
    ] = True
    scenario_files: Annotated[
        tuple[Path, ...],
        Option(
            help="classes for the scenarios of the route file; may be given several times",
            group=ROUTES,
            flag="--scenarios",
            metavar="FILE.py",
            is_file=True,
        ),
    ] = ()
    repetitions: Annotated[int, Option(help="runs of each route", group=ROUTES, metavar="N", least=1)] = 1
    seed: Annotated[
        int,
        Option(
            help="seed of everything random in the first repetition; each further one has the next",
            group=CONDITIONS,
            metavar="N",
        ),
    ] = 0
    weather: Annotated[
        str | None,
        Option(
            help="one of CARLA's presets",
            group=CONDITIONS,
            metavar="NAME",
            default_text="as the route or the agent says",
        ),
    ] = None
    vehicle: Vehicle = None
    vehicles: Annotated[
        int,
        Option(
            help="other vehicles, driven by the Traffic Manager",
            group=CONDITIONS,
            metavar="N",
            least=0,
            rival="traffic",
        ),
    ] = 0
    traffic_density: Annotated[
        float | None,
        Option(
            help="other vehicles on a km of driving lane within 300 m of the route",
            group=CONDITIONS,
            metavar="N",
            unit="1/km",
            least=0.0,
            rival="traffic",
        ),
    ] = None
    walkers: Annotated[
        int, Option(help="walkers on the pavements near the route", group=CONDITIONS, metavar="N", least=0)
    ] = 0

    stop_after_s: Annotated[
        float | None,
        Option(
            help="end the drive after this simulated time; its score is not comparable",
            group=CONDITIONS,
            flag="--stop-after",
            metavar="S",
            unit="s",
            above=0.0,
            default_text="at the end of the route",
        ),
    ] = None

    sumo: Annotated[
        str | None,
        Option(
            help="drive amid SUMO's traffic: FILE.sumocfg, random (--vehicles N on random trips), demand (of the "
            "town) or none; without a word: demand",
            group=CONDITIONS,
            metavar="WHAT",
            bare=SUMO_DEMAND,
            default_text="as the agent says",
            advice="an agent is named before --sumo, as in `basu run basic --sumo`",
        ),
    ] = None
    sumo_radius_m: Annotated[
        float | None,
        Option(
            help="show SUMO's vehicles within this of the vehicle under test; the others drive on in SUMO",
            group=CONDITIONS,
            flag="--sumo-radius",
            metavar="M",
            unit="m",
            above=0.0,
            default_text="show all",
        ),
    ] = None
    sumo_lights: Annotated[
        Literal["carla", "sumo", "none"],
        Option(help="which side has the traffic lights; none: each its own", group=CONDITIONS),
    ] = "carla"
    sumo_port: Annotated[
        int | None,
        Option(
            help="TraCI port of a running SUMO on this machine",
            group=CONDITIONS,
            metavar="N",
            least=1,
            most=65_535,
            default_text="SUMO in this process",
        ),
    ] = None
    sumo_hour: Annotated[
        float | None,
        Option(
            help="hour of the day of the demand that is made, such as 17.5",
            group=CONDITIONS,
            metavar="H",
            least=0.0,
            most=23.99,
            default_text="the hour that the route stands for",
        ),
    ] = None
    sumo_scale: Annotated[
        float | None,
        Option(
            help="so many times the demand",
            group=CONDITIONS,
            metavar="X",
            least=0.0,
            default_text="the demand as it is",
        ),
    ] = None
    sumo_sublane: Annotated[
        bool, Option(help="SUMO's sub-lane model: vehicles pass each other within a lane", group=CONDITIONS)
    ] = False
    sumo_output: Annotated[
        bool,
        Option(help="keep SUMO's own outputs in the run's folder: trip information, safety measures", group=CONDITIONS),
    ] = False

    host: Host = None
    port: Port = 2000
    timeout_s: Timeout = 20.0
    workers: Annotated[
        int,
        Option(
            help="runs that are driven at the same time, each in a simulator of its own",
            group=SIMULATOR,
            metavar="N",
            least=1,
            repeats=False,
        ),
    ] = 1
    maps: Annotated[
        tuple[Path, ...],
        Option(
            help="offer every .xodr of a folder as a map; may be given several times",
            group=SIMULATOR,
            metavar="DIR",
            is_file=True,
        ),
    ] = ()
    upload_map: Annotated[
        Path | None,
        Option(
            help="send this OpenDRIVE map to the simulator at --host; routes of its town are driven there",
            group=SIMULATOR,
            metavar="FILE.xodr",
            is_file=True,
            repeats=False,
        ),
    ] = None

    metric_files: Annotated[
        tuple[Path, ...],
        Option(
            help="metrics of your own, reported beside BASU's or scored with them; may be given several times",
            group=FOLDERS,
            flag="--metrics",
            metavar="FILE.py",
            is_file=True,
        ),
    ] = ()
    record: Annotated[bool, Option(help="let the simulator write CARLA's log, recording.log", group=FOLDERS)] = False
    rosbag: Annotated[
        Literal["ros2", "ros1"] | None,
        Option(
            help="write sensors, state, control and TF as a ROS bag: a folder with MCAP for ros2, a .bag for ros1; "
            "without a word: ros2",
            group=FOLDERS,
            bare="ros2",
            default_text="write none",
            advice="an agent is named before --rosbag, as in `basu run basic --rosbag`",
        ),
    ] = None
    ros2: Annotated[
        bool,
        Option(
            help="publish the run on ROS 2 while it lasts, over DDS, in the domain of ROS_DOMAIN_ID",
            group=FOLDERS,
            repeats=False,
        ),
    ] = False
    ros1: Annotated[
        bool,
        Option(
            help="publish the run on ROS 1 while it lasts, at the roscore of ROS_MASTER_URI",
            group=FOLDERS,
            repeats=False,
        ),
    ] = False
    output: Output = Path("runs")
    series: Annotated[
        str | None,
        Option(
            help="keep all runs in a folder of this name, with their totals in series.json",
            group=FOLDERS,
            metavar="NAME",
            repeats=False,
        ),
    ] = None
    resume: Annotated[bool, Option(help="continue an interrupted --series", group=FOLDERS, repeats=False)] = False

    viewer: Annotated[
        bool,
        Option(help="stream the run to Rerun's viewer and keep it as run.rrd", group=WINDOW, repeats=False),
    ] = False
    hud: Annotated[
        Literal["camera", "map"] | None,
        Option(
            help="show a window; P takes over control; without a view: camera",
            group=WINDOW,
            bare="camera",
            advice="an agent is named before --hud, as in `basu run basic --hud`",
            repeats=False,
        ),
    ] = None
    hud_size: Annotated[
        tuple[int, int],
        Option(help="size of the window", group=WINDOW, metavar="WxH", unit="pixels", style="size", repeats=False),
    ] = (960, 540)
    hud_camera: Annotated[
        tuple[int, int],
        Option(
            help="size of the pictures of the HUD's camera, which take most of the time",
            group=WINDOW,
            metavar="WxH",
            unit="pixels",
            style="size",
            repeats=False,
        ),
    ] = (480, 270)
    hud_screenshot: Annotated[
        Path | None,
        Option(help="PNG of the window, written at the end and by F12", group=WINDOW, metavar="FILE", repeats=False),
    ] = None
    keys: Annotated[
        str | None,
        Option(
            help="play a recorded session of keys, such as data/human_session.json",
            group=WINDOW,
            metavar="FILE",
            is_file=True,
        ),
    ] = None
    record_keys: Annotated[
        Path | None,
        Option(
            help="write the keys that a person presses to a session file", group=WINDOW, metavar="FILE", repeats=False
        ),
    ] = None

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
            is_sublane=self.sumo_sublane,
            has_output=self.sumo_output,
        )

    def check(self) -> None:
        """Check what concerns several options.

        Raises:
            UserError: they contradict each other.
        """
        if self.resume and self.series is None:
            raise UserError("--resume continues a series; name it with --series, as when it was begun")
        if self.hud_screenshot is not None and self.hud is None:
            raise UserError("--hud-screenshot takes a picture of the window; add --hud")
        self._check_maps()
        self._check_sumo()
        check_agent_process(in_process=self.in_process, memory_gb=self.agent_memory_gb)
        _check_size("--hud-size", self.hud_size, WINDOWS)
        _check_size("--hud-camera", self.hud_camera, PICTURES)

    def _check_maps(self) -> None:
        """Check the folders of maps.

        Raises:
            UserError: one is none, or the simulator is not ours.
        """
        if self.maps and self.host is not None:
            raise UserError(
                "--maps is for the simulator that basu starts; give that at --host its own: `linden serve --maps DIR`"
            )
        if self.upload_map is not None and self.host is None:
            raise UserError(
                "--upload-map sends a map to the simulator at --host; without --host, --maps DIR offers a folder's maps"
            )
        for folder in self.maps:
            if not folder.is_dir():
                raise UserError(
                    f"--maps {folder} is no folder; name the one that `linden map build` writes .xodr files to"
                )

    def _check_sumo(self) -> None:
        """Check the options of SUMO.

        Raises:
            UserError: the file is no configuration of SUMO, or random trips are to be made for a demand of a density.
        """
        words = (None, SUMO_OFF, SUMO_DEMAND, SUMO_RANDOM)
        if self.sumo not in words and not str(self.sumo).endswith(".sumocfg"):
            raise UserError(f"--sumo {self.sumo}: it may be a FILE.sumocfg, random, demand or none")
        if self.sumo not in words and not Path(str(self.sumo)).is_file():
            raise UserError(f"--sumo {self.sumo}: there is no such file; write one with `linden map sumo TOWN -o DIR`")
        if self.sumo == SUMO_RANDOM and self.traffic_density is not None:
            raise UserError("--sumo random keeps --vehicles N on the road; --traffic-density goes without it")
        self._check_demand_of_sumo(is_file=self.sumo not in words)

    def _check_demand_of_sumo(self, *, is_file: bool) -> None:
        """Check the options of SUMO's demand and outputs.

        Raises:
            UserError: there is no demand to which it applies.
        """
        said = {
            "--sumo-hour": self.sumo_hour is not None,
            "--sumo-scale": self.sumo_scale is not None,
            "--sumo-sublane": self.sumo_sublane,
            "--sumo-output": self.sumo_output,
        }
        named = [flag for flag, given in said.items() if given]
        if named and self.sumo_port is not None:
            raise UserError(f"{named[0]} is for a SUMO that basu starts; give yours at --sumo-port its own options")
        if self.sumo == SUMO_RANDOM and (self.sumo_hour is not None or self.sumo_scale is not None):
            raise UserError(f"{named[0]} is for a demand; --sumo random keeps --vehicles N on the road")
        if is_file and self.sumo_hour is not None:
            raise UserError(f"--sumo-hour is for a demand that basu makes; {self.sumo} has its own")


def check_agent_process(*, in_process: bool, memory_gb: float | None) -> None:
    """Check the options of the agent's process.

    Raises:
        UserError: there is to be none, and its memory is to be limited.
    """
    if in_process and memory_gb is not None:
        raise UserError("--agent-memory limits the agent's own process, and --in-process gives it none; choose one")


def _check_size(flag: str, size: tuple[int, int], allowed: tuple[tuple[int, int], tuple[int, int]]) -> None:
    """Check that a size lies within the smallest and the largest.

    Raises:
        UserError: it does not.
    """
    (width, height), (least, most) = size, allowed
    if not (least[0] <= width <= most[0] and least[1] <= height <= most[1]):
        raise UserError(f"{flag} {width}x{height}: it may be from {least[0]}x{least[1]} to {most[0]}x{most[1]} pixels")
