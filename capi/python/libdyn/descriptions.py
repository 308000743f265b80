"""Robots by name, of the packages robot_descriptions and example-robot-data."""

from __future__ import annotations

import difflib
import importlib
import importlib.util
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import FileError, UnknownNameError
from .loading import load

if TYPE_CHECKING:
    from .enums import BaseLike
    from .model import Model


def load_description(name: str, base: BaseLike | None = None, **options: Any) -> Model:
    """Loads a robot that a package of robots has, by its name there; options as of dyn.load.

        m = dyn.load_description("go2_description", base="floating")     # pip install robot_descriptions
        m = dyn.load_description("talos_reduced", base="floating")       # pip install example-robot-data

    robot_descriptions fetches a robot's files when it is first named. Of example-robot-data a name is that of a URDF file.
    """
    found = _robot_descriptions(name) or _example_robot_data(name)
    if found is None:
        known = sorted({*_names_of_robot_descriptions(), *_files_of_example_robot_data()})
        if not known:
            raise FileError("load_description needs a package of robots: pip install robot_descriptions, or example-robot-data.")
        near = difflib.get_close_matches(name, known, 3)
        raise UnknownNameError(f"there is no robot {name!r}" + (f": did you mean {', '.join(map(repr, near))}?" if near else
                                                               f" among the {len(known)} that are known."))
    path, folders = found
    if path.endswith(".xml"):
        return load(path, base, **options)
    return load(path, base, **{"package_dirs": folders, **options})


def _robot_descriptions(name: str) -> tuple[str, list[str]] | None:
    if name not in _names_of_robot_descriptions():
        return None
    module = importlib.import_module(f"robot_descriptions.{name}")
    if hasattr(module, "MJCF_PATH"):
        return str(module.MJCF_PATH), []
    if hasattr(module, "URDF_PATH"):
        path = str(module.URDF_PATH)
    else:
        path = str(importlib.import_module("robot_descriptions._xacro").get_urdf_path(module))
    package, repository = str(module.PACKAGE_PATH), str(module.REPOSITORY_PATH)
    return path, [os.path.dirname(package), package, repository, os.path.dirname(repository)]


def _names_of_robot_descriptions() -> list[str]:
    spec = importlib.util.find_spec("robot_descriptions")
    folders = spec.submodule_search_locations if spec else None
    return [file.stem for folder in folders or () for file in Path(folder).glob("*_description.py") if file.stem[0] != "_"]


def _example_robot_data(name: str) -> tuple[str, list[str]] | None:
    path = _files_of_example_robot_data().get(name)
    return None if path is None else (str(path), [str(p) for p in _shares()])


def _shares() -> list[Path]:
    """Folders of data that may hold it: of a wheel, of an environment."""
    places = [*(Path(p) / "cmeel.prefix/share" for p in sys.path), Path(sys.prefix) / "share"]
    return [p for p in places if (p / "example-robot-data/robots").is_dir()]


def _files_of_example_robot_data() -> dict[str, Path]:
    return {file.stem: file for share in reversed(_shares())  # the first of sys.path wins
            for file in sorted((share / "example-robot-data/robots").rglob("*.urdf"))}
