"""Run by map_formats.py in a Python that has commonroad-scenario-designer: converts OpenDRIVE to Lanelet2.

    python peer_commonroad.py MAP.xodr OUT.osm

Prints seconds of the processor without the imports, MB and the count of lanelets as JSON. Its command line does not
start with current versions of click, so its function is called.
"""

import json
import resource
import sys
import time
from pathlib import Path

from crdesigner.common.config.lanelet2_config import lanelet2_config
from crdesigner.map_conversion.map_conversion_interface import opendrive_to_lanelet


def main() -> None:
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    started = time.process_time()
    lanelet2_config.autoware = True
    opendrive_to_lanelet(source, target)
    seconds = time.process_time() - started
    lanelets = target.read_text("utf-8").count('v="lanelet"')
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(json.dumps({"seconds": seconds, "memory": memory_mb, "lanelets": lanelets}))


if __name__ == "__main__":
    main()
