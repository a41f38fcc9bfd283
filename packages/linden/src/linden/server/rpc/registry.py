"""The functions a client can call: registered by name, their arguments checked by their annotations, their errors told.

::

    @method("set_actor_location")
    def set_actor_location(context: Context, actor_id: U32, location: Vector3D) -> None: ...

A result annotated None is CARLA's void. Any other result is encoded by its annotation
(:mod:`linden.protocol.wire.decode`).

A handler with long work yields it, and goes on with what was made. The work is done in the background, where it may
change nothing that others see; meanwhile the server serves everybody but the client that waits::

    @method("copy_opendrive_to_file")
    def copy_opendrive_to_file(context: Context, text: str) -> Long[None]:
        made = yield lambda: make(text)
        context.maps.keep(made)
"""

import importlib
import inspect
import pkgutil
from collections.abc import Callable, Generator
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar, get_args, get_origin, get_type_hints

import linden.server.rpc
from linden import CARLA_VERSION, __version__
from linden.background import Unwanted, in_background
from linden.errors import Refusal
from linden.protocol.wire import rpc
from linden.protocol.wire.client_functions import CARLA_FUNCTIONS
from linden.protocol.wire.decode import Decoder, WireTypeError, decoder
from linden.protocol.wire.rpc import Call, Encoder, Reply, encoder
from linden.server.rpc.context import Context
from linden.server.rpc.warning_log import shortened
from linden.simulation.actor_table import ActorRefusal

_QUOTED = 100  # characters of a function's name; CARLA's longest has 39

Handler = Callable[..., Any]
Made = TypeVar("Made")
Work: TypeAlias = Callable[[], Any]
Long: TypeAlias = Generator[Work, Any, Made]
"""What a handler with long work returns; its result travels as ``Made``."""


@dataclass(frozen=True, slots=True)
class Method:
    """One function: what it is called with, and how its result travels."""

    name: str
    handler: Handler
    parameters: tuple[tuple[str, Decoder], ...]
    encode: Encoder | None
    reply: Reply
    advances: bool
    """Whether it may make frames, and so has to wait for slow subscribers."""

    def arguments(self, raw: list[Any]) -> list[Any]:
        """Return the typed arguments.

        Raises:
            WireTypeError: their number or the type of one is wrong; says which, and what was expected.
        """
        if len(raw) != len(self.parameters):
            names = ", ".join(name for name, _ in self.parameters) or "none"
            raise WireTypeError(f"{self.name} takes {len(self.parameters)} arguments ({names}), got {len(raw)}")
        decoded = []
        try:
            for value, (_, decode) in zip(raw, self.parameters, strict=True):
                decoded.append(decode(value))
        except WireTypeError as error:
            position = len(decoded)
            raise error.inside(f"{self.name}: argument {position + 1} ({self.parameters[position][0]})") from None
        return decoded


METHODS: dict[str, Method] = {}
"""Every registered function by its name on the wire."""


def method(name: str, *, bare: bool = False, advances: bool = False) -> Callable[[Handler], Handler]:
    """Register the decorated function under its name on the wire.

    Args:
        name: as the official client calls it.
        bare: the result carries its own wrapping, as that of ``apply_batch`` does.
        advances: the function may make frames.

    Raises:
        ValueError: CARLA 0.9.16 has no such function, or it is registered already: a mistake of ours, found at start.
    """

    def register(handler: Handler) -> Handler:
        if name not in CARLA_FUNCTIONS or name in METHODS:
            raise ValueError(f"{name!r} cannot be registered: it is no function of CARLA's, or registered twice")
        hints = get_type_hints(handler, include_extras=True)
        parameters = list(inspect.signature(handler).parameters)[1:]
        result = hints["return"]
        if get_origin(result) is Generator:
            result = get_args(result)[-1]
        METHODS[name] = Method(
            name=name,
            handler=handler,
            parameters=tuple((parameter.lstrip("_"), decoder(hints[parameter])) for parameter in parameters),
            encode=None if bare else encoder(result),
            reply=Reply.BARE if bare else Reply.VOID if result is type(None) else Reply.VALUE,
            advances=advances,
        )
        return handler

    return register


def load_handlers() -> None:
    """Import every module of this package, so that what they register is there."""
    for module in sorted(found.name for found in pkgutil.iter_modules(linden.server.rpc.__path__)):
        importlib.import_module(f"{linden.server.rpc.__name__}.{module}")


