"""A server that simulates nothing: every tick shows the actors where they were spawned. The limit that ticks.py names.

Wire, handlers and snapshot are linden's own, so what is left is the client's time and the way between the two.
"""

from linden.maps.library import HOME_MAP, MapLibrary
from linden.server import frames
from linden.server.loop import Server
from linden.server.ports import open_ports, port_of
from linden.server.rpc import registry
from linden.world import World


class StillWorld(World):
    """Time passes, and nothing else does."""

    def step(self, dt_s: float) -> None:
        self.frame += 1
        self.delta_s = dt_s
        self.episode.elapsed_s += dt_s
        if len(self.episode.actors) != self._shown:
            self.episode.observe()
            self._shown = len(self.episode.actors)

    _shown = -1


def main() -> None:
    registry.load_handlers()
    maps = MapLibrary()
    ports = open_ports("127.0.0.1", 0, None)
    server = Server(StillWorld(maps.load(HOME_MAP)), maps, frames, ports)
    print(f"linden: ready, rpc port {port_of(ports.rpc)}, streaming port {port_of(ports.streaming)}", flush=True)
    server.run()


if __name__ == "__main__":
    main()
