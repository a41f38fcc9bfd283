"""Ray clusters of tests, one at a time on a machine: the address ``auto`` finds any cluster, of any process."""

import fcntl
import logging
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil

LOCK = Path(tempfile.gettempdir()) / "linden-tests-ray.lock"
END_S = 60.0


@contextmanager
def no_other_cluster() -> Iterator[None]:
    """Keep every other process of tests from starting a cluster within the block."""
    with LOCK.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


@contextmanager
def connected_cluster(cpus: int) -> Iterator[Any]:
    """Start a cluster with one node of ``cpus`` processors, connect this process, and yield the ``Cluster``."""
    import ray  # noqa: PLC0415 - an extra
    from ray.cluster_utils import Cluster  # noqa: PLC0415 - likewise

    with no_other_cluster():
        cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": cpus, "object_store_memory": 80_000_000})
        try:
            ray.init(address=cluster.address, logging_level=logging.ERROR, log_to_driver=False)
            yield cluster
        finally:
            ray.shutdown()
            children = psutil.Process().children(recursive=True)
            of_ray = [each for each in children if each.name() in ("gcs_server", "raylet")]
            cluster.shutdown()
            psutil.wait_procs(of_ray, timeout=END_S)  # `auto` would find a cluster that is about to end
