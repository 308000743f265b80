"""Compiles what doors have in C and C++, against dyn.h and the library of this process."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Literal

from .. import files
from ..errors import UnsupportedError
from ..library import path as library_path

_COMPILERS = {"cc": ("CC", "cc", "gcc", "clang"), "c++": ("CXX", "c++", "g++", "clang++")}


def compiler(kind: Literal["cc", "c++"]) -> str | None:
    """The compiler of C or C++: that of the environment variable CC or CXX, or a usual name; None: there is none."""
    variable, *names = _COMPILERS[kind]
    return next(filter(None, map(shutil.which, (os.environ.get(variable, ""), *names))), None)


def shared_library(source: str | os.PathLike[str], kind: Literal["cc", "c++"], *options: str) -> Path:
    """Compiles a file, and returns the shared library beside it."""
    source, found = Path(source), compiler(kind)
    if not found:
        raise UnsupportedError(f"there is no compiler {kind}: install one, or set {_COMPILERS[kind][0]} to it.")
    made, folder = source.with_suffix(".so"), files.library_folder()
    library = str(Path(library_path).resolve()) if os.sep in library_path else "-ldyn"
    command = [found, "-O2", "-shared", "-fPIC", *options, f"-I{files.include()}", str(source), "-o", str(made), library,
               f"-Wl,-rpath,{folder}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise UnsupportedError(f"{found} could not compile {source}: {done.stderr.strip()}")
    return made
