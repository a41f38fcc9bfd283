"""``linden gate``: a gate before a server, behind which a client can drive one vehicle and nothing else.

Without ``--vehicle`` a benchmark opens and closes gates by lines on stdin.
"""

import argparse
import os
import sys

from linden.cli.serve import DEFAULT_PORT
from linden.errors import ProtocolError, UserError

READ_AT_ONCE = 1 << 16
TRACKS = ("world", "objects", "sensors")


def add_parser(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command ``gate``."""
    gate = commands.add_parser("gate", help="let a client drive one vehicle and nothing else", description=__doc__)
    gate.add_argument(
        "--host", default="127.0.0.1", help="of the server, CARLA's own or linden's (default: %(default)s)"
    )
    gate.add_argument("--port", type=int, default=DEFAULT_PORT, help="its RPC port (default: %(default)s)")
    gate.add_argument("--vehicle", type=int, metavar="ID", help="open a gate at once: the actor that the client drives")
    gate.add_argument(
        "--track", choices=("world", "sensors"), default="world", help="what it learns of other actors (default: world)"
    )
    gate.add_argument("--sensor", type=int, action="append", default=[], metavar="ID", help="a sensor that it may hear")
    gate.set_defaults(command=run)


def run(arguments: argparse.Namespace) -> int:
    """Serve until SIGINT, SIGTERM, or the end of stdin.

    Raises:
        UserError: stdin holds no order.
    """
    # here, not above: the command line of each other command does without them
    from linden.gate.calls import Track  # noqa: PLC0415 - see above
    from linden.gate.control import Control  # noqa: PLC0415 - see above
    from linden.server.gate_relay import Relay  # noqa: PLC0415 - see above

    relay = Relay(arguments.host, arguments.port)
    control = Control(relay, _say)

    def order() -> None:
        data = os.read(sys.stdin.fileno(), READ_AT_ONCE)
        if not data:
            relay.stop()
        try:
            control.receive(data)
        except ProtocolError as error:
            raise UserError(f"{error}; see docs/reference/gate.md for the orders") from error

    if arguments.vehicle is None:
        relay.watch(sys.stdin.fileno(), order)
    else:
        ports = relay.open_gate(Track(arguments.track), arguments.vehicle, ())
        relay.add_sensors(arguments.vehicle, arguments.sensor)
        _say(f"linden: gate ready, rpc port {ports.rpc}, streaming port {ports.streaming}")
    try:
        relay.run()
    except KeyboardInterrupt:
        return 0
    return 0


def _say(line: str) -> None:
    print(line, flush=True)  # noqa: T201 - what a command says to its user
