"""Rays of sensors.py: our caster beside raw Embree, and beside Open3D's, on the same rays against the same triangles.

The share is of processor time, on a GPU of the clock's: there the host waits.
"""

import argparse
import json
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from rays import FAR_M, RaySet, raw, ray_sets
from sensor_peers import having
from sensor_rows import rows
from sensor_server import populate, town

from linden.sensors.casting.caster import CPU
from linden.sensors.casting.embree import EmbreeCaster
from linden.sensors.view import Seen

OPEN3D = Path(__file__).with_name("peer_open3d.py")
NO_PEER = "Open3D was not measured: name a Python that has it by --peer-python"


class Peer(NamedTuple):
    """What a peer took for a set of rays, and how far its distances are from ours."""

    ms: float
    median_mm: float
    differing: float


def compare(options: argparse.Namespace) -> None:
    """Print what rays take: by raw Embree on the CPU, by us on the device, by Open3D."""
    simulation = town(options.device)
    populate(simulation, rows()[0], options.vehicles)
    for _ in range(10):
        simulation.step(0.05)
    seen = simulation.sensor_scene.look(simulation.episode, simulation.frame)
    embree = seen.caster if isinstance(seen.caster, EmbreeCaster) else on_the_cpu(seen)
    car = next(record for record in simulation.episode.actors if record.description.id.startswith("vehicle."))
    place = simulation.episode.transform(car.id)
    above = place._replace(location=place.location._replace(z=place.location.z + 2.4))
    sets = ray_sets(embree, above, np.random.default_rng(1))
    vertices, triangles = as_one(seen)
    print(f"\n{len(triangles):,} triangles, {len(seen.instances.mesh)} bodies among them; millions of rays a second")
    peers = of_open3d(options, vertices, triangles, sets, seen) if "peers" in options.only else {}
    print(
        f"{'rays':<28}{'number':>9}{'raw Embree':>12}{'linden':>9}{'share':>8}{'Open3D':>9}"
        f"{'apart, mm':>11}{'others':>8}"
    )
    for name, case in sets.items():
        ask = seen.caster.blocked if case.shadow else seen.caster.closest
        prepare, go = raw(embree, case)
        raw_ms, ours_ms, share = raced(
            prepare, go, partial(ask, case.rays, FAR_M, coherent=case.coherent), options.frames
        )
        share = share if options.device == CPU else raw_ms / ours_ms
        count, peer = len(case.rays.origin_m), peers.get(name)
        told = f"{speed(count, peer.ms)}{peer.median_mm:>11.3f}{peer.differing:>8.2%}" if peer else f"{'-':>9}"
        print(
            f"{name:<28}{count:>9,}{speed(count, raw_ms, 12)}{speed(count, ours_ms)}{share:>8.0%}{told}",
            flush=True,
        )


def raced(
    prepare: Callable[[], None], theirs: Callable[[], object], ours: Callable[[], object], rounds: int
) -> tuple[float, float, float]:
    """Return the best times of two by the clock, ms, and how much of our processor time they would take.

    They run by turns, so that other programs disturb both alike; the share is the median of the rounds'.
    """
    ours()
    walls_s, shares = list[tuple[float, float]](), list[float]()
    for _ in range(rounds):
        prepare()
        wall_s, used_s = [time.perf_counter()], [time.process_time()]
        for work in (theirs, ours):
            work()
            wall_s.append(time.perf_counter())
            used_s.append(time.process_time())
        walls_s.append((wall_s[1] - wall_s[0], wall_s[2] - wall_s[1]))
        shares.append((used_s[1] - used_s[0]) / max(used_s[2] - used_s[1], 1e-9))
    best_raw, best_ours = (1000.0 * min(column) for column in zip(*walls_s, strict=True))
    return best_raw, best_ours, statistics.median(shares)


def speed(count: int, ms: float, width: int = 9) -> str:
    """Return millions of rays a second as a column."""
    return f"{count / ms / 1000.0:>{width}.2f}"


def on_the_cpu(seen: Seen) -> EmbreeCaster:
    """Return Embree's caster of the same scene, for rays to compare with."""
    caster = EmbreeCaster(seen.standing, list(seen.bodies))
    caster.pose(seen.instances)
    return caster


def as_one(seen: Seen) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return vertices (N, 3) and triangles (M, 3) of all there is, bodies where they are now."""
    vertices, triangles = [seen.standing.vertices_m], [seen.standing.triangles]
    count = len(vertices[0])
    for mesh, pose in zip(seen.instances.mesh, seen.instances.pose, strict=True):
        body = seen.bodies[mesh]
        vertices.append(body.vertices_m @ pose[:, :3].T + pose[:, 3])
        triangles.append(body.triangles + np.uint32(count))
        count += len(body.vertices_m)
    return np.concatenate(vertices).astype(np.float32), np.concatenate(triangles).astype(np.uint32)


def of_open3d(
    options: argparse.Namespace,
    vertices: NDArray[np.float32],
    triangles: NDArray[np.uint32],
    sets: dict[str, RaySet],
    seen: Seen,
) -> dict[str, Peer]:
    """Return what Open3D took, by set; its distances are compared with ours, where they are asked for."""
    python = having("open3d", options.peer_python)
    if python is None:
        print(NO_PEER)
        return {}
    with tempfile.TemporaryDirectory() as folder:
        scene, answers = Path(folder, "scene.npz"), Path(folder, "answers.npz")
        rays = {f"{name}|{case.shadow:d}": np.hstack(case.rays) for name, case in sets.items()}
        np.savez(scene, vertices=vertices, triangles=triangles, **rays)
        command = [str(python), str(OPEN3D), str(scene), str(answers), str(options.frames)]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode:
            print(f"Open3D was not measured: {done.stderr.strip().splitlines()[-1:]}")
            return {}
        said = json.loads(done.stdout.splitlines()[-1])
        print(said["version"])
        with np.load(answers) as found:
            return {name: apart(said["ms"][name], found[name], case, seen) for name, case in sets.items()}


def apart(ms: float, theirs: NDArray[np.float32], case: RaySet, seen: Seen) -> Peer:
    """Compare a peer's distances, or hits, with ours; "differing" are further apart than 1 mm + 1e-5 of the way."""
    if case.shadow:
        ours = seen.caster.blocked(case.rays, FAR_M)
        return Peer(ms, 0.0, float(np.mean(ours != theirs.astype(bool))))
    far = seen.caster.closest(case.rays, FAR_M).distance_m
    theirs = np.where(theirs > FAR_M, np.inf, theirs)
    both = np.isfinite(far) & np.isfinite(theirs)
    off = np.abs(far[both] - theirs[both])
    differ = np.count_nonzero(off > 1e-3 + 1e-5 * far[both]) + np.count_nonzero(np.isfinite(far) != np.isfinite(theirs))
    return Peer(ms, 1000.0 * float(np.median(off)), differ / len(far))
