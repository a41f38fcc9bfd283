"""The speed of sensors: cameras, lidars, a whole rig, and rays beside raw Embree and Open3D on the same rays.

    python benchmarks/sensors.py [--device cpu|cuda] [--in-process] [--frames 30] [--vehicles 50]
                              [--only table rays ...] [--peer-python PATH ...]

A car drives in Linden among others and carries the sensors of a row; all of them measure in every frame. A frame is
done when all of it is in the official client's hands. With ``--in-process`` there is neither wire nor client, and the
server itself makes the frame and the messages; this needs no ``carla``. "server ms" is processor time, of all cores.

Peers are measured in the same run by a Python in which they are installed (``open3d`` or ``open3d-cpu``,
``metadrive-simulator``); without ``--peer-python`` a sentence says that they were not.
"""

import argparse
import os
import platform
from pathlib import Path

import sensor_rows

PARTS = ("table", "rays", "peers")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cpu", help="where linden casts rays: cpu or cuda (default: %(default)s)")
    parser.add_argument("--in-process", action="store_true", help="the server alone, without wire and client")
    parser.add_argument("--frames", type=int, default=30, help="a row (default: %(default)s)")
    parser.add_argument("--vehicles", type=int, default=50, help="on the streets (default: %(default)s)")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS, help="parts of it (default: all)")
    parser.add_argument("--rows", default="", metavar="WORD", help="only rows of the table with this in their name")
    parser.add_argument(
        "--peer-python", type=Path, nargs="+", default=[], metavar="PATH", help="Pythons in which peers are installed"
    )
    options = parser.parse_args()
    print(f"{machine()}; device {options.device}; load of the last minute before this: {os.getloadavg()[0]:.1f}\n")
    if "table" in options.only:
        table(options)
    if "rays" in options.only or "peers" in options.only:
        import sensor_rays  # noqa: PLC0415 - builds what it needs of Embree when it is imported

        sensor_rays.compare(options)
    if "peers" in options.only:
        import sensor_peers  # noqa: PLC0415 - beside sensor_rays

        sensor_peers.drive(options.peer_python, options.frames)


def table(options: argparse.Namespace) -> None:
    """Print what frames take."""
    if options.in_process:
        from sensor_server import measured  # noqa: PLC0415 - one of two
    else:
        from sensor_client import measured  # noqa: PLC0415 - needs the official client
    rows = tuple(row for row in sensor_rows.rows() if options.rows in row.name)
    print(f"{'in the server' if options.in_process else 'through the official client'}, {options.vehicles} vehicles")
    print(sensor_rows.head())
    for row, found in measured(options.device, rows, options.vehicles, options.frames):
        print(sensor_rows.line(row, found), flush=True)


def machine() -> str:
    """Name the processor."""
    lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    model = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.machine())
    return f"{model}, {len(os.sched_getaffinity(0))} cores"


if __name__ == "__main__":
    main()
