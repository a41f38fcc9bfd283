"""`AttachedWindow`: the window of a running server. The server loads this module for ``linden serve --window``."""

import importlib.util
import logging
from typing import TYPE_CHECKING

from linden.server.rpc.context import Follower
from linden_window.control import carry_out
from linden_window.errands import Errands
from linden_window.link import PageLink, StartingLink
from linden_window.observer import WorldObserver
from linden_window.sensor_panes import SensorPanes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from linden.sensors.runtime.measure import Measurement
    from linden.server.frame_clock import FrameClock
    from linden.server.loop import Server

log = logging.getLogger("linden")


class AttachedWindow:
    """Starts the process of the pages, sends it the frames of a server, and carries out the orders of pages."""

    def __init__(self, *, may_control: bool, port: int) -> None:
        """Start the process, which takes a second, while the server starts."""
        self._starting = StartingLink(*(("--control",) if may_control else ()), port=port)
        self._link: PageLink | None = None

    def attach(self, server: "Server") -> str:
        """Show a server's world from now on; return the address of the page.

        Raises:
            UserError: the port of the page is taken.
        """
        self._link = link = self._starting.ready()
        context = server.context
        observer = WorldObserver(context.world, link)
        sensors = SensorPanes(context.world, link)
        errands = Errands(context.world, lambda text: link.note({"type": "says", "text": text}))

        def read(clock: "FrameClock") -> bool:
            for order in link.orders():
                if order["order"] == "pages":
                    observer.has_pages(order["count"])
                elif order["order"] in ("sensors", "left"):
                    sensors.wish(order["page"], order.get("names"))
                elif answer := carry_out(order, context, clock, errands):
                    link.note({"type": "says", "text": answer})
            return link.is_open

        def after_frame(measured: "Sequence[Measurement]") -> None:
            observer.after_frame()
            sensors.after_frame(measured)

        server.follow(Follower("window", after_frame, errands.before_frame), link.fileno(), read)
        observer.after_frame()  # the map, so that its scene is ready before the first page
        return link.address

    def close(self) -> None:
        """End the process of the pages."""
        if self._link is None:
            self._starting.end()
        else:
            self._link.close()


if importlib.util.find_spec("websockets") is None:
    raise ModuleNotFoundError("there is no package websockets", name="websockets")
