"""`StructuredArray`: the annotation of numpy arrays with rows of named fields of different types."""

from typing import Any, TypeAlias

StructuredArray: TypeAlias = Any
"""(N,) of a structured dtype, which the place of the annotation names.

numpy cannot express the types of fields: ``rows["x_m"]`` is an array of unknown numbers either way. With
``NDArray[np.void]`` mypy tries each overload of each operator for them, which took 80 of 145 s of `make check`
(docs/decisions/0090-time-of-drives-and-tests.md).
"""
