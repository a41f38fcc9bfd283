from pathlib import Path

from fakes import recordings as made
from linden.replay.file.read import Recording
from linden.replay.file.reports import blocked

HEADING = "    Time     Id Actor                                 Duration\n"


def drive(tmp_path: Path, *x_m: tuple[float, float]) -> Path:
    """Two actors, 7 and 8, whose places along x are told for each frame of a second."""
    cast = made.added(made.actor(7, "vehicle.tesla.model3", 1), made.actor(8, "vehicle.audi.tt", 1))
    frames = []
    for n, (a, b) in enumerate(x_m, 1):
        where = made.positions((7, 1e5 + 100 * a, 0, 0, 0, 0, 0), (8, 2e5 + 100 * b, 0, 0, 0, 0, 0))
        duration_s = -1.0 if n == len(x_m) else 1.0
        frames.append(made.frame(n, n - 1.0, cast if n == 1 else b"", where, duration_s=duration_s))
    return made.write(tmp_path, made.header(), *frames)


def report(path: Path, min_time_s: float, min_distance_cm: float) -> str:
    with Recording(path) as recording:
        return blocked(recording, min_time_s, min_distance_cm).split("\n\n", 1)[1]


def test_stops_are_listed_longest_first_with_their_beginning(tmp_path: Path) -> None:
    path = drive(
        tmp_path, (0, 0), (9, 9), (9.5, 20), (9.5, 20.1), (9.5, 20.2), (30, 20.3), (40, 20.4), (50, 40), (60, 60)
    )
    assert report(path, 2.0, 100.0) == (
        f"{HEADING}"
        "       3      8 vehicle.audi.tt                              4\n"
        "       2      7 vehicle.tesla.model3                         3\n"
        "\nFrames: 9\nDuration: 8 seconds\n"
    )


def test_a_crawling_vehicle_moves_on_as_soon_as_the_distance_is_reached(tmp_path: Path) -> None:
    path = drive(tmp_path, *((0.4 * n, 5.0 * n) for n in range(10)))
    told = report(path, 2.0, 100.0)
    assert told.count("vehicle.tesla.model3") == 3  # three times 2 s at 0.4 m/s within less than 1 m
    assert "vehicle.audi.tt" not in told


def test_a_stop_that_lasts_to_the_end_is_shorter_by_carlas_last_frame(tmp_path: Path) -> None:
    path = drive(tmp_path, *((0.0, 5.0 * n) for n in range(6)))
    assert "       1      7 vehicle.tesla.model3                         3\n" in report(path, 2.0, 100.0)
    assert report(path, 4.0, 100.0) == f"{HEADING}\nFrames: 6\nDuration: 5 seconds\n"
