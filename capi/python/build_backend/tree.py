"""The folder libdyn of a wheel: the modules of the package, and what they need of an installed libdyn, laid out as that is: bin,
include, lib, share/dyn."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
CHECKOUT = PACKAGE.parents[1]
SONAME = "libdyn.so.1"
DLL = "dyn.dll"  # of Windows, with dyn.lib to link with
MODULE = "libdyn_mesh.so"  # beside it, where qhull was there

LINKED = f"INPUT({SONAME})\n"  # libdyn.so, a linker script: wheels hold no links
CMAKE = f"""# find_package(dyn): the target dyn::dyn
get_filename_component(dyn_prefix "${{CMAKE_CURRENT_LIST_DIR}}/../../.." ABSOLUTE)
if(NOT TARGET dyn::dyn)
  add_library(dyn::dyn SHARED IMPORTED)
  set_target_properties(dyn::dyn PROPERTIES IMPORTED_LOCATION ${{dyn_prefix}}/lib/{SONAME} IMPORTED_SONAME {SONAME}
                        INTERFACE_INCLUDE_DIRECTORIES ${{dyn_prefix}}/include)
endif()
"""


def installed(prefix):
    """The tree of DYN_PREFIX, or that of the checkout, built and installed into prefix."""
    said = os.environ.get("DYN_PREFIX")
    if said:
        return Path(said).resolve()
    if not (CHECKOUT / "CMakeLists.txt").is_file():
        raise SystemExit("libdyn's sources are not beside this package: install from a checkout, or set DYN_PREFIX to an "
                         "installed libdyn.")
    if not shutil.which("cmake"):
        raise SystemExit("cmake is missing, with which libdyn is built: run tools/install_packages, or set DYN_PREFIX to an "
                         "installed libdyn.")
    build = CHECKOUT / "build" / "python"
    fresh = [] if (build / "CMakeCache.txt").is_file() or not shutil.which("ninja") else ["-G", "Ninja"]
    for command in (
        ["cmake", "-S", CHECKOUT, "-B", build, *fresh, "-DCMAKE_BUILD_TYPE=Release", "-DDYN_TESTS=OFF", "-DDYN_TOGETHER=ON",
         f"-DDYN_LEVELS={os.environ.get('DYN_LEVELS', 'native')}"],
        ["cmake", "--build", build, "--parallel", str(os.cpu_count() or 1)],
        ["cmake", "--install", build, "--prefix", prefix, "--strip"],
    ):
        subprocess.run([str(word) for word in command], check=True)
    return prefix


def fill(package, prefix):
    """Makes the folder. Of the installed tree only the library has to be there."""
    found = [*prefix.rglob(SONAME), *prefix.rglob(DLL)]
    folders = {file.parent for file in found}
    if len(folders) != 1:
        raise SystemExit(f"{prefix} holds {len(folders)} libraries named {SONAME} or {DLL}, not one: set DYN_PREFIX to an "
                         "installed libdyn.")
    libraries, windows = folders.pop(), found[0].name == DLL
    package.mkdir(parents=True)
    for pattern in ("*.py", "py.typed", "doors/*.py", "doors/native/*.c*"):
        for file in (PACKAGE / "libdyn").glob(pattern):
            there = package / file.relative_to(PACKAGE / "libdyn")
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(file, there)
    (package / "lib").mkdir()
    for file in [found[0], *libraries.glob(MODULE), *prefix.glob("lib/dyn.lib")]:
        shutil.copyfile(file, package / "lib" / file.name)  # the file, not the link
    if (prefix / "include/dyn.h").is_file():
        (package / "include").mkdir()
        for file in prefix.glob("include/dyn.h*"):
            shutil.copy(file, package / "include")
        if not windows:
            (package / "lib/libdyn.so").write_text(LINKED, encoding="ascii")
        for_cmake(package / "lib/cmake/dyn", prefix / "lib/cmake/dyn" if windows else libraries / "cmake/dyn", windows)
    for command in (prefix / "bin/dyn", prefix / "bin/dyn.exe"):
        if command.is_file():
            (package / "bin").mkdir()
            shutil.copy(command, package / "bin")
    shutil.copytree(CHECKOUT / "models", package / "share/dyn/models", ignore=shutil.ignore_patterns("__pycache__"))
    if (prefix / "share/dyn/viewer.html").is_file():
        shutil.copy(prefix / "share/dyn/viewer.html", package / "share/dyn/viewer.html")
    stubs(package)


def for_cmake(folder, installed, windows):
    folder.mkdir(parents=True)
    config = CMAKE
    if windows:
        config = CMAKE.replace(SONAME, DLL).replace(f"IMPORTED_SONAME {DLL}", "IMPORTED_IMPLIB ${dyn_prefix}/lib/dyn.lib")
    (folder / "dynConfig.cmake").write_text(config, encoding="ascii")
    for file in installed.glob("dynConfigVersion.cmake"):
        shutil.copy(file, folder)


def stubs(package):
    """What type checkers read of the modules that are made of the library's tables."""
    environment = {k: v for k, v in os.environ.items() if k != "DYN_LIBRARY"}
    if os.environ.get("DYN_STUBS_LIBRARY"):
        environment["DYN_LIBRARY"] = os.environ["DYN_STUBS_LIBRARY"]
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, sys.path))  # where the build finds numpy
    command = [sys.executable, "-B", "-m", "libdyn.stubs", str(package.resolve())]
    subprocess.run(command, check=True, env=environment, cwd=package.parent)


def version():
    return re.search(r'^version = "(.*)"', (PACKAGE / "pyproject.toml").read_text(encoding="utf-8"), re.M)[1]
