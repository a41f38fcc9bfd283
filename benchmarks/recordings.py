"""What is in recordings, and how fast they are read (CPU time): every ``.log`` of a folder, parsed to its last byte.

    python benchmarks/recordings.py FOLDER

Made for those of the real CARLA (ScenarioRunner has some in srunner/metrics/data), which are not part of this project.
A file that is none, or damaged, has the reason in its row.
"""

import argparse
import time
from pathlib import Path

from linden.replay.file.contents_report import file_info
from linden.replay.file.packets import RecordingError
from linden.replay.file.read import Recording

COLUMNS = ("frames", "seconds", "actors", "vehicles", "positions", "controls", "collisions", "MB/s", "text MB/s")


def counted(path: Path) -> list[str]:
    """Return the columns of one file.

    Raises:
        RecordingError: it cannot be read to the end.
    """
    began_s = time.process_time()
    frames = actors = vehicles = positions = controls = collisions = 0
    elapsed_s = 0.0
    with Recording(path) as recording:
        for frame in recording.frames():
            frames, elapsed_s = frames + 1, frame.elapsed_s
            actors += len(frame.added)
            vehicles += sum(actor.kind == 1 for actor in frame.added)
            positions += len(frame.positions)
            controls += len(frame.vehicles)
            collisions += len(frame.collisions)
        read_s = time.process_time() - began_s
        began_s = time.process_time()
        text = file_info(recording, show_all=True)
    told_s = time.process_time() - began_s
    speeds = f"{path.stat().st_size / read_s / 1e6:.0f}", f"{len(text) / told_s / 1e6:.1f}"
    return [str(frames), f"{elapsed_s:.2f}", *map(str, (actors, vehicles, positions, controls, collisions)), *speeds]


def row(path: Path) -> str:
    """Return a file's row, or why it has none."""
    try:
        return " ".join(f"{value:>10}" for value in counted(path))
    except RecordingError as error:
        return str(error)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    paths = sorted(parser.parse_args().folder.glob("*.log"))
    if not paths:
        raise SystemExit("no .log in that folder")
    width = max(len(path.name) for path in paths)
    print(f"{'':{width}} " + " ".join(f"{name:>10}" for name in COLUMNS))
    for path in paths:
        print(f"{path.name:{width}} {row(path)}", flush=True)


if __name__ == "__main__":
    main()
