"""Puts the library into the package, in libdyn/lib, the robots of libdyn.gym, and stubs for type checkers, which
the library describes.

`pip install ./capi/python` from a checkout needs no other step.

DYN_PREFIX  an installed tree to take the libraries from; without it the checkout is configured and built with CMake.
DYN_LEVELS  levels that CMake builds then, beside the plain one: ON (v3, v4), native (for this machine), OFF. Default: native.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

try:
    from wheel.bdist_wheel import bdist_wheel
except ImportError:  # setuptools has it from version 70 on
    from setuptools.command.bdist_wheel import bdist_wheel

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
SCRATCH = CHECKOUT / "build" / "python-package"  # nothing is written beside the sources
SONAME = "libdyn.so.1"
MODULE = "libdyn_mesh.so"  # beside it, where qhull was there
ROBOTS = ("go2.urdf", "humanoid.urdf")  # that libdyn.gym plays with


def build_prefix(work):
    """Builds the checkout into a folder; returns the installed tree."""
    if not (CHECKOUT / "CMakeLists.txt").is_file():
        raise SystemExit("libdyn's sources are not beside this package: install from a checkout, or set DYN_PREFIX to an "
                         "installed libdyn.")
    if not shutil.which("cmake"):
        raise SystemExit("cmake is missing, with which libdyn is built: run tools/install_packages, or set DYN_PREFIX to an "
                         "installed libdyn.")
    build, prefix = CHECKOUT / "build" / "python", work / "prefix"
    levels = os.environ.get("DYN_LEVELS", "native")
    for command in (
        ["cmake", "-S", CHECKOUT, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DDYN_TESTS=OFF", "-DDYN_VIEWER=OFF",
         f"-DDYN_LEVELS={levels}"],
        ["cmake", "--build", build, "--parallel", str(os.cpu_count() or 1)],
        ["cmake", "--install", build, "--prefix", prefix],
    ):
        subprocess.run([str(word) for word in command], check=True)
    return prefix


class BuildWithLibrary(build_py):
    def run(self):
        package = pathlib.Path(self.build_lib) / "libdyn"
        shutil.rmtree(package, ignore_errors=True)
        super().run()
        target = package / "lib"
        with tempfile.TemporaryDirectory() as work:
            prefix = pathlib.Path(os.environ.get("DYN_PREFIX") or build_prefix(pathlib.Path(work)))
            folders = {file.parent for file in prefix.rglob(SONAME)}
            if len(folders) != 1:
                raise SystemExit(f"{prefix} holds {len(folders)} libraries named {SONAME}, not one: set DYN_PREFIX to an "
                                 "installed libdyn.")
            folder = folders.pop()
            target.mkdir()
            for file in [folder / SONAME, *folder.glob(MODULE)]:
                shutil.copyfile(file, target / file.name)  # the file, not the link
        (package / "models").mkdir()
        for name in ROBOTS:
            shutil.copyfile(CHECKOUT / "models" / "robots" / name, package / "models" / name)
        environment = {k: v for k, v in os.environ.items() if k != "DYN_LIBRARY"}
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, sys.path))  # where the build finds numpy
        subprocess.run([sys.executable, "-m", "libdyn.stubs", str(package.resolve())], check=True, env=environment,
                       cwd=self.build_lib)


class PlatformWheel(bdist_wheel):
    """Any Python 3, this platform: the library is reached through ctypes."""

    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


class BinaryDistribution(Distribution):
    def has_ext_modules(self):
        return True


SCRATCH.mkdir(parents=True, exist_ok=True)
setup(
    cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": PlatformWheel},
    distclass=BinaryDistribution,
    options={"build": {"build_base": str(SCRATCH)}, "egg_info": {"egg_base": str(SCRATCH)}},
)
