"""``basu ros scans``: the clouds in a ROS bag as files, for a point cloud map."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.output.report.documents import make_draft, publish
from basu_ros.bag_scans import write_scans

if TYPE_CHECKING:
    import argparse
    from pathlib import Path


def run(arguments: argparse.Namespace) -> int:
    """Write the clouds of a lidar in a bag, and its poses in the map."""
    output: Path = arguments.output
    if output.exists():
        raise UserError(f"{output} exists already; name another place with --output, or remove it")
    if arguments.every < 1:
        raise UserError(f"--every is {arguments.every}; it is a number of clouds, 1 or more")
    draft = make_draft(output.parent, output.name)
    try:
        count = write_scans(arguments.bag, draft, arguments.topic, arguments.every)
        folder = publish(draft, output.name)
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise
    print(f"scans             {folder} ({count} clouds); `linden map pointcloud --from {folder} -o map.pcd` joins them")
    return 0
