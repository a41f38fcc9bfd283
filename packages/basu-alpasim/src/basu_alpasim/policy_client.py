"""`PolicyClient`: calls a policy's ``egodriver`` service with time limits; a failed call is the agent's failure.

Each sentence names the call, the address and the simulated time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import grpc
from carla_driver_interface.contract import (
    CONTRACT_REVISION,
    LEGACY_REVISION,
    ContractError,
    contract_metadata,
    read_revision,
)
from carla_driver_interface.protocol import (
    ALPASIM_API_VERSION,
    DriveSessionCloseRequest,
    EgodriverServiceStub,
    Empty,
    channel_options,
)

from basu.agents.calls import OverrunError
from basu.errors import AgentCrashedError, AgentTimedOutError, UserError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from carla_driver_interface.protocol import DriveSessionRequest, VersionId

CLOSE_S = 2.0  # wall time for a policy to close a session, which changes no result
WITHOUT_METADATA = "carla-driver-interface-"  # in the version of its servers of the first revision


class Call(NamedTuple):
    """A call of the service: its name in the protocol, and its request."""

    name: str
    request: Any


class PolicyClient:
    """A connection to one policy.

    Attributes:
        address: HOST:PORT, or a Unix socket as gRPC writes it.
        version: what the policy calls itself.
        revision: how it understands a camera's pose; see ``carla_driver_interface.contract``.
    """

    def __init__(self, address: str) -> None:
        """Prepare a connection; none is opened yet.

        Raises:
            UserError: the address has no port.
        """
        if not address.startswith("unix:") and not address.rpartition(":")[2].isdigit():
            raise UserError(f"'{address}' is no address of a policy; write egodriver:HOST:PORT")
        self.address = address
        self.version = ""
        self.revision = CONTRACT_REVISION
        # a proxy of the environment is for the internet, not for a policy
        options = [*channel_options(), ("grpc.enable_http_proxy", 0)]
        self._channel = grpc.insecure_channel(address, options=options)
        self._stub: Any = EgodriverServiceStub(self._channel)  # type: ignore[no-untyped-call]  # generated code
        self._session: str | None = None

    def await_ready(self, within_s: float) -> None:
        """Wait until the service answers, and agree on a version with it.

        Raises:
            AgentTimedOutError: nothing answers at the address, or it gives no version within ``within_s`` of wall time.
            AgentCrashedError: it is no policy, or speaks another version.
        """
        ready = grpc.channel_ready_future(self._channel)
        try:
            ready.result(timeout=within_s)
        except grpc.FutureTimeoutError:
            raise AgentTimedOutError(
                f"no policy answers at {self.address} within {within_s:g} s of wall time; start it, and give its "
                "address as egodriver:HOST:PORT"
            ) from None
        finally:
            ready.cancel()
        asked = self._stub.get_version.future(Empty(), timeout=within_s)
        version: VersionId = self._answer("get_version", asked, 0)
        self.version = version.version_id
        self._agree(version, asked.initial_metadata())

    def start(self, request: DriveSessionRequest, time_us: int) -> None:
        """Start the session of a drive.

        Raises:
            AgentError: the policy refuses it, or does not answer.
        """
        metadata = contract_metadata(self.revision)
        self._answer("start_session", self._stub.start_session.future(request, metadata=metadata), time_us)
        self._session = request.session_uuid

    def call(self, calls: Sequence[Call], time_us: int) -> list[Any]:
        """Make calls at once, and return their answers once all are there.

        Raises:
            AgentError: one of them fails, or is not answered within the limit of a step.
        """
        asked = [(call.name, getattr(self._stub, call.name).future(call.request)) for call in calls]
        try:
            return [self._answer(name, future, time_us) for name, future in asked]
        finally:
            for _, future in asked:
                future.cancel()  # nothing happens to one that is answered

    def close(self) -> None:
        """Close the session, if one is open, and the connection."""
        session, self._session = self._session, None
        if session is not None:
            asked = self._stub.close_session.future(DriveSessionCloseRequest(session_uuid=session), timeout=CLOSE_S)
            asked.exception()  # a policy that is gone cannot close a session
        self._channel.close()

    def _agree(self, version: VersionId, metadata: Any) -> None:  # noqa: ANN401 - gRPC has no types
        """Take over the policy's revision.

        Raises:
            AgentCrashedError: its version of the protocol is not ours.
        """
        theirs, ours = version.grpc_api_version, ALPASIM_API_VERSION
        if theirs.major != ours.major:
            raise AgentCrashedError(
                f"the policy '{self.version}' at {self.address} answers get_version with version {theirs.major}."
                f"{theirs.minor}.{theirs.patch} of AlpaSim's protocol, and this is {ours.major}.{ours.minor}."
                f"{ours.patch}; use a policy of version {ours.major}"
            )
        silent = LEGACY_REVISION if WITHOUT_METADATA in self.version else CONTRACT_REVISION
        try:
            self.revision = read_revision(metadata, silent)
        except ContractError as error:
            raise AgentCrashedError(
                f"the policy '{self.version}' at {self.address} answers get_version with another version: {error}; "
                "install a carla-driver-interface that both sides know"
            ) from None

    def _answer(self, name: str, asked: Any, time_us: int) -> Any:  # noqa: ANN401 - gRPC has no types
        """Wait for an answer.

        Raises:
            AgentError: there is none.
        """
        at = f"{name} at {time_us * 1e-6:.2f} s"
        try:
            return asked.result()
        except OverrunError:
            asked.cancel()
            raise AgentTimedOutError(
                f"the policy at {self.address} did not answer {at} within the limit of a call; see its own output, or "
                "give it more with --step-limit"
            ) from None
        except grpc.RpcError as error:
            raise self._failure(at, error) from None

    def _failure(self, at: str, error: grpc.RpcError) -> AgentCrashedError | AgentTimedOutError:
        """Return the agent's failure for a call that failed."""
        code, details = error.code(), error.details()
        if code is grpc.StatusCode.UNAVAILABLE:
            return AgentCrashedError(
                f"the policy at {self.address} was gone before it answered {at}; see its own output"
            )
        if code is grpc.StatusCode.UNIMPLEMENTED:
            return AgentCrashedError(
                f"the service at {self.address} does not know the call {at}: it is no policy of AlpaSim's egodriver "
                "protocol, or of another version"
            )
        if code is grpc.StatusCode.DEADLINE_EXCEEDED:
            return AgentTimedOutError(f"the policy at {self.address} did not answer {at} in time; see its own output")
        return AgentCrashedError(f"the policy at {self.address} refused {at}: {code.name}: {details}")
