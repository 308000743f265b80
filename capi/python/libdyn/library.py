"""Finds libdyn, refuses one that does not fit, and binds every function of dyn.h. CDLL releases the GIL in every call."""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from pathlib import Path
from typing import NoReturn

from . import abi, errors
from .enums import Status

_FILE = "libdyn.1.dylib" if sys.platform == "darwin" else "libdyn.so.1"

# What glibc asks of a CPU before it searches glibc-hwcaps/<level>, in the names of /proc/cpuinfo.
_LEVELS = (
    ("x86-64-v2", {"cx16", "lahf_lm", "popcnt", "sse4_1", "sse4_2", "ssse3"}),
    ("x86-64-v3", {"avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe", "xsave"}),
    ("x86-64-v4", {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}),
)


def cpu_levels() -> list[str]:
    """The glibc-hwcaps folders that this CPU can use, best first."""
    if platform.machine() not in ("x86_64", "AMD64"):
        return []
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
            flags = next((set(line.split()) for line in file if line.startswith("flags")), set())
    except OSError:
        return []
    levels = []
    for name, needed in _LEVELS:
        if not needed <= flags:
            break
        levels.insert(0, name)
    return levels


def _in_folder(folder: Path) -> Path | None:
    """The best library in a folder that is laid out as glibc searches it."""
    for sub in [f"glibc-hwcaps/{level}" for level in cpu_levels()] + ["."]:
        path = folder / sub / _FILE
        if path.is_file():
            return path
    return None


def _plain(build: Path) -> bool:
    """Whether a build tree is without sanitizers: a library with them ends a process that did not start with them."""
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
        yield str(found), "packaged with dyn"
    root = package.parents[2]  # of a checkout: this is capi/python/libdyn
    if (root / "include" / "dyn.h").is_file():
        builds = [f for pattern in ("build*/lib", "build*/*/lib") for f in root.glob(pattern) if _plain(f.parent)]
        for found in sorted(filter(None, map(_in_folder, builds)), key=lambda p: p.stat().st_mtime, reverse=True):
            yield str(found), "build tree"
    yield _FILE, "system"


def _open() -> tuple[ctypes.CDLL, str]:
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
            return ctypes.CDLL(str(path)), str(path)
        except OSError as error:
            raise errors.LibraryError(f"DYN_LIBRARY is {said!r}, which cannot be loaded: {error}.") from None
    tried = []
    for name, where in _candidates():
        try:
            return ctypes.CDLL(name), name
        except OSError as error:
            tried.append(f"{name} ({where}): {error}")
    raise errors.LibraryError(
        f"No {_FILE} was found: build or install libdyn, or set DYN_LIBRARY to its file. Tried " + "; ".join(tried) + "."
    )


def _bind(lib: ctypes.CDLL, path: str) -> str:
    """Sets every signature; answers the library's version."""
    try:
        lib.dyn_version.restype = ctypes.c_char_p
        version = lib.dyn_version().decode()
    except AttributeError:
        raise errors.LibraryError(f"{path} is not libdyn: it has no function dyn_version.") from None
    if version.split(".")[0] != str(abi.MAJOR):
        raise errors.LibraryError(
            f"{path} is libdyn {version}, but this package needs libdyn {abi.MAJOR}.x: install the dyn package of version "
            f"{version.split('.')[0]}, or a libdyn of version {abi.MAJOR} (and check DYN_LIBRARY)."
        )
    for name, (result, arguments) in abi.SIGNATURES.items():
        try:
            function = getattr(lib, name)
        except AttributeError:
            raise errors.LibraryError(
                f"{path} is libdyn {version} and has no function {name}, which this package needs: update libdyn."
            ) from None
        function.restype = result
        function.argtypes = arguments
    return version


lib, path = _open()
version: str = _bind(lib, path)
build_info: str = lib.dyn_build_info().decode()

_last_error = lib.dyn_last_error
_status_name = lib.dyn_status_name


def last_error() -> str:
    """The calling thread's last error, "" before the first."""
    return _last_error().decode("utf-8", "replace")


def fail(status: int) -> NoReturn:
    """Raises the exception of a status, with the library's sentence."""
    name = _status_name(status).decode()
    cls = errors.BY_STATUS.get(status, errors.Error)
    known = Status(status) if status in Status._value2member_map_ else status
    raise cls(last_error() or name, known, name)


def check(status: int) -> None:
    if status:
        fail(status)
