"""Makes a settings model from layers of given values: a file below the command line, or keyword arguments.

Every value passes one check, whatever it comes from. A complaint names the option as its source does: the flag on the
command line, path and key of a file, the keyword in Python.
"""

from __future__ import annotations

import enum
import json
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar, get_args

from pydantic import TypeAdapter, ValidationError

from basu.errors import UserError
from basu.settings.option import Field, Layer, OptionError, Settings, fields_of, gone_from, suggestion, to_json

Model = TypeVar("Model", bound=Settings)

MUST = {  # by pydantic's error types
    "bool_type": "true or false",
    "dict_type": "an object",
    "dataclass_type": "an object",
    "finite_number": "a finite number",
    "float_type": "a number",
    "int_type": "a whole number",
    "mapping_type": "an object",
    "path_type": "a text",
    "string_type": "a text",
    "tuple_type": "a list",
    "arguments_type": "an object",
}


def resolve(model: type[Model], layers: Sequence[Layer]) -> Model:
    """The model with the values of all layers; a later layer goes before an earlier one.

    Raises:
        UserError: an option that does not exist, a value that it cannot have, options that contradict each other.
    """
    merged: dict[str, Any] = {}
    origin: dict[str, Layer] = {}
    for layer in layers:
        values = _known(model, layer)
        _clear_rivals(model, layer, values, merged)
        for name, value in values.items():
            merged[name] = {**merged.get(name, _usual(model, name)), **value} if isinstance(value, dict) else value
            origin[name] = layer
    try:
        return _validated(model, json.dumps(merged))
    except ValidationError as error:
        raise _sentence(model, error, origin) from None
    except OptionError as error:
        layer = origin.get(error.name.partition(".")[0], Layer({}))
        unit = _unit(model, error.name)
        raise UserError(f"{layer.name(model, error.name)} is {error.value:g}{unit}; it must be {error.must}") from None
    except UserError as error:
        sources = {layer.source for layer in origin.values()}
        raise UserError(
            f"{sources.pop()}: {error}" if len(sources) == 1 and "" not in sources else str(error)
        ) from None


def from_keywords(model: type[Model], **given: object) -> Model:
    """The model of keyword arguments; paths, enums and tuples are as welcome as their JSON.

    Raises:
        UserError: as ``resolve``; the sentence names the keyword.
    """
    return resolve(model, [Layer(given)])


_ADAPTERS: dict[type, TypeAdapter[Any]] = {}


def _validated(model: type[Model], text: str) -> Model:
    """The model of a JSON text; its types are taken strictly."""
    if model not in _ADAPTERS:
        _ADAPTERS[model] = TypeAdapter(model)
    found: Model = _ADAPTERS[model].validate_json(text, strict=True)
    return found


def _known(model: type[Settings], layer: Layer) -> dict[str, Any]:
    """The values of a layer, none of which is for an option that does not exist."""
    values = {name: _plain(layer.name(model, str(name)), value) for name, value in layer.values.items()}
    values = model.completed(values, layer.source)
    names = [field.name for field in fields_of(model)]
    for name, sentence in gone_from(model).items():
        if name in values and values.pop(name):  # an earlier version wrote False where it was not wanted
            raise UserError(f"{layer.name(model, name)} is no option any more: {sentence}")
    for name in values:
        if name not in names:
            raise UserError(f"{layer.name(model, str(name))} means nothing; {suggestion(str(name), names)}")
    return values


def _plain(name: str, value: object) -> Any:  # noqa: ANN401 - a JSON value
    """A value of Python as JSON has it.

    Raises:
        UserError: JSON has no such value.
    """
    plain = to_json(value)
    try:
        json.dumps(plain)
    except (TypeError, ValueError):
        raise UserError(f"{name} is {value!r}; it must be a text, a number, a list or an object of these") from None
    return plain


def _clear_rivals(model: type[Settings], layer: Layer, values: Mapping[str, Any], merged: dict[str, Any]) -> None:
    """Forget what lower layers say of options that this layer excludes.

    Raises:
        UserError: the layer itself gives two that exclude each other.
    """
    given: dict[str, Field] = {}
    for field in fields_of(model):
        rival = field.option.rival
        value = values.get(field.name)
        if rival is None or value is None or (value == field.default and not layer.typed):
            continue
        if rival in given:
            first, second = layer.name(model, given[rival].name), layer.name(model, field.name)
            raise UserError(f"{first} and {second} exclude each other; give one of them")
        given[rival] = field
    for field in fields_of(model):
        if field.option.rival in given and given[field.option.rival] is not field:
            merged.pop(field.name, None)


def _usual(model: type[Settings], name: str) -> dict[str, Any]:
    """The default of an option that is an object."""
    default = next(field.default for field in fields_of(model) if field.name == name)
    usual = to_json(default)
    return usual if isinstance(usual, dict) else {}


def _unit(model: type[Settings], path: str) -> str:
    name = path.partition(".")[0]
    unit = next((field.unit for field in fields_of(model) if field.name == name), "")
    return f" {unit}" if unit else ""


def _sentence(model: type[Settings], error: ValidationError, origin: Mapping[str, Layer]) -> UserError:
    """The first of a validation's complaints, in the words of its source."""
    first = error.errors(include_url=False)[0]
    place = [str(each) for each in first["loc"]]
    layer = origin.get(place[0], Layer({})) if place else Layer({})
    if first["type"] in {"enum", "extra_forbidden", "unexpected_keyword_argument"} and len(place) > 1:
        hint = suggestion(place[1], _keys(model, place[0]))
        return UserError(f"{layer.name(model, place[0])} has no '{place[1]}'; {hint}")
    name = layer.name(model, ".".join(each for each in place if each != "[key]"))
    must = MUST.get(first["type"], "")
    if first["type"] in {"literal_error", "enum"}:
        must = f"one of {first['ctx']['expected'].replace(chr(39), '').replace(' or ', ', ')}"
    if first["type"] in {"missing", "missing_argument", "unexpected_positional_argument", "too_long"}:
        must = "complete: a value is missing or too many"
    advice = [each.option.advice for each in fields_of(model) if each.name in place[:1] and each.option.advice]
    return UserError("; ".join([f"{name} is {first['input']!r}", f"it must be {must or first['msg']}", *advice]))


def _keys(model: type[Settings], name: str) -> list[str]:
    """The keys of an option that is an object."""
    field = next(each for each in fields_of(model) if each.name == name)
    kinds = [kind for kind in get_args(field.type) if isinstance(kind, type) and issubclass(kind, enum.Enum)]
    return [str(each.value) for each in kinds[0]] if kinds else list(_usual(model, name))
