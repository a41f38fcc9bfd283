"""What the official wheel offers: every public class and member, from its stub files and from the module itself.

The stubs of the wheels for Python 3.10, 3.11 and 3.12 are equal byte for byte, and so are the members of their modules;
where stub and module differ, the union counts: a script may have been written by either.
"""

import ast
import inspect
from pathlib import Path
from types import BuiltinFunctionType, ModuleType

import carla
import carla.command

_PLUMBING = {"__module__", "__doc__", "__reduce__", "__instance_size__", "__dict__", "__weakref__", "__slots__"}
"""What Boost.Python gives every class; no part of CARLA."""


def surface() -> list[str]:
    """Return every public member as ``Class.member``, sorted; those of ``carla.command`` begin with ``command.``.

    A member stands where it is defined: what a vehicle inherits is ``Actor.…``.
    """
    folder = Path(inspect.getfile(carla)).parent
    members: set[str] = set()
    for prefix, module, stub in (("", carla, "libcarla.pyi"), ("command.", carla.command, "command.pyi")):
        members |= {prefix + member for member in _of_module(module)}
        members |= {prefix + member for member in _of_stub(ast.parse((folder / stub).read_text("utf-8")))}
    return sorted(members)


def _of_module(module: ModuleType) -> set[str]:
    classes = [found for name, found in vars(module).items() if inspect.isclass(found) and not name.startswith("_")]
    return {f"{found.__name__}.{name}" for found in classes for name in vars(found) if _is_public(found, name)}


def _is_public(owner: type, name: str) -> bool:
    """Whether a name is for scripts; classes that only the client makes have no constructor but one that refuses."""
    if name == "__init__":
        return type(vars(owner)[name]) is not BuiltinFunctionType  # isinstance: Boost.Python's functions pretend
    return name not in _PLUMBING and (name.startswith("__") or not name.startswith("_"))


def _of_stub(stub: ast.Module) -> set[str]:
    classes = [node for node in stub.body if isinstance(node, ast.ClassDef) and not node.name.startswith("_")]
    members = {f"{found.name}.{name}" for found in classes for name in _named(found)}
    return members | {found.name for found in classes if not _named(found)}  # a value that the stub calls a class


def _named(found: ast.ClassDef) -> set[str]:
    """Return the methods, properties and constants that a class of the stub names."""
    functions = {node.name for node in found.body if isinstance(node, ast.FunctionDef)}
    annotated = {node.target.id for node in found.body if isinstance(node, ast.AnnAssign) and _is_name(node.target)}
    assigned = {
        target.id for node in found.body if isinstance(node, ast.Assign) for target in node.targets if _is_name(target)
    }
    return functions | annotated | assigned


def _is_name(node: ast.expr) -> bool:
    return isinstance(node, ast.Name)
