"""The link to SUMO: libsumo in this process, or TraCI to a SUMO that runs; both have the same functions."""

from __future__ import annotations

import contextlib
import io
import re
import xml.etree.ElementTree as ET  # the network is the user's own file
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.errors import SimulatorError, UserError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

INSTALL = "SUMO is not installed; install it with: pip install basu-sumo"
QUIET = ("--no-step-log", "--no-warnings", "--duration-log.disable")
VERSION = (1, 20)  # the oldest with all functions used here
NEEDED = f"at least {VERSION[0]}.{VERSION[1]} is needed"


class Link:
    """A SUMO that has loaded its network.

    ``api`` has the functions of libsumo and TraCI, by their domains. ``errors`` are what they raise.
    """

    def __init__(self, api: Any, errors: tuple[type[Exception], ...], end: Callable[[], None]) -> None:  # noqa: ANN401
        """Take over a started SUMO; ``end`` ends it."""
        self.api, self.errors, self._end = api, errors, end
        self.offset_m = (0.0, 0.0)
        self.steps = 0
        try:
            with self.answering("naming its network"):
                self.offset_m = _offset_m(Path(api.simulation.getOption("net-file")))
        except BaseException:
            self.close()
            raise

    @contextlib.contextmanager
    def answering(self, what: str) -> Iterator[None]:
        """Turn SUMO's errors into the simulator's failure at ``what``.

        Raises:
            SimulatorError: SUMO refused, or is gone.
        """
        try:
            yield
        except self.errors as error:
            raise SimulatorError(f"SUMO failed at {what} (step {self.steps}): {_text(error)}") from error

    def step(self) -> None:
        """Let SUMO make one step.

        Raises:
            SimulatorError: it did not.
        """
        with self.answering("making a step"):
            self.api.simulationStep()
        self.steps += 1

    def close(self) -> None:
        """End SUMO; it may be gone already."""
        end, self._end = self._end, lambda: None
        with contextlib.suppress(*self.errors):
            end()


def in_process(config: Path, *, step_s: float, seed: int, more: Sequence[str] = ()) -> Link:
    """Start SUMO inside this process with a configuration. A process holds one SUMO at a time.

    Raises:
        UserError: SUMO is not installed, another one is held, or it refuses the configuration.
    """
    if not config.is_file():
        raise UserError(
            f"there is no SUMO configuration {config}; name a .sumocfg, or write one with `linden map sumo`"
        )
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # it warns of versions of pyarrow that do not concern it
            import libsumo  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        raise UserError(INSTALL) from None
    errors = (libsumo.TraCIException, libsumo.FatalTraCIError)
    if libsumo.simulation.isLoaded():
        raise UserError("this process holds another SUMO already; end that run first, or begin this one by itself")
    command = ["sumo", "-c", str(config), "--step-length", f"{step_s:g}", "--seed", str(seed), *QUIET, *more]
    try:
        libsumo.start(command)
    except errors as error:
        with contextlib.suppress(*errors):
            libsumo.close()
        raise UserError(f"SUMO refuses {config}: {_reason(error, config)}") from None
    version = str(libsumo.simulation.getVersion()[1])
    if _is_too_old(version):
        libsumo.close()
        raise UserError(f"the libsumo that is installed is {version}; {NEEDED}: pip install --upgrade basu-sumo")
    return Link(libsumo, errors, libsumo.close)


def connected(host: str, port: int, *, step_s: float) -> Link:
    """Connect by TraCI to a SUMO that waits for one client (``sumo --remote-port``).

    Raises:
        UserError: SUMO is not installed, none answers there, it is too old, or its step differs.
    """
    try:
        import traci  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        raise UserError(INSTALL) from None
    errors = (traci.exceptions.TraCIException, traci.exceptions.FatalTraCIError, OSError)
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            api = traci.connect(port=port, host=host, numRetries=0)
        version, its_step_s = api.getVersion()[1], api.simulation.getDeltaT()
    except errors as error:
        raise UserError(
            f"no SUMO answers at {host}:{port}: {_text(error)}; start one with --remote-port {port}"
        ) from None
    if _is_too_old(version):
        api.close()
        raise UserError(f"the SUMO at {host}:{port} is {version}; {NEEDED}")
    if abs(its_step_s - step_s) > 1e-6:
        api.close()
        raise UserError(
            f"the SUMO at {host}:{port} makes steps of {its_step_s:g} s and the run ones of {step_s:g} s; "
            f"start it with --step-length {step_s:g}"
        )
    return Link(api, errors, api.close)


def _is_too_old(version: str) -> bool:
    """Whether a version of SUMO, such as "SUMO v1_28_0+12" or "SUMO 1.19.0", lacks functions that are used here."""
    numbers = re.findall(r"\d+", version.replace("_", "."))
    return tuple(int(number) for number in numbers[:2]) < VERSION


def _offset_m(network: Path) -> tuple[float, float]:
    """Return what the network added to the map's x and y.

    Raises:
        UserError: the file is not here, or is no network.
    """
    try:
        for _, element in ET.iterparse(network, ("start",)):  # noqa: S314 - the user's own file
            if element.tag == "location":
                x_m, y_m = (float(part) for part in element.attrib["netOffset"].split(","))
                return x_m, y_m
    except OSError as error:
        raise UserError(f"SUMO's network {network} cannot be read here: {error.strerror}") from error
    except (ET.ParseError, ValueError, KeyError) as error:
        raise UserError(f"SUMO's network {network} cannot be read: {error}") from error
    raise UserError(f"SUMO's network {network} says nothing of its location; make one with `linden map sumo`")


def _reason(error: Exception, config: Path) -> str:
    """Why SUMO did not start; it raises a bare "Process Error" where a file of the configuration is not there."""
    text = _text(error)
    if text != "Process Error":
        return text
    with contextlib.suppress(OSError, ET.ParseError):
        for element in ET.parse(config).getroot().iter():  # noqa: S314 - the user's own file
            names = (
                element.get("value", "").split(",")
                if element.tag.endswith("-files") or element.tag == "net-file"
                else []
            )
            for name in names:
                if not (config.parent / name.strip()).is_file():
                    return f"its {element.tag} {name.strip()} is not there"
    return "it could not load it; SUMO's own words stand above"


def _text(error: Exception) -> str:
    """Return what SUMO said, in one line."""
    return " ".join(str(error).split()) or type(error).__name__
