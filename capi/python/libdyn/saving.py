"""A model as a file or as bytes."""

from __future__ import annotations

import os
from ctypes import byref, c_size_t, c_void_p, cast, create_string_buffer
from typing import TYPE_CHECKING, NamedTuple

from . import abi
from .choices import kind, member
from .enums import Format, ReportLevel
from .errors import ArgumentError
from .handles import ModelHandle
from .library import check, lib
from .messages import in_python

if TYPE_CHECKING:
    from .enums import FormatLike


class SaveLine(NamedTuple):
    """Something that a format has no place for (WARNING), or says in another way (INFO)."""

    level: ReportLevel
    message: str


def _options(strict: bool, lines: list[SaveLine]) -> abi.SaveOptions:
    options = abi.initialized(abi.SaveOptions)
    options.strict = bool(strict)
    options.call = abi.SaveReport(lambda _, level,
                                  message: lines.append(SaveLine(kind(ReportLevel, level),
                                                                 in_python(message.decode("utf-8", "replace")))))
    options.report = cast(options.call, c_void_p).value
    return options


class Saving(ModelHandle):
    """The part of Model that writes it."""

    def save(self, path: str | os.PathLike[str], strict: bool = False) -> list[SaveLine]:
        """Writes the model as URDF (.urdf), MJCF (.xml, .mjcf) or compiled (.dynb): see dyn_model_save. What the format has no
        place for is in the list as WARNING, and an error with strict; what it says in another way as INFO."""
        name = os.fsencode(path)
        if b"\0" in name:
            raise ArgumentError(f"path holds a zero character: {path!r}.")
        lines: list[SaveLine] = []
        check(lib.dyn_model_save(self._m, name, byref(_options(strict, lines))))
        return lines

    def to_bytes(self, format: FormatLike, strict: bool = False) -> bytes:
        """Returns the bytes that save writes."""
        kind, size, options = member(Format, format, "format"), c_size_t(), _options(strict, [])
        check(lib.dyn_model_save_memory(self._m, kind, byref(options), None, 0, byref(size)))
        out = create_string_buffer(size.value)
        check(lib.dyn_model_save_memory(self._m, kind, byref(options), out, len(out), byref(size)))
        return out.raw

    def image(self, narrow: bool = False, names: bool = True) -> bytes:
        """Returns the bytes of a .dynb, as Model.from_buffer takes them. narrow: for machines without SIMD; names: False leaves
        them out, with the load report."""
        size, flags = c_size_t(), (1 if narrow else 0) | (0 if names else 2)
        check(lib.dyn_model_image(self._m, flags, None, 0, byref(size)))
        out = create_string_buffer(size.value)
        check(lib.dyn_model_image(self._m, flags, out, len(out), byref(size)))
        return out.raw
