"""Data: its fields, stale reads, lifetimes, memory."""

import gc
import re
import subprocess
import sys
import weakref

import numpy as np
import pytest

import libdyn as dyn
from libdyn.messages import in_python

close = np.testing.assert_allclose


@pytest.fixture
def d(go2):
    return go2.data()


def test_new_data_is_neutral_and_at_rest(go2, d):
    np.testing.assert_array_equal(d.q, go2.neutral())
    assert not d.v.any() and not d.a.any() and not d.tau_applied.any() and d.time == 0.0
    assert "go2" in repr(d) or go2.name in repr(d)


def test_fields_are_described(d):
    assert {"q", "v", "M", "com", "J"} <= set(dyn.FIELDS) and set(dyn.FIELDS) <= set(dir(d))
    for name, info in dyn.FIELDS.items():
        assert info.name == name and info.sentence and info.shape
    assert "joint-space" in type(d).M.__doc__ and "nv x nv" in type(d).M.__doc__ and "Data.crba" in type(d).M.__doc__


def test_every_field_has_its_shape(go2, d, state):
    q, v, a, tau = state
    d.all_terms(dyn.Term.ALL, q, v)
    d.aba_derivatives(q, v, tau)
    d.rnea_derivatives(q, v, a)
    d.rnea(q, v, a)
    d.constrained_dynamics(q, v, tau)
    d.forward_kinematics(q, v, a)
    d.frame_placements()
    d.joint_jacobians_time_variation(q, v)
    d.jcom(q)
    d.centroidal(q, v, a)
    d.centroidal_derivatives(q, v, a)
    d.vcom_derivatives(q, v)
    d.gravity_torque_derivatives(q)
    d.static_torque_derivatives(q)
    d.rnea_second_order_product(a, q, v, a)
    d.joint_torque_regressor(q, v, a)
    d.compute_distances(q)
    d.tendons(q, v)
    d.sensors(q, v, a)
    given = {"q": q, "v": v, "a": a, "tau": tau}
    for info in dyn.FIELDS.values():
        try:
            d.field(info.name)
        except dyn.StaleError:
            made_by = getattr(d, in_python(info.producer).partition(".")[2])
            made_by(*(given.get(name) for name in dyn.ALGORITHMS[info.producer.removeprefix("dyn_")].inputs))
    sizes = {"nrows": 48, "nu": 0, "na": 0, "nactuators": 0, "ntendons": 0, "nmocaps": 0, "nsensordata": 0,
             "npairs": go2.npairs,
             "nparameters": 10 * (go2.njoints - 1), "nq": go2.nq, "nv": go2.nv, "nframes": go2.nframes, "njoints": go2.njoints}
    for name, info in dyn.FIELDS.items():
        value = d.field(name)
        shape = tuple(sizes[s] if s in sizes else int(s) for s in info.shape.split(" x "))
        if set(shape) == {1}:
            assert isinstance(value, float), name
        else:
            assert value.shape in (shape, shape[:1] if shape[-1] == 1 else shape), name
            assert not value.flags.writeable and value.dtype == np.float64, name


def test_stale(d, state):
    q, v = state[:2]
    with pytest.raises(dyn.StaleError, match="crba"):
        d.M
    d.crba(q)
    assert d.M.shape == (18, 18)
    d.q = q.copy()  # the same state: what was computed still holds
    d.M
    d.q = -q
    with pytest.raises(dyn.StaleError) as caught:
        d.M
    assert caught.value.status_name == "DYN_ERROR_STALE"
    d.forward_kinematics(q)
    with pytest.raises(dyn.StaleError):
        d.frame_velocity("base", "LOCAL")
    d.forward_kinematics(q, v)
    d.frame_velocity(1)


def test_views_follow_the_data_and_methods_answer_copies(d, go2, state):
    q = state[0]
    first = d.gravity_torque(q)
    view = d.g
    np.testing.assert_array_equal(first, view)
    second = d.gravity_torque(go2.random(99))
    assert not np.array_equal(first, second)
    np.testing.assert_array_equal(view, second)
    assert d.g is view


