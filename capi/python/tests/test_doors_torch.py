"""The PyTorch door."""

import doors
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="package torch is not installed")

import libdyn as dyn  # noqa: E402
from libdyn.doors import torch as door  # noqa: E402


def tuples(y):
    return y if isinstance(y, tuple) else (y,)


@doors.every
def test_derivatives(robot, name):
    f, x = doors.opened(robot, name)
    g = door.function(f.model, name, threads=1, **doors.options(f.model, name))
    for a, b in zip(tuples(g(*map(torch.tensor, x))), f(*x)):
        np.testing.assert_array_equal(a.numpy(), b)
    one = [torch.tensor(a[1], requires_grad=True) for a in x]
    J = torch.autograd.functional.jacobian(lambda *x: tuples(g(*x)), tuple(one))
    doors.assert_derivatives(f, [a[1] for a in x], [[j.numpy() for j in by] for by in J])


def test_forward_mode():
    f, x = doors.opened("go2", "aba")
    g, rng = door.function(f.model, "aba", threads=1), np.random.default_rng(1)
    dx = [rng.standard_normal(a.shape) for a in x]
    with torch.autograd.forward_ad.dual_level():
        duals = [torch.autograd.forward_ad.make_dual(torch.tensor(a), torch.tensor(d)) for a, d in zip(x, dx)]
        moved = torch.autograd.forward_ad.unpack_dual(g(*duals)).tangent.numpy()
    expected = sum(np.einsum("nij,nj->ni", j, d) for j, d in zip(f.jacobians(*x)[1][0], dx))
    np.testing.assert_allclose(moved, expected, rtol=1e-12, atol=1e-9)


def test_gradcheck():
    """PyTorch's own check, over a batch."""
    f, x = doors.opened("panda", "rnea")
    g = door.function(f.model, "rnea", threads=1)
    assert torch.autograd.gradcheck(g, [torch.tensor(a, requires_grad=True) for a in x], eps=1e-6, atol=1e-6)


def test_refusals():
    m = doors.load("go2")
    g = door.function(m, "aba")
    with pytest.raises(dyn.ArgumentError, match="float64"):
        g(torch.zeros(19), torch.zeros(18), torch.zeros(18))
    with pytest.raises(dyn.SizeError, match="v"):
        g(torch.tensor(m.neutral()), torch.zeros(3, dtype=torch.float64), torch.zeros(18, dtype=torch.float64))
