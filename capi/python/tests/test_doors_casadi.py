"""The CasADi door: externals and callbacks, their derivatives of both orders, and an optimisation problem."""

import subprocess

import doors
import numpy as np
import pytest
from conftest import CAPI

casadi = pytest.importorskip("casadi", reason="package casadi is not installed")

import libdyn as dyn  # noqa: E402
from libdyn.doors import casadi as door  # noqa: E402
from libdyn.doors.compiled import compiler  # noqa: E402

METHODS = ["callback", *(["compiled"] if compiler("cc") else [])]
method = pytest.mark.parametrize("method", METHODS)
close = np.testing.assert_allclose


def numeric(f):
    """f on arrays, its outputs as vectors."""
    return lambda *x: [np.array(y).reshape(-1) for y in doors.tuples(f(*x))]


@method
@doors.every
def test_first_order(robot, name, method):
    f, x = doors.opened(robot, name)
    x = [a[1] for a in x]
    g = door.function(f.model, name, method=method, **doors.options(f.model, name))
    assert g.name_in() == [i.name for i in f.inputs] and g.name_out() == [o.name for o in f.outputs]
    for a, b in zip(numeric(g)(*x), f(*x)):
        close(a, b, atol=1e-11)  # the batch takes several states side by side, which rounds otherwise
    y = g(*x)
    J = doors.tuples(g.jacobian()(*x, *(y if isinstance(y, tuple) else (y,))))
    n = len(x)
    doors.assert_derivatives(numeric(g), x, [J[k : k + n] for k in range(0, len(J), n)])


def hessian(g, f, x, weights):
    """Of the weighted sum of all outputs, as CasADi finds it; and its gradient."""
    symbols = [casadi.MX.sym(i.name, i.size) for i in f.inputs]
    y = g(*symbols)
    s = sum(casadi.dot(casadi.DM(w), a) for w, a in zip(weights, y if isinstance(y, tuple) else (y,)))
    z = casadi.vertcat(*symbols)
    H, gradient = casadi.hessian(s, z)
    return tuple(np.array(a) for a in casadi.Function("h", symbols, [H, gradient])(*x))


@method
@doors.every
def test_second_order(robot, name, method):
    """Hessians of products from the left, by the numbers of q: exact, but differences for the step and in callbacks."""
    f, x = doors.opened(robot, name)
    x = [a[2] for a in x]
    rng = np.random.default_rng(5)
    weights = [rng.standard_normal(o.size) for o in f.outputs]
    H, gradient = hessian(door.function(f.model, name, method=method, **doors.options(f.model, name)), f, x, weights)

    def products(*x):
        J = f.jacobians(*x)[1]
        return [np.concatenate([sum(w @ by[i] for w, by in zip(weights, J)) for i in range(len(x))])]

    close(gradient[:, 0], products(*x)[0], atol=1e-9)
    columns = [doors.derivative(products, x, i, k)[0] for i, a in enumerate(x) for k in range(a.size)]
    expected = np.stack(columns, -1)
    exact = method == "compiled" and name != "step"
    close(H, expected, atol=(1e-8 if exact else 1e-5) * max(1, abs(expected).max()))
    if exact:
        close(H, H.T, atol=1e-10 * abs(H).max())


@method
def test_an_optimisation_problem(method):
    """Least holding torque with the hand at a place: IPOPT, with Hessians of both functions."""
    m = doors.load("panda")
    frame = m.nframes - 1
    rnea = door.function(m, "rnea", method=method)
    placement = door.function(m, "frame_placement", frame=frame, method=method)
    q, start, zero = casadi.MX.sym("q", m.nq), (np.maximum(m.lower_limit, -3) + np.minimum(m.upper_limit, 3)) / 2, np.zeros(m.nv)
    d = m.data()
    d.forward_kinematics(start)
    goal = d.frame_placement(frame).translation + [0.1, 0.1, -0.1]
    problem = {"x": q, "f": casadi.sumsqr(rnea(q, zero, zero)) / 100 + casadi.sumsqr(q - start), "g": placement(q)[9:]}
    solver = casadi.nlpsol("s", "ipopt", problem, {"ipopt.print_level": 0, "print_time": False, "ipopt.tol": 1e-9})
    found = solver(x0=start, lbg=goal, ubg=goal)
    assert solver.stats()["success"] and solver.stats()["iter_count"] < 30
    d.forward_kinematics(np.array(found["x"]).reshape(-1))
    close(d.frame_placement(frame).translation, goal, atol=1e-8)


@pytest.mark.skipif(not compiler("cc"), reason="no C compiler")
def test_the_file_stands_alone(tmp_path):
    """The C file holds the model: it is compiled without warnings, and opened by its path."""
    m = doors.load("go2")
    source = door.generate(m, "step", tmp_path / "leap.c", symbol="leap", dt=2e-3)
    warnings = ("-std=c11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", f"-I{CAPI.parent / 'include'}")
    subprocess.run([compiler("cc"), *warnings, str(source)], check=True)
    leap = casadi.external("leap", str(door.build(source)))
    x = [m.neutral(), np.ones(18), np.ones(18)]
    expected = doors.Function(m, "step", dt=2e-3)(*x)
    for a, b in zip(leap(*x), expected):
        np.testing.assert_array_equal(np.array(a)[:, 0], b)


@pytest.mark.skipif(not compiler("cc"), reason="no C compiler")
def test_threads():
    """Each thread of a map has data of its own."""
    m = doors.load("panda")
    rng, n = np.random.default_rng(2), 40
    x = [np.array([m.random(k) for k in range(n)]).T, *rng.standard_normal((2, m.nv, n))]
    one = door.function(m, "aba", method="compiled")
    np.testing.assert_array_equal(np.array(one.map(n, "thread", 2)(*x)), np.array(one.map(n)(*x)))


@method
def test_what_fails_is_said(method):
    m = doors.load("panda")
    with pytest.raises(RuntimeError):
        door.function(m, "aba", method=method)(np.full(m.nq, np.nan), np.zeros(m.nv), np.zeros(m.nv))


def test_refusals(tmp_path):
    m = doors.load("panda")
    with pytest.raises(dyn.ArgumentError, match="method"):
        door.function(m, "aba", method="fast")
    with pytest.raises(dyn.ArgumentError, match="symbol"):
        door.generate(m, "aba", tmp_path / "a.c", symbol="a b")
