"""Numbers in and out: array-likes to contiguous float64 of a checked shape, and views of the library's memory."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any, Callable, NoReturn, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ArgumentError, SizeError
from .groups import pair
from .placement import Placement as Placement

F64 = np.dtype(np.float64)
Numbers = NDArray[np.float64]
Integers = NDArray[np.int32]
StateLike = Union[ArrayLike, Mapping[str, Any]]
"""q, v, a or tau: an array, or {joint name: numbers}."""


class Owner:
    """A handle of the library, freed when the last Python object that needs it is gone."""

    __slots__ = ("__weakref__", "address", "free", "keep")
    address: int
    free: Any
    keep: Any

    def __init__(self, address: int, free: Any, keep: Any = None):
        self.address, self.free, self.keep = address, free, keep

    def __del__(self) -> None:
        self.free(self.address)


class ReadOnly(np.ndarray):
    """A view of the library's memory. It computes as any array does, with plain arrays as results."""

    hint = "this array is a view of the library's memory, which cannot be written: change a copy, x.copy()."
    if int(np.__version__.split(".")[0]) >= 2:
        __array_wrap__ = np.empty(()).__array_wrap__  # of a plain array: what numpy's functions return is one
    else:

        def __array_wrap__(self, array: Any, context: Any = None) -> Any:
            return np.asarray(array)[()]  # a number where nothing else is left

    def __setitem__(self, key: Any, value: Any) -> None:
        if not self.flags.writeable:
            raise ArgumentError(self.hint)
        super().__setitem__(key, value)

    __iadd__: Any
    __isub__: Any
    __imul__: Any
    __itruediv__: Any
    __ipow__: Any

    def _refused(self, other: Any) -> NoReturn:
        raise ArgumentError(self.hint)

    __iadd__ = __isub__ = __imul__ = __itruediv__ = __ipow__ = _refused

    def copy(self, order: Any = "C") -> Any:
        return np.array(self, order=order)

    def __repr__(self) -> str:
        return repr(np.asarray(self))

    def __reduce__(self) -> Any:
        return np.array(self).__reduce__()

    def __deepcopy__(self, memo: Any) -> Any:
        return np.array(self)

    def __copy__(self) -> Any:
        return self.copy()


def numbers(x: Any, name: str) -> Numbers:
    """x as an array of float64; refuses what is not real numbers."""
    try:
        a = np.asarray(x)
    except ValueError as error:
        raise ArgumentError(f"{name} is not an array: {error}.") from None
    if a.dtype.kind not in "fiu":
        raise ArgumentError(f"{name} must hold real numbers, but its dtype is {a.dtype}.")
    return a.astype(F64, copy=False)


def checked(x: Any, shape: tuple[int, ...], name: str) -> Numbers:
    """x as column-major contiguous float64 of exactly this shape."""
    a = x if type(x) is np.ndarray and x.dtype == F64 else numbers(x, name)
    if a.shape != shape:
        raise SizeError(f"{name} has shape {a.shape}, but must have shape {shape}.")
    return np.asarray(a, order="F")


def address(a: NDArray[Any] | None) -> int | None:
    """Address of a contiguous array's first number. The caller keeps the array alive."""
    return None if a is None else a.__array_interface__["data"][0]


def slot(shape: tuple[int, ...], name: str, model: Callable[[], Any]) -> Callable[[Any], int | None]:
    """A function that copies an argument into a buffer of its own and returns the buffer's address (None: None).

    Copying costs less than asking numpy for the address of an array in each call.
    """
    buffer = np.zeros(shape, order="F")
    start = address(buffer)

    def put(x: Any) -> int | None:
        if x is None:
            return None
        if type(x) is not np.ndarray and type(x) is not ReadOnly:
            x = model()._named(x, name) if isinstance(x, Mapping) and len(shape) == 1 else numbers(x, name)
        elif x.dtype is not F64 and x.dtype != F64:
            x = numbers(x, name)
        if x.shape != shape:
            raise SizeError(f"{name} has shape {x.shape}, but must have shape {shape} of model {model().name!r}.")
        buffer[...] = x
        return start

    return put


def result(shape: tuple[int, ...]) -> tuple[Numbers, int | None]:
    """A buffer for results, and its address: copy it out."""
    buffer = np.zeros(shape, order="F")
    return buffer, address(buffer)


def placement(x: Any, name: str = "placement") -> Numbers:
    """The 12 numbers of dyn.h from a Placement or (R, p), a 4 x 4 matrix, a translation (3,), or the 12 numbers."""
    if isinstance(x, tuple) and len(x) == 2:
        rotation, translation = checked(x[0], (3, 3), f"{name}: rotation"), checked(x[1], (3,), f"{name}: translation")
    else:
        a = numbers(x, name)
        if a.shape == (12,):
            return np.ascontiguousarray(a)
        if a.shape == (3,):
            rotation, translation = np.eye(3), a
        elif a.shape == (4, 4):
            if not np.array_equal(a[3], (0, 0, 0, 1)):
                raise ArgumentError(f"{name}: the last row of a 4 x 4 placement must be 0 0 0 1, but it is {a[3].tolist()}.")
            rotation, translation = a[:3, :3], a[:3, 3]
        else:
            raise SizeError(f"{name} has shape {a.shape}, but must be (R, p), or have shape (4, 4), (3,) or (12,).")
    return np.concatenate([np.asarray(rotation).reshape(-1, order="F"), translation])


def to_placement(x: np.ndarray) -> Placement:
    """From 12 numbers, without a copy."""
    return Placement(x[:9].reshape(3, 3).T, x[9:])


def to_placements(x: np.ndarray) -> Placement:
    """Poses from rows of 12 numbers, (..., 12), without a copy."""
    return Placement(*pair(x))


def of_placements(x: Any) -> Any:
    """The rows beneath what to_placements returned, x if it is not that."""
    rows = x[1].base if isinstance(x, tuple) and len(x) == 2 and isinstance(x[1], np.ndarray) else None
    if rows is None or rows.ndim < 2 or rows.shape[-1] != 12:
        return x
    same = all(a.shape == b.shape and a.strides == b.strides and a.ctypes.data == b.ctypes.data for a, b in zip(x, pair(rows)))
    return rows if same else x


def view(start: int, rows: int, cols: int | None, strides: tuple[int, int], owner: Owner, hint: str = "") -> Numbers:
    """Read-only view of the library's memory that keeps its owner alive; cols None: a vector. Strides in doubles. hint: what an
    assignment says."""
    shape = (rows,) if cols is None else (rows, cols)
    if 0 in shape:
        empty = np.empty(shape, order="F")
        empty.flags.writeable = False
        return empty
    extent = 1 + sum((n - 1) * s for n, s in zip(shape, strides))
    memory: Any = (ctypes.c_double * extent).from_address(start)
    memory._owner = owner
    array = ReadOnly(shape, F64, memory, strides=tuple(8 * s for s in strides[: len(shape)]))
    array.flags.writeable = False
    if hint:
        array.hint = hint
    return array
