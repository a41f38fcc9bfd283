"""Run by sensor_rays.py in a Python that has Open3D: casts rays against triangles and says how long it took.

python peer_open3d.py SCENE.npz ANSWERS.npz ROUNDS
"""

import json
import os
import sys
import time

import numpy as np
import open3d


def main() -> None:
    scene_file, answers_file, rounds = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with np.load(scene_file) as found:
        arrays = dict(found)
    scene = open3d.t.geometry.RaycastingScene()
    began = time.perf_counter()
    scene.add_triangles(
        open3d.core.Tensor(arrays.pop("vertices")), open3d.core.Tensor(np.ascontiguousarray(arrays.pop("triangles")))
    )
    took_ms, answers = {}, {}
    for key, rays in arrays.items():
        name, shadow = key.split("|")
        tensor = open3d.core.Tensor(rays)
        ask = scene.test_occlusions if shadow == "1" else scene.cast_rays
        answer = ask(tensor)
        took_ms[name] = 1000.0 * min(timed(ask, tensor) for _ in range(rounds))
        answers[name] = (answer if shadow == "1" else answer["t_hit"]).numpy()
    np.savez(answers_file, **answers)
    version = f"Open3D {open3d.__version__}, {len(os.sched_getaffinity(0))} threads; its scene took "
    print(json.dumps({"version": version + f"{time.perf_counter() - began:.1f} s with the first rays", "ms": took_ms}))


def timed(ask: object, tensor: object) -> float:
    began = time.perf_counter()
    ask(tensor)
    return time.perf_counter() - began


if __name__ == "__main__":
    main()
