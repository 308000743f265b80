"""Finds libdyn, and refuses one that does not fit. Every call releases the GIL."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path
from typing import Any

from . import errors

MAJOR = 1  # of the interface that this package was written for

_FILE = {"darwin": "libdyn.1.dylib", "win32": "dyn.dll"}.get(sys.platform, "libdyn.so.1")


def _in_folder(folder: Path) -> Path | None:
    path = folder / _FILE
    return path if path.is_file() else None


def _plain(build: Path) -> bool:
    """Returns whether a build tree is without sanitizers: a library with them ends a process that did not start with them."""
    try:
        cache = (build / "CMakeCache.txt").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
    return not any(line.startswith("DYN_SANITIZE:") and line.rstrip()[-1] != "=" for line in cache.splitlines())


def _candidates():
    """(path or soname, where that came from), best first."""
    package = Path(__file__).resolve().parent
    found = _in_folder(package / "lib")
    if found:
        yield str(found), "packaged with libdyn"
    root = package.parents[2]  # of a checkout: this is capi/python/libdyn
    if (root / "include" / "dyn.h").is_file():
        builds = [f for pattern in ("build*/lib", "build*/*/lib") for f in root.glob(pattern) if _plain(f.parent)]
        for found in sorted(filter(None, map(_in_folder, builds)), key=lambda p: p.stat().st_mtime, reverse=True):
            yield str(found), "build tree"
    yield _FILE, "system"


class Library(ctypes.CDLL):
    """libdyn. A function that it lacks is an error that says what to do."""

    def __getattr__(self, name: str) -> Any:
        try:
            return super().__getattr__(name)
        except AttributeError:
            if name.startswith("__"):
                raise
            raise errors.LibraryError(f"{self._name} has no function {name}, which this package needs: update libdyn.") from None


def _open() -> tuple[Library, str]:
    said = os.environ.get("DYN_LIBRARY")
    if said:
        path = Path(said)
        if path.is_dir():
            found = _in_folder(path)
            if not found:
                raise errors.LibraryError(
                    f"DYN_LIBRARY is the folder {said!r}, which holds no {_FILE}; set it to the library's file."
                )
            path = found
        try:
            return Library(str(path)), str(path)
        except OSError as error:
            raise errors.LibraryError(f"DYN_LIBRARY is {said!r}, which cannot be loaded: {error}.") from None
    tried = []
    for name, where in _candidates():
        try:
            return Library(name), name
        except OSError as error:
            tried.append(f"{name} ({where}): {error}")
    raise errors.LibraryError(
        f"No {_FILE} was found: build or install libdyn, or set DYN_LIBRARY to its file. Tried " + "; ".join(tried) + "."
    )


def _checked(lib: Library, path: str) -> str:
    """The library's version, if this package is for it."""
    try:
        lib.dyn_version.restype = ctypes.c_char_p
    except errors.LibraryError:
        raise errors.LibraryError(f"{path} is not libdyn: it has no function dyn_version.") from None
    version = lib.dyn_version().decode()
    if version.split(".")[0] != str(MAJOR):
        raise errors.LibraryError(
            f"{path} is libdyn {version}, but this package needs libdyn {MAJOR}.x: install the package libdyn of version "
            f"{version.split('.')[0]}, or a library of version {MAJOR} (and check DYN_LIBRARY)."
        )
    return version


lib: Library
path: str
lib, path = _open()
version: str = _checked(lib, path)