def test_views_are_read_only(d):
    with pytest.raises(ValueError):
        d.q[0] = 1
    with pytest.raises(AttributeError):
        d.M = np.eye(18)


def test_unknown_fields(d):
    with pytest.raises(dyn.UnknownNameError):
        d.field("mass_matrix")
    with pytest.raises(AttributeError):
        d.mass_matrix
    with pytest.raises(dyn.Error):
        d.field(10000)


def test_data_keeps_the_model_and_views_keep_the_data(arm):
    d = arm.data()
    model, data, q = weakref.ref(arm._owner), weakref.ref(d._owner), d.q
    del d
    gc.collect()
    assert data() is not None and model() is not None and q.shape == (2,)
    part = q[1:]
    del q
    gc.collect()
    assert data() is not None and part[0] == 0
    del part
    gc.collect()
    assert data() is None


def test_no_reference_cycles(arm):
    gc.disable()
    try:
        d = arm.data()
        d.crba([0, 0]), d.M, d.q
        owner = weakref.ref(d._owner)
        del d
        assert owner() is None
    finally:
        gc.enable()


@pytest.mark.parametrize("make", [bytearray, lambda n: np.zeros(n, np.uint8), lambda n: np.zeros(n // 8 + 1)])
def test_in_memory_of_the_caller(arm, make):
    size = arm.data_size()
    memory = make(size)
    d = arm.data(memory=memory)
    start = np.frombuffer(memory, np.uint8).__array_interface__["data"][0]
    assert start <= d.q.__array_interface__["data"][0] < start + size
    close(d.gravity_torque([0.1, 0.2]), arm.data().gravity_torque([0.1, 0.2]))
    del memory
    gc.collect()
    d.crba([0.1, 0.2])


def test_in_memory_errors(arm):
    with pytest.raises(dyn.SizeError):
        arm.data(memory=bytearray(16))
    with pytest.raises(dyn.ArgumentError, match="read-only"):
        arm.data(memory=bytes(arm.data_size()))
    with pytest.raises(dyn.ArgumentError, match="buffer"):
        arm.data(memory=5)


def test_parts(arm):
    d = arm.data("inverse")
    d.rnea([0, 0], [0, 0], [0, 0])
    with pytest.raises(dyn.PartError, match="(?i)mass"):
        d.crba([0, 0])
    assert arm.data_size("inverse") < arm.data_size()
    assert arm.data(["mass", dyn.Part.COM]).parts == dyn.Part.MASS | dyn.Part.COM
    assert arm.data(0).parts == dyn.Part.ALL
    for bad in ("wheels", 1 << 22, -1, 1.5):
        with pytest.raises(dyn.ArgumentError):
            arm.data(bad)


LARGE = """
import resource
import libdyn as dyn
body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
links = ['<link name="l0"/>'] + [f'<link name="l{i + 1}">{body}</link>' for i in range(6000)]
joints = [
    f'<joint name="j{i}" type="continuous"><parent link="l{i}"/><child link="l{i + 1}"/><axis xyz="0 1 0"/></joint>'
    for i in range(6000)
]
m = dyn.load_string("<robot name='chain'>" + "".join(links + joints) + "</robot>", base="fixed")
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
try:
    m.data()
except dyn.OutOfMemoryError as error:
    print(error)
assert m.data("simulation").step() is None
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits the address space")
def test_an_error_names_the_parts_that_are_large():
    out = subprocess.run([sys.executable, "-c", LARGE], capture_output=True, text=True, check=True).stdout
    assert re.search(r"no memory for [\d.]+ GB: ask for fewer parts", out)
    for part in ("FORWARD_DERIVATIVES", "SECOND_ORDER", "CONSTRAINT_DERIVATIVES"):
        assert re.search(rf"; {part} takes [\d.]+ GB", out), part
    assert "MASS takes" not in out  # 0.3 GB


def test_simulations_of_a_quadruped_take_little(go2):
    ground = dyn.Builder.from_model(go2).add_shape("universe", "half_space", name="ground").finish()
    assert ground.data_size("simulation") <= 400e3
