"""Exceptions: one class for each status of dyn.h, all of them dyn.Error."""

from __future__ import annotations

from .enums import Status


class Error(Exception):
    """A call that failed. str() is the library's sentence: what, where, and what to do.

    status       the number that the library answered (dyn.Status when this package knows it)
    status_name  "DYN_ERROR_STALE", ...
    """

    status: int = Status.ERROR_INTERNAL

    def __init__(self, message: str, status: int | None = None, status_name: str | None = None):
        super().__init__(message)
        if status is not None:
            self.status = status
        self.status_name = status_name or f"DYN_{Status(self.status).name}"

    def __reduce__(self):
        return type(self), (self.args[0], self.status, self.status_name)


class LibraryError(Error, ImportError):
    """libdyn itself was not found, or does not fit this package."""

    status = Status.ERROR_FILE


class ArgumentError(Error, ValueError):
    """A value that is required is missing, or an index or option is out of range."""

    status = Status.ERROR_ARGUMENT


class HandleError(Error):
    """A freed or foreign handle."""

    status = Status.ERROR_HANDLE


class ModelError(Error):
    """The data belongs to another model."""

    status = Status.ERROR_MODEL


class SizeError(Error, ValueError):
    """An array or memory block of the wrong size."""

    status = Status.ERROR_SIZE


class NonFiniteError(Error, ValueError):
    """NaN or infinity in an input."""

    status = Status.ERROR_NONFINITE


class QuaternionError(Error, ValueError):
    """A zero quaternion or zero (cos, sin) pair."""

    status = Status.ERROR_QUATERNION


class StaleError(Error):
    """The quantity was not computed for the current state: the message names the call to make."""

    status = Status.ERROR_STALE


class PartError(Error):
    """The data was made without the part: the message names it."""

    status = Status.ERROR_PART


class UnknownNameError(Error, LookupError):
    """A name that does not exist, or exists twice."""

    status = Status.ERROR_NAME


class LoadError(Error):
    """A robot that could not be loaded or built; its subclasses say why."""


class FileError(LoadError):
    """A file that is missing or cannot be read."""

    status = Status.ERROR_FILE


class ParseError(LoadError):
    """Malformed XML or an unreadable number."""

    status = Status.ERROR_PARSE


class InvalidRobotError(LoadError):
    """A robot that cannot exist: negative mass, impossible inertia, cycle, two roots, zero axis, ..."""

    status = Status.ERROR_INVALID


class BaseChoiceError(LoadError):
    """Neither base="fixed" nor base="floating" was said, and the root link has mass."""

    status = Status.ERROR_BASE


class StrictError(LoadError):
    """strict=True, and the file says physics that would be dropped."""

    status = Status.ERROR_STRICT


class NumericError(Error, ArithmeticError):
    """Singular or not finite: the message names the joint."""

    status = Status.ERROR_NUMERIC


class BusyError(Error):
    """Checked builds: a data used by two threads at once."""

    status = Status.ERROR_BUSY


class OutOfMemoryError(Error, MemoryError):
    """Out of memory."""

    status = Status.ERROR_MEMORY


class LimitError(Error):
    """Larger than the library allows: the message says the limit."""

    status = Status.ERROR_LIMIT


class UnsupportedError(Error, NotImplementedError):
    """Not available in this version of the library."""

    status = Status.ERROR_UNSUPPORTED


class InternalError(Error):
    """A defect of the library: please report it."""

    status = Status.ERROR_INTERNAL


class CancelledError(Error):
    """The caller's progress function ended the call."""

    status = Status.ERROR_CANCELLED


BY_STATUS: dict[int, type[Error]] = {
    int(c.status): c
    for c in (
        ArgumentError, HandleError, ModelError, SizeError, NonFiniteError, QuaternionError, StaleError, PartError,
        UnknownNameError, FileError, ParseError, InvalidRobotError, BaseChoiceError, StrictError, NumericError, BusyError,
        OutOfMemoryError, LimitError, UnsupportedError, InternalError, CancelledError,
    )
}  # fmt: skip
