"""Arguments of ``basu serve egodriver`` and ``basu serve sensorsim``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from basu.cli.later import later
from basu.plugins import Command

if TYPE_CHECKING:
    import argparse

LENGTHS = (
    ("--wheelbase", 2.87, "from axle to axle"),
    ("--rear-axle", 1.44, "from the rear axle to the vehicle's origin"),
    ("--front", 2.4, "from the origin to the front bumper"),
    ("--rear", 2.4, "from the origin to the rear bumper"),
    ("--width", 2.16, "over all"),
)
"""Of CARLA's vehicle.tesla.model3, rounded; its origin is midway between the axles."""
AGENTS = ("basic", "behavioral", "behavioral-cautious", "behavioral-aggressive", "blind", "creeper")
"""The keys of ``basu_alpasim.basic_policy.OFFERED``, which is slow to import; a test compares them."""
RENDERER_PORT = 50052
PORT = 50051  # of carla-driver-interface and of AlpaSim's own driver


def add_serve(serve: argparse.ArgumentParser) -> None:
    """Add the protocols of ``basu serve``."""
    protocols = serve.add_subparsers(title="protocols", required=True, metavar="PROTOCOL")
    egodriver = protocols.add_parser("egodriver", help="offer an agent as a policy of AlpaSim")
    egodriver.description = (
        "Offer an agent of BASU as a driving policy behind AlpaSim's egodriver protocol, until Ctrl-C."
    )
    egodriver.add_argument("agent", choices=AGENTS, metavar="AGENT", help=f"the agent: {', '.join(AGENTS)}")
    egodriver.add_argument("--host", default="127.0.0.1", metavar="HOST", help="where to listen (default: %(default)s)")
    egodriver.add_argument("--port", type=int, default=PORT, metavar="N", help="0: a free one (default: %(default)s)")
    egodriver.add_argument(
        "--routes", type=Path, metavar="FILE.xml", help="a route that the policy knows beforehand, with its signs"
    )
    egodriver.add_argument("--route-id", metavar="ID", help="which one of the file (default: the only one)")
    egodriver.add_argument("--map", type=Path, metavar="FILE.xodr", help="the map of --routes")
    egodriver.add_argument("--cruise", type=float, metavar="M/S", help="never faster than this")
    egodriver.add_argument(
        "--alpasim", action="store_true", help="the simulator is AlpaSim, which sends no data of CARLA's"
    )
    lengths = egodriver.add_argument_group(
        "the vehicle", "The protocol does not tell it; the defaults are a Model 3's."
    )
    for name, value, what in LENGTHS:
        lengths.add_argument(name, type=float, default=value, metavar="M", help=f"{what} (default: %(default)s)")
    egodriver.set_defaults(command=later("basu_alpasim.serve:run"))
    _add_sensorsim(
        protocols.add_parser("sensorsim", help="offer finished runs to AlpaSim, which asks for pictures of them")
    )


def _add_sensorsim(sensorsim: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu serve sensorsim``."""
    sensorsim.description = (
        "Offer finished runs as scenes of AlpaSim's sensorsim protocol until Ctrl-C. A scene has the run's map, "
        "trajectory, cameras and other actors. AlpaSim asks for pictures from any pose."
    )
    sensorsim.add_argument(
        "runs", nargs="+", type=Path, metavar="RUN", help="a run's folder; its name is the scene's id"
    )
    sensorsim.add_argument("--host", default="127.0.0.1", metavar="HOST", help="where to listen (default: %(default)s)")
    sensorsim.add_argument(
        "--port", type=int, default=RENDERER_PORT, metavar="N", help="0: a free one (default: %(default)s)"
    )
    sensorsim.add_argument(
        "--sensors",
        type=Path,
        metavar="FILE.json",
        help="the cameras that a scene declares (default: one of 120 degrees)",
    )
    sensorsim.add_argument(
        "--simulator", metavar="HOST:PORT", help="a running simulator that nothing else uses (default: starts one)"
    )
    sensorsim.add_argument(
        "--timeout", type=float, default=120.0, metavar="S", help="wall time for a picture (default: %(default)s)"
    )
    name, value, what = LENGTHS[1]
    sensorsim.add_argument(name, type=float, default=value, metavar="M", help=f"{what} (default: %(default)s)")
    sensorsim.set_defaults(command=later("basu_alpasim.serve_scenes:run"))


SERVE = Command("offer an agent or a renderer to another simulator", add_serve)
