"""Claims about workers on a Ray cluster: a lost node costs no job, and a cluster that is not there is named."""

import itertools
import time
from collections.abc import Iterator

import pytest

from basu.errors import UserError
from basu.jobs.job import Done, Job, Lost, PlayerSpec
from basu.jobs.pool import Pool
from ray_clusters import connected_cluster, no_other_cluster

pytest.importorskip("ray")

from basu.jobs.cluster import RayBackend


def test_a_node_that_is_removed_loses_no_job_and_counts_none_twice(player: str) -> None:
    with connected_cluster(cpus=1) as cluster:
        node = cluster.add_node(num_cpus=1, object_store_memory=80_000_000)
        backend = RayBackend(PlayerSpec(player, ()), "auto")
        assert backend.processors() == 2
        pool = Pool(backend, 2)
        answers, removed, give_up_s = list[Done | Lost](), list[int](), time.monotonic() + 120.0

        def jobs() -> Iterator[Job]:
            """Jobs until both nodes have played and one is gone, and twenty more."""
            for number in itertools.count():
                if (removed and number >= removed[0] + 20) or time.monotonic() > give_up_s:
                    return
                yield Job(number, ("ok", ""))

        for answer in pool.play(jobs()):
            answers.append(answer)
            if not removed and len({each.value[2] for each in answers}) == 2:  # both nodes have played
                cluster.remove_node(node, allow_graceful=False)
                removed.append(len(answers))
        pool.close()
        assert removed, "one of the nodes has played no job in two minutes"
        assert sorted(answer.number for answer in answers) == list(range(len(answers)))
        assert all(isinstance(answer, Done) for answer in answers)


def test_a_cluster_that_is_not_there_is_one_sentence() -> None:
    with pytest.raises(
        UserError, match=r"no Ray cluster answers at 127\.0\.0\.1:1 .*; start one with `ray start --head`"
    ):
        RayBackend(PlayerSpec("none:none", ()), "127.0.0.1:1")


def test_without_a_cluster_on_this_machine_auto_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RAY_ADDRESS", raising=False)
    with no_other_cluster(), pytest.raises(UserError, match="no Ray cluster answers at auto"):
        RayBackend(PlayerSpec("none:none", ()), "auto")
