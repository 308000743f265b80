"""CasADi: functions of a model as casadi.Function, with exact Jacobians (package casadi).

    from libdyn.doors import casadi as door
    aba = door.function(model, "aba")                       # (q, v, tau) -> ddq
    foot = door.function(model, "frame_placement", frame="FL_foot")
    ddq = aba(q, v, tau)                                    # casadi.MX in optimisation problems

By a C compiler the function is an external of machine code, which holds the model itself. generate writes this C file, for
acados and programs without Python. Products from the left and their Hessians are exact as well: of step, which has no analytic
second derivatives, Hessians are central differences of the exact Jacobian. Without a compiler the function is a callback into
Python, with exact Jacobians and Hessians by differences of them.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import casadi  # type: ignore[import-not-found, import-untyped, unused-ignore]
import numpy as np

from ..errors import ArgumentError
from .compiled import compiler, shared_library
from .function import Function
from .tangent import blocks

if TYPE_CHECKING:
    from ..model import Model

SOURCE = Path(__file__).with_name("native") / "casadi_external.c"


def generate(model: Model, name: str, path: str | os.PathLike[str], symbol: str = "", **options: Any) -> Path:
    """Writes a C file of one function with its model, and returns its path. Link it with libdyn.

    symbol   name of the function in C (default: name); jac_, adj1_ and jac_adj1_ stand in front of those of its derivatives
    options  frame, dt, integrator: see libdyn.doors.function
    """
    return _write(Function(model, name, threads=1, **options), Path(path), symbol or name)


def _write(f: Function, path: Path, symbol: str) -> Path:
    if not symbol.isidentifier() or not symbol.isascii():
        raise ArgumentError(f"symbol is {symbol!r}, but must be a name of C.")
    blocks(f.model)  # refuses what has no tangent map
    image = f.model.image(names=False)
    words = np.frombuffer(image + bytes(-len(image) % 8), "<u8")
    stepping = f.data.step_options if f.name == "step" else None
    lines = [
        f"/* {f.name}, written by libdyn.doors.casadi. */",
        f"#define DOOR_NAME {symbol}",
        f"#define DOOR_KIND DOOR_{f.name.upper()}",
        f"#define DOOR_FRAME {f.frame}",
        f"#define DOOR_DT {stepping.dt if stepping else 0.0!r}",
        f"#define DOOR_INTEGRATOR {stepping.integrator if stepping else -1}",
        "static _Alignas(64) const unsigned long long door_image[] = {",
        *(",".join(map(hex, words[k : k + 6])) + "," for k in range(0, len(words), 6)),
        "};",
    ]
    path.write_text("\n".join(lines) + "\n" + SOURCE.read_text(encoding="utf-8"), encoding="utf-8")
    return path


def build(source: str | os.PathLike[str]) -> Path:
    """Compiles a file of generate, and returns the shared library beside it, which casadi.external takes."""
    return shared_library(source, "cc", "-std=c11")


def function(model: Model, name: str, *, method: Literal["auto", "compiled", "callback"] = "auto", symbol: str = "",
             **options: Any) -> casadi.Function:
    """A function of a model as a casadi.Function.

    method   "compiled": an external, by a C compiler; "callback": into Python; "auto": the first, where a compiler is
    symbol   the function's name in CasADi (default: name)
    options  frame, dt, integrator: see libdyn.doors.function
    """
    if method not in ("auto", "compiled", "callback"):
        raise ArgumentError(f"method is {method!r}, but must be 'auto', 'compiled' or 'callback'.")
    f, symbol = Function(model, name, threads=1, **options), symbol or name
    if method == "callback" or (method == "auto" and not compiler("cc")):
        return _kept(_Value(symbol, f))
    with tempfile.TemporaryDirectory() as folder:  # the library stays loaded
        return casadi.external(symbol, str(build(_write(f, Path(folder) / f"{symbol}.c", symbol))))


_callbacks: list[Any] = []


def _kept(callback: Any) -> Any:
    """CasADi holds no reference to a callback's Python object."""
    _callbacks.append(callback)
    return callback


class _Callback(casadi.Callback):  # type: ignore[misc, unused-ignore]
    """Inputs: those of f, then outputs that CasADi hands over. outputs: (name, rows, columns)."""

    def __init__(self, symbol: str, f: Function, inputs: list[tuple[str, int]], outputs: list[tuple[str, int, int]],
                 options: dict[str, Any]):
        casadi.Callback.__init__(self)
        self.f, self.inputs, self.outputs, self.symbol = f, inputs, outputs, symbol
        self.construct(symbol, options)

    def get_n_in(self) -> int:
        return len(self.inputs)

    def get_n_out(self) -> int:
        return len(self.outputs)

    def get_name_in(self, i: int) -> str:
        return self.inputs[i][0]

    def get_name_out(self, i: int) -> str:
        return self.outputs[i][0]

    def get_sparsity_in(self, i: int) -> Any:
        return casadi.Sparsity.dense(self.inputs[i][1], 1)

    def get_sparsity_out(self, i: int) -> Any:
        return casadi.Sparsity.dense(*self.outputs[i][1:])

    def given(self, x: Any) -> list[np.ndarray]:
        return [np.array(a).reshape(-1) for a in x[: len(self.f.inputs)]]


class _Value(_Callback):
    def __init__(self, symbol: str, f: Function):
        super().__init__(symbol, f, [i[:2] for i in f.inputs], [(o.name, o.size, 1) for o in f.outputs], {})

    def eval(self, x: Any) -> list[Any]:
        return list(self.f(*self.given(x)))

    def has_jacobian(self) -> bool:
        return True

    def get_jacobian(self, symbol: str, names_in: Any, names_out: Any, options: dict[str, Any]) -> Any:
        return _kept(_Jacobian(symbol, self.f, names_in, names_out))


class _Jacobian(_Callback):
    def __init__(self, symbol: str, f: Function, names_in: Any, names_out: Any):
        sizes = [i.size for i in f.inputs] + [o.size for o in f.outputs]
        shapes = [(o.size, i.size) for o in f.outputs for i in f.inputs]
        super().__init__(symbol, f, list(zip(names_in, sizes)), [(n, *s) for n, s in zip(names_out, shapes)], {"enable_fd": True})

    def eval(self, x: Any) -> list[Any]:
        return [j for by in self.f.jacobians(*self.given(x))[1] for j in by]
