"""Builds the wheel and the source distribution: what `pip install ./capi/python` and `python -m build` call (PEP 517, PEP 660).

DYN_PREFIX    an installed tree to take library, command, header and robots from; without it the checkout is built with CMake.
DYN_LEVELS    levels that CMake builds then, beside the plain one: ON (v3, v4), native (for this machine), OFF. Default: native.
DYN_STUBS_LIBRARY  a library that runs here, of whose tables the stubs are written, where the wheel's is for another processor.
DYN_PLATFORM  the platform in the wheel's name, such as manylinux_2_28_x86_64. Default: this machine.
"""

import os
import shutil
import tempfile
from pathlib import Path

import source
import tree
import wheel_file


def get_requires_for_build_wheel(config_settings=None):
    missing = not os.environ.get("DYN_PREFIX") and not shutil.which("cmake")
    return ["cmake>=3.22", "ninja"] if missing else []


get_requires_for_build_editable = get_requires_for_build_wheel


def get_requires_for_build_sdist(config_settings=None):
    return []


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    return wheel_file.write_metadata(Path(metadata_directory))


prepare_metadata_for_build_editable = prepare_metadata_for_build_wheel


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        prefix = tree.installed(work / "prefix")
        root = work / "wheel"
        tree.fill(root / "libdyn", prefix)
        return wheel_file.write(root, Path(wheel_directory), prefix)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """The checkout's own package, which finds the library of build/python."""
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        prefix = tree.installed(work / "prefix")
        (work / "wheel").mkdir()
        (work / "wheel/libdyn.pth").write_text(f"{tree.PACKAGE}\n", encoding="utf-8")
        return wheel_file.write(work / "wheel", Path(wheel_directory), prefix)


def build_sdist(sdist_directory, config_settings=None):
    return source.write(Path(sdist_directory))
