"""Writes what type checkers and editors see of the fields and algorithms, from the library's own tables: python -m libdyn.stubs"""

from __future__ import annotations

import keyword
from pathlib import Path

from .algorithms import ALGORITHMS, OPTIONAL, Algorithm
from .batch_methods import description as of_algorithm
from .field_properties import STATE
from .field_properties import description as of_field
from .fields import FIELDS, SHAPES

HEAD = "# Written by `python -m libdyn.stubs` from the library's tables.\nfrom typing import Any\n\nimport numpy as np\n"
TYPES = {"frame": "int | str", "joint": "int | str", "reference": "Any", "integrator": "Any", "dt": "float", "q": "Any"}


def fields() -> str:
    lines = [HEAD, "STATE: dict[str, str]\n", "def description(info: Any) -> str: ...\n", "class Fields:"]
    for info in FIELDS.values():
        if keyword.iskeyword(info.name):  # reached by Data.field alone
            continue
        kind = "np.ndarray" if SHAPES[info.id] else "float"
        lines += ["    @property", f"    def {info.name}(self) -> {kind}:", f'        """{of_field(info)}"""']
        if info.name in STATE:
            lines += [f"    @{info.name}.setter", f"    def {info.name}(self, value: Any) -> None: ..."]
    return "\n".join(lines) + "\n"


def _returns(algorithm: Algorithm) -> str:
    if algorithm.name.startswith("frame_placement"):
        return "Placement"
    return "np.ndarray" if len(algorithm.outputs) == 1 else "Any"  # a named tuple, or with `only` an array


def algorithms() -> str:
    lines = [HEAD + "from numpy.typing import ArrayLike\n\nfrom .arrays import Placement\n", "def description(algorithm: Any) -> str: ...\n", "class Algorithms:"]
    for algorithm in ALGORITHMS.values():
        inputs = [
            f"{name}: {TYPES.get(name, 'ArrayLike')}{' | None = None' if name in OPTIONAL else ''}".replace("Any | None", "Any") for name in algorithm.inputs
        ]
        more = ["*", "only: str | None = None", "out: Any = None", "status: np.ndarray | None = None"]
        lines += [f"    def {algorithm.name}(self, {', '.join(inputs + more)}) -> {_returns(algorithm)}:", f'        """{of_algorithm(algorithm)}"""']
    return "\n".join(lines) + "\n"


STUBS = {"field_properties.pyi": fields, "batch_methods.pyi": algorithms}

if __name__ == "__main__":
    for name, text in STUBS.items():
        (Path(__file__).parent / name).write_text(text(), encoding="utf-8")