def advances(call: Call) -> bool:
    """Whether a call may make frames; a batch does where its last argument says so."""
    found = METHODS.get(call.method)
    if found is None or not found.advances:
        return False
    return call.method != "apply_batch" or call.args[-1:] != [False]


class SuspendedCall:
    """A call with work in the background; its handler continues when the work is done."""

    def __init__(self, call: Call, steps: "Generator[Work, Any, Any]", work: Work) -> None:
        self.call = call
        self.steps = steps
        self._unwanted = Unwanted()
        self.made: Future[Any] = in_background(work, self._unwanted)

    def give_up(self) -> None:
        """End the work at its next checkpoint: the client has gone."""
        self._unwanted.set()


def dispatch(context: Context, call: Call) -> bytes | SuspendedCall:
    """Carry out one call and return the bytes of its answer; nothing a client sends makes it raise.

    Where the handler asks for long work, what is returned is to be gone on with by :func:`go_on` when it is done.
    """
    found = METHODS.get(call.method)
    if found is None:
        return _missing(context, call)

    def begin() -> bytes | SuspendedCall:
        result = found.handler(context, *found.arguments(call.args))
        if isinstance(result, Generator):
            return _step(found, call, result, lambda: next(result))
        return _answer(found, call, result)

    return _guarded(context, call, found, begin)


def go_on(context: Context, unanswered: SuspendedCall) -> bytes | SuspendedCall:
    """Continue a call after its long work; returns as :func:`dispatch` does."""
    call, steps, found = unanswered.call, unanswered.steps, METHODS[unanswered.call.method]

    def step() -> Work:
        error = unanswered.made.exception()
        work: Work = steps.send(unanswered.made.result()) if error is None else steps.throw(error)
        return work

    return _guarded(context, call, found, lambda: _step(found, call, steps, step))


def _step(
    found: Method, call: Call, steps: "Generator[Work, Any, Any]", step: Callable[[], Work]
) -> bytes | SuspendedCall:
    """Let a handler go on to its next long work, or to its end."""
    try:
        work = step()
    except StopIteration as end:
        return _answer(found, call, end.value)
    return SuspendedCall(call, steps, work)


def _answer(found: Method, call: Call, result: Any) -> bytes:  # noqa: ANN401 - what a handler returns
    if found.reply is Reply.VALUE:
        return rpc.value(call, found.encode(result) if found.encode else result)
    return rpc.void(call) if found.reply is Reply.VOID else rpc.bare(call, result)


def _guarded(
    context: Context, call: Call, found: Method, act: Callable[[], bytes | SuspendedCall]
) -> bytes | SuspendedCall:
    """Return what ``act`` returns, or the bytes of a refusal."""
    try:
        return act()
    except Refusal as refusal:
        return _refuse(context, call, told(call.method, refusal), found.reply)
    except MemoryError:
        sentence = f"{call.method} is refused: the server's memory does not suffice for it; ask for less at once"
        context.log_bug(sentence)
        return _refuse(context, call, sentence, found.reply)
    except Exception as error:  # noqa: BLE001 - a bug of ours must not end everybody's session
        context.log_bug(f"internal error in {call.method}; the call is refused and the server goes on.", error)
        sentence = (
            f"internal error of linden {__version__} in {call.method}: {type(error).__name__}: {error}; the server "
            f"goes on, its log has the traceback"
        )
        return _refuse(context, call, sentence, found.reply)


def told(function: str, refusal: Refusal) -> str:
    """Return a refusal as the client reads it; where an actor is at fault, CARLA names the function first."""
    return (
        f"Responding error from function {function}: {refusal}" if isinstance(refusal, ActorRefusal) else str(refusal)
    )


def _missing(context: Context, call: Call) -> bytes:
    reply = CARLA_FUNCTIONS.get(call.method)
    if reply is None:
        sentence = f"linden has no method '{call.method[:_QUOTED]}', nor has CARLA {CARLA_VERSION}"
        context.warn_once(sentence)
        return rpc.unknown(call, sentence)
    sentence = f"linden has no method '{call.method}': CARLA {CARLA_VERSION} has it, linden {__version__} not yet"
    return _refuse(context, call, sentence, reply)


def _refuse(context: Context, call: Call, sentence: str, reply: Reply) -> bytes:
    """Refuse a call; the log gets the sentence where the client does not read it or cannot be told."""
    sentence = shortened(sentence)
    if call.is_async or reply is Reply.BARE:
        context.warn_once(f"{sentence} (told here, because the client of this call cannot be)")
    return rpc.refusal(call, sentence, reply)
