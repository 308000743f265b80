"""Exceptions: one class for each status of dyn.h, all of them dyn.Error."""

from __future__ import annotations

from typing import Any


class Error(Exception):
    """A call that failed. str() is the library's sentence: what, where, and what to do.

    status       the number that the library returned (a dyn.Status where it has that number)
    status_name  "DYN_ERROR_STALE", ...
    """

    status: int = -1
    status_name: str = "DYN_ERROR_INTERNAL"

    def __init__(self, message: str, status: int | None = None, status_name: str | None = None):
        super().__init__(message)
        if status is not None:
            self.status = status
        if status_name is not None:
            self.status_name = status_name

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.args[0], self.status, self.status_name)


class LibraryError(Error, ImportError):
    """libdyn itself was not found, or does not fit this package."""

    status_name = "DYN_ERROR_FILE"


class ArgumentError(Error, ValueError):
    """A value that is required is missing, or an index or option is out of range."""

    status_name = "DYN_ERROR_ARGUMENT"


class HandleError(Error):
    """A freed or foreign handle."""

    status_name = "DYN_ERROR_HANDLE"


class ModelError(Error):
    """The data belongs to another model."""

    status_name = "DYN_ERROR_MODEL"


class SizeError(Error, ValueError):
    """An array or memory block of the wrong size."""

    status_name = "DYN_ERROR_SIZE"


class NonFiniteError(Error, ValueError):
    """NaN or infinity in an input."""

    status_name = "DYN_ERROR_NONFINITE"


class QuaternionError(Error, ValueError):
    """A zero quaternion or zero (cos, sin) pair."""

    status_name = "DYN_ERROR_QUATERNION"


class StaleError(Error):
    """The quantity was not computed for the current state: the message names the call to make."""

    status_name = "DYN_ERROR_STALE"


class PartError(Error):
    """The data was made without the part: the message names it."""

    status_name = "DYN_ERROR_PART"


class UnknownNameError(Error, LookupError):
    """A name that does not exist, or exists twice."""

    status_name = "DYN_ERROR_NAME"


class LoadError(Error):
    """A robot that could not be loaded or built; its subclasses say why."""


class FileError(LoadError):
    """A file that is missing or cannot be read."""

    status_name = "DYN_ERROR_FILE"


class ParseError(LoadError):
    """Malformed XML or an unreadable number."""

    status_name = "DYN_ERROR_PARSE"


class InvalidRobotError(LoadError):
    """A robot that cannot exist: negative mass, impossible inertia, cycle, two roots, zero axis, ..."""

    status_name = "DYN_ERROR_INVALID"


class BaseChoiceError(LoadError):
    """Neither base="fixed" nor base="floating" was said, and the root link has mass."""

    status_name = "DYN_ERROR_BASE"


class StrictError(LoadError):
    """strict=True, and the file says physics that would be dropped."""

    status_name = "DYN_ERROR_STRICT"


class NumericError(Error, ArithmeticError):
    """Singular or not finite: the message names the joint."""

    status_name = "DYN_ERROR_NUMERIC"


class BusyError(Error):
    """A data or a batch used by two threads at once."""

    status_name = "DYN_ERROR_BUSY"


class OutOfMemoryError(Error, MemoryError):
    """Out of memory."""

    status_name = "DYN_ERROR_MEMORY"


class LimitError(Error):
    """Larger than the library allows: the message says the limit."""

    status_name = "DYN_ERROR_LIMIT"


class UnsupportedError(Error, NotImplementedError):
    """Not available in this version of the library."""

    status_name = "DYN_ERROR_UNSUPPORTED"


class InternalError(Error):
    """A defect of the library: please report it."""

    status_name = "DYN_ERROR_INTERNAL"


class CancelledError(Error):
    """The caller's progress function ended the call."""

    status_name = "DYN_ERROR_CANCELLED"


class LoadWarning(UserWarning):
    """The file of a model has physics that the model lacks: Model.report has every line."""


class ContactWarning(UserWarning):
    """Steps had no room for all contact points: the shallowest were left out."""


BY_STATUS: dict[int, type[Error]] = {}
"""The class of each status."""


def number(statuses: dict[str, int]) -> None:
    """Gives each class the number of its status; statuses: {"ERROR_STALE": 7, ...}."""
    for cls in [c for c in globals().values() if isinstance(c, type) and issubclass(c, Error)]:
        cls.status = statuses[cls.status_name.removeprefix("DYN_")]
        if "status_name" in vars(cls) and cls not in (Error, LibraryError):
            BY_STATUS[cls.status] = cls
