"""The library: its functions, its errors as exceptions."""

from __future__ import annotations

from typing import NoReturn

from . import abi, enums, errors, messages  # abi: gives every function its signature
from .enums import Status
from .native import lib, path, version

__all__ = ["abi", "build_info", "check", "fail", "last_error", "lib", "path", "version"]

build_info: str = lib.dyn_build_info().decode()

_last_error = lib.dyn_last_error
_status_name = lib.dyn_status_name
messages.document({name: getattr(enums, name) for name in enums.__all__})
errors.number({name: int(value) for name, value in Status.__members__.items()})


def last_error() -> str:
    """The calling thread's last error, "" before the first."""
    return messages.in_python(_last_error().decode("utf-8", "replace"))


def fail(status: int) -> NoReturn:
    """Raises the exception of a status, with the library's sentence."""
    name = _status_name(status).decode()
    known = Status(status) if status in Status._value2member_map_ else status
    raise errors.BY_STATUS.get(status, errors.Error)(last_error() or name, known, name)


def check(status: int) -> None:
    if status:
        fail(status)
