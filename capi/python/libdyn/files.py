"""What comes beside the library: robots, header, command. A wheel holds them, as a checkout and an installed libdyn do."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from .errors import FileError, LibraryError
from .library import path as library_path

_PACKAGE = Path(__file__).resolve().parent


def _prefixes() -> list[Path]:
    """Folders that may hold bin, include or share/dyn: the package, then those above the library."""
    return [_PACKAGE, *list(Path(library_path).resolve().parents)[:4]]  # slices of parents: from Python 3.10 on


def _first(*places: Path) -> Path | None:
    return next((p for p in places if p.exists()), None)


def _checkout(name: str) -> list[Path]:
    root = _PACKAGE.parents[2]  # where this is capi/python/libdyn
    return [root / name] if (root / "CMakeLists.txt").is_file() else []


models: Path = _first(*_checkout("models"), *(p / "share/dyn/models" for p in _prefixes())) or _PACKAGE / "share/dyn/models"
"""Folder of robots and scenes: dyn.load(dyn.models / "robots/go2.urdf", base="floating")."""


def command() -> str:
    """The command `dyn`: of DYN_CLI, beside the library, or in PATH."""
    beside = _first(*(p / "bin" / name for p in _prefixes() for name in ("dyn", "dyn.exe")))
    found = os.environ.get("DYN_CLI") or (str(beside) if beside else None) or shutil.which("dyn")
    if not found:
        raise LibraryError("the command dyn was not found: install it, or set DYN_CLI to its file.")
    return found


def include() -> Path:
    """Folder of dyn.h and dyn.hpp."""
    found = _first(*(p / "include/dyn.h" for p in _prefixes()), *(p / "dyn.h" for p in _checkout("include")))
    if not found:
        raise FileError(f"dyn.h was found neither in {_PACKAGE} nor above {library_path}: install libdyn's header.")
    return found.parent


def library_folder() -> Path:
    """Folder of libdyn.so."""
    return Path(library_path).resolve().parent
