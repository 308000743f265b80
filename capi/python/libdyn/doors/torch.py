"""PyTorch: functions of a model under autograd (package torch), in double precision on the processor.

    from libdyn.doors import torch as door
    aba = door.function(model, "aba")                        # (q, v, tau) -> ddq
    aba(q, v, tau).square().sum().backward()                 # q: (..., nq), v, tau: (..., nv)

All states of a call go to libdyn's batch at once, which takes them on its threads. Derivatives are exact, of first order,
backward and forward. Steps are made one after another.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import torch  # type: ignore[import-not-found, unused-ignore]

from ..errors import ArgumentError
from .function import Function

if TYPE_CHECKING:
    from ..model import Model


class _Opened(torch.autograd.Function):  # type: ignore[misc, unused-ignore]
    @staticmethod
    def forward(f: Function, *x: Any) -> tuple[Any, ...]:
        return tuple(torch.from_numpy(y) for y in f(*(a.detach().numpy() for a in x)))

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Any) -> None:
        ctx.f = inputs[0]
        ctx.save_for_backward(*inputs[1:])
        ctx.save_for_forward(*inputs[1:])

    @staticmethod
    def jacobians(ctx: Any) -> list[list[Any]]:
        J = ctx.f.jacobians(*(a.detach().numpy() for a in ctx.saved_tensors))[1]
        return [[torch.from_numpy(j.copy()) for j in by] for by in J]

    @staticmethod
    @torch.autograd.function.once_differentiable  # type: ignore[untyped-decorator, unused-ignore]
    def backward(ctx: Any, *seeds: Any) -> tuple[Any, ...]:
        J = _Opened.jacobians(ctx)
        return None, *(sum((j[i].mT @ s[..., None])[..., 0] for j, s in zip(J, seeds)) for i in range(len(J[0])))

    @staticmethod
    def jvp(ctx: Any, _: Any, *dx: Any) -> tuple[Any, ...]:
        return tuple(sum((j @ d[..., None])[..., 0] for j, d in zip(by, dx) if d is not None) for by in _Opened.jacobians(ctx))


def function(model: Model, name: str, **options: Any) -> Callable[..., Any]:
    """A function of a model on tensors. It returns a tensor, or a tuple where there are several outputs.

    options  frame, dt, integrator, threads: see libdyn.doors.function
    """
    f = Function(model, name, **options)

    def call(*x: Any) -> Any:
        for a, i in zip(x, f.inputs):
            if not isinstance(a, torch.Tensor) or a.dtype != torch.float64 or a.device.type != "cpu":
                raise ArgumentError(f"{i.name} must be a tensor of torch.float64 on the processor: libdyn computes with doubles.")
        y = _Opened.apply(f, *x)
        return y if len(y) > 1 else y[0]

    call.__name__, call.__doc__ = name, repr(f)
    return call
