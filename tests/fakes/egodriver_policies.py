"""Policies of AlpaSim's protocol that fail in one way each, after some good answers; served over real gRPC."""

import math
import time
from collections.abc import Callable, Iterator
from concurrent import futures
from contextlib import contextmanager

import grpc
from carla_driver_interface.policies import ConstantSpeedPolicy
from carla_driver_interface.protocol import (
    DriveRequest,
    DriveResponse,
    DriveSessionRequest,
    Empty,
    SessionRequestStatus,
    Trajectory,
    VersionId,
    add_EgodriverServiceServicer_to_server,
    channel_options,
)
from carla_driver_interface.service import EgodriverServicer

GOOD = 2  # answers before the failure: the third request is that of 0.2 s
LATE_S = 30.0
FLOOD = 100_000  # poses of an answer


class FailingServicer(EgodriverServicer):
    """A policy that drives straight on, and whose later answers ``spoil`` changes."""

    def __init__(self, spoil: Callable[[DriveResponse], None]) -> None:
        super().__init__(ConstantSpeedPolicy(cruise_speed_mps=3.0))
        self._spoil = spoil
        self._answers = 0

    def drive(self, request: DriveRequest, context: grpc.ServicerContext) -> DriveResponse:
        response = super().drive(request, context)
        self._answers += 1
        if self._answers > GOOD:
            self._spoil(response)
        return response


class OtherVersion(EgodriverServicer):
    """A policy of a later version of the protocol."""

    def get_version(self, request: Empty, context: grpc.ServicerContext) -> VersionId:
        return VersionId(version_id="later", grpc_api_version=VersionId.APIVersion(major=1, minor=2))


class OtherRevision(EgodriverServicer):
    """A policy that declares an unknown revision of carla-driver-interface."""

    def get_version(self, request: Empty, context: grpc.ServicerContext) -> VersionId:
        context.send_initial_metadata((("carla-driver-interface-contract", "9"),))
        return VersionId(version_id="future")


class Refusing(EgodriverServicer):
    """A policy that cannot use the cameras."""

    def start_session(self, request: DriveSessionRequest, context: grpc.ServicerContext) -> SessionRequestStatus:
        context.abort(grpc.StatusCode.FAILED_PRECONDITION, "no camera_front")
        raise AssertionError


def nan(response: DriveResponse) -> None:
    response.trajectory.poses[2].pose.vec.y = math.nan


def empty(response: DriveResponse) -> None:
    response.trajectory.CopyFrom(Trajectory())


def stale(response: DriveResponse) -> None:
    for number, pose in enumerate(response.trajectory.poses):
        pose.timestamp_us = number


def late(response: DriveResponse) -> None:
    time.sleep(LATE_S)


def raising(response: DriveResponse) -> None:
    raise ValueError("no weights")


def ending(response: DriveResponse) -> None:
    response.terminate_session = True


def flooding(response: DriveResponse) -> None:
    """A pose each microsecond of the next 0.1 s."""
    poses, first = response.trajectory.poses, response.trajectory.poses[-1]
    response.trajectory.poses.extend([first] * FLOOD)
    for number, pose in enumerate(poses):
        pose.timestamp_us = poses[0].timestamp_us + number


SPOILS: dict[str, Callable[[DriveResponse], None]] = {
    each.__name__: each for each in (nan, empty, stale, late, raising, ending, flooding)
}


@contextmanager
def served(servicer: EgodriverServicer | None) -> Iterator[str]:
    """Serve a policy, or a gRPC server without one; yield its address."""
    server = grpc.server(futures.ThreadPoolExecutor(max_workers=8), options=channel_options())
    if servicer is not None:
        add_EgodriverServiceServicer_to_server(servicer, server)
    port = server.add_insecure_port("127.0.0.1:0")
    server.start()
    try:
        yield f"127.0.0.1:{port}"
    finally:
        server.stop(grace=None)
