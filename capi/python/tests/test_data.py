"""Data: its fields, stale reads, lifetimes, memory."""

import gc
import weakref

import numpy as np
import pytest

import libdyn as dyn

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
    d.compute_com(q, v, a)
    d.aba_derivatives(q, v, tau)
    d.rnea_derivatives(q, v, a)
    d.compute_static_torque(q)
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
    d.compute_static_regressor(q)
    d.compute_kinetic_energy_regressor(q, v)
    d.compute_potential_energy_regressor(q)
    d.compute_distances(q)
    sizes = {"nrows": 48, "nu": 0, "na": 0, "nactuators": 0, "npairs": go2.npairs, "nparameters": 10 * (go2.njoints - 1), "nq": go2.nq, "nv": go2.nv, "nframes": go2.nframes, "njoints": go2.njoints}
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
    for bad in ("wheels", 1 << 21, -1, 1.5):
        with pytest.raises(dyn.ArgumentError):
            arm.data(bad)
<<<<<<< HEAD
=======


# ------------------------------------------------------------------------------------------------- inputs


def test_array_likes(arm):
    d = arm.data()
    expected = d.rnea(np.array([1.0, 2]), np.array([3.0, 4]), np.array([5.0, 6]))
    strided = np.arange(1.0, 13).reshape(6, 2)[:, ::1]
    for q in (
        [1, 2],
        (1.0, 2.0),
        np.array([1, 2]),
        np.array([1, 2], np.float32),
        range(1, 3),
        strided[0],
        np.array([1.0, 9, 2])[::2],
    ):
        np.testing.assert_array_equal(d.rnea(q, [3, 4], np.array([5, 9, 6])[::2]), expected)


def test_wrong_shapes(d, go2):
    q, v = go2.neutral(), np.zeros(18)
    for bad in (v, q[None], 1.0, [], np.zeros((0,))):
        with pytest.raises(dyn.SizeError, match=r"q has shape .* must have shape \(19,\)"):
            d.gravity_torque(bad)
    with pytest.raises(dyn.SizeError, match=r"v has shape \(19,\), but must have shape \(18,\)"):
        d.rnea(q, q, v)
    with pytest.raises(dyn.SizeError, match=r"fext has shape \(18,\), but must have shape \(6, 14\)"):
        d.rnea(q, v, v, v)
    with pytest.raises(ValueError):
        d.q = v


def test_wrong_kinds(d, go2):
    for bad in ("text", ["a"] * 19, np.zeros(19, complex), np.zeros(19, object), [[1, 2], [3]], np.zeros(19, bool)):
        with pytest.raises(dyn.ArgumentError):
            d.gravity_torque(bad)


def test_not_finite_leaves_the_data_alone(d, go2, state):
    q, v, a, _ = state
    tau = d.rnea(q, v, a)
    bad = v.copy()
    bad[4] = np.nan
    with pytest.raises(dyn.NonFiniteError, match="4"):
        d.rnea(q, bad, a)
    np.testing.assert_array_equal(d.tau, tau)
    np.testing.assert_array_equal(d.v, v)
    q = q.copy()
    q[3:7] = 0
    with pytest.raises(dyn.QuaternionError):
        d.gravity_torque(q)


def test_held_state(d, state):
    q, v, a, tau = state
    d.set_state(q, v, a, tau)
    np.testing.assert_array_equal(d.rnea(), d.rnea(q, v, a))
    d.set_state(tau=tau)
    np.testing.assert_array_equal(d.aba(), d.aba(q, v, tau))
    d.v = 2 * v
    np.testing.assert_array_equal(d.v, 2 * v)
    np.testing.assert_array_equal(d.tau_applied, tau)


def test_state_dictionaries(d, go2, state, gripper):
    q, v, a, tau = state
    d.set_state(q, v, a, tau)
    saved = json.loads(json.dumps({k: x.tolist() for k, x in d.state.items()}))
    assert set(saved) == {"q", "v", "a", "tau"}
    other = go2.data()
    other.set_state(**saved)
    np.testing.assert_array_equal(other.aba(), d.aba())
    # by joint
    joint = go2.joints[3]
    d.set_state(q={joint.name: 0.25}, v={joint.name: [2]})
    expected = go2.neutral()
    expected[joint.idx_q] = 0.25
    np.testing.assert_array_equal(d.q, expected)
    assert d.v[joint.idx_v] == 2 and np.count_nonzero(d.v) == 1
    d.q = {"root_joint": [1, 2, 3, 0, 0, 0, 1]}
    assert d.q[:3].tolist() == [1, 2, 3]
    assert go2.integrate(go2.neutral(), {joint.name: 0.5})[joint.idx_q] == 0.5
    with pytest.raises(dyn.SizeError, match=r"q\['root_joint'\] has shape \(2,\), but must have shape \(7,\)"):
        d.q = {"root_joint": [1, 2]}
    with pytest.raises(dyn.UnknownNameError):
        d.q = {"nothing": 1}
    with pytest.raises(dyn.ArgumentError, match="follows 'left_knuckle_joint'"):
        gripper.data().q = {"thumb_joint": 1}


# ------------------------------------------------------------------------------------------------- kinematics


def test_frames(d, go2, state):
    q, v, a, _ = state
    d.forward_kinematics(q, v, a)
    every = d.frame_placements()
    assert every.rotation.shape == (go2.nframes, 3, 3) and every.matrix.shape == (go2.nframes, 4, 4)
    foot = go2.nframes - 1
    X = d.frame_placement(foot)
    close(every.rotation[foot], X.rotation)
    close(every.translation[foot], X.translation)
    close(X.rotation @ X.rotation.T, np.eye(3), atol=1e-12)
    local, world, aligned = (d.frame_velocity(foot, r) for r in dyn.Reference)
    close(aligned[:3], X.rotation @ local[:3], atol=1e-12)
    close(aligned[3:], X.rotation @ local[3:], atol=1e-12)
    close(world[:3], aligned[:3] - np.cross(aligned[3:], X.translation), atol=1e-11)
    np.testing.assert_array_equal(world, d.frame_velocity(foot, "world"))
    np.testing.assert_array_equal(world, d.frame_velocity(go2.frame_name(foot), 1))
    spatial = d.frame_acceleration(foot, "LOCAL_WORLD_ALIGNED")
    classical = d.frame_classical_acceleration(foot, "LOCAL_WORLD_ALIGNED")
    close(classical[:3], spatial[:3] + np.cross(aligned[3:], aligned[:3]), atol=1e-10)
    for r in dyn.Reference:
        J, dJ = d.frame_jacobian(foot, r), d.frame_jacobian_time_variation(foot, r)
        assert J.shape == dJ.shape == (6, 18)
        close(J @ v, d.frame_velocity(foot, r), atol=1e-11)
        if r != dyn.Reference.LOCAL_WORLD_ALIGNED:
            close(J @ a + dJ @ v, d.frame_acceleration(foot, r), atol=1e-9)
    with pytest.raises(dyn.ArgumentError, match="LOCAL_WORLD_ALIGNED"):
        d.frame_velocity(foot, "body")
    with pytest.raises(dyn.UnknownNameError):
        d.frame_velocity("no_foot")
    with pytest.raises(dyn.ArgumentError):
        d.frame_placement(go2.nframes)


def test_joint_jacobians(d, state):
    q, v = state[:2]
    J = d.joint_jacobians(q)
    np.testing.assert_array_equal(J, d.J)
    dJ = d.joint_jacobians_time_variation(q, v)
    np.testing.assert_array_equal(dJ, d.dJ)
    assert J.shape == dJ.shape == (6, 18)


def test_center_of_mass(d, go2, state):
    q, v, a, _ = state
    com = d.compute_com(q, v, a)
    np.testing.assert_array_equal(com, d.com)
    vcom, acom = d.vcom.copy(), d.acom.copy()
    Jcom = d.jcom(q)
    assert Jcom.shape == (3, 18) and acom.shape == (3,)
    close(Jcom @ v, vcom, atol=1e-12)
    d.compute_com(q, v, a)
    whole, mass = d.subtree_com(0)
    close(whole, com)
    assert mass == pytest.approx(go2.total_mass)
    joint = go2.joints[2].name
    assert 0 < d.subtree_com(joint)[1] < mass
    assert d.subtree_jcom(joint).shape == (3, 18)
    close(d.subtree_jcom(1), Jcom, atol=1e-12)


# ------------------------------------------------------------------------------------------------- dynamics


def test_dynamics_agree(d, go2, state):
    q, v, a, tau = state
    M, nle, g, C = d.crba(q), d.compute_nle(q, v), d.gravity_torque(q), d.coriolis_matrix(q, v)
    np.testing.assert_array_equal(M, M.T)
    close(d.rnea(q, v, a), M @ a + nle, rtol=1e-9, atol=1e-9)
    close(C @ v + g, nle, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(d.rnea(q, 0 * v, 0 * a), g)
    ddq = d.aba(q, v, tau)
    close(d.rnea(q, v, ddq), tau, atol=1e-8)
    Minv = d.minv(q)
    close(Minv @ M, np.eye(18), atol=1e-8)
    close(Minv @ (tau - nle), ddq, rtol=1e-6, atol=1e-6)
    np.testing.assert_array_equal(d.Minv, Minv)


def test_external_forces(d, go2, state):
    q, v, a, tau = state
    fext = np.random.default_rng(1).standard_normal((6, go2.njoints))
    d.forward_kinematics(q)
    pushed = sum(
        d.frame_jacobian(go2.frame_id(go2.joint_name(i), "joint"), "LOCAL").T @ fext[:, i] for i in range(1, go2.njoints)
    )
    close(d.rnea(q, v, a, fext), d.rnea(q, v, a) - pushed, atol=1e-9)
    close(d.compute_static_torque(q, fext), d.gravity_torque(q) - pushed, atol=1e-9)
    close(d.rnea(q, v, d.aba(q, v, tau, fext), fext), tau, atol=1e-8)
    np.testing.assert_array_equal(d.rnea(q, v, a, fext), d.rnea(q, v, a, np.asfortranarray(fext)))
    np.testing.assert_array_equal(d.rnea(q, v, a, fext), d.rnea(q, v, a, fext.tolist()))


def test_factor_and_solve(d, state):
    q = state[0]
    with pytest.raises(dyn.StaleError):
        d.cholesky()
    M = d.crba(q)
    d.cholesky()
    b = np.random.default_rng(2).standard_normal((18, 3))
    close(M @ d.cholesky_solve(b), b, atol=1e-9)
    close(d.cholesky_solve(b[:, 1]), d.cholesky_solve(b)[:, 1], rtol=1e-12)
    assert d.cholesky_solve(b[:, 0]).shape == (18,)
    for bad in (b[:5], b.T, np.zeros((18, 1, 1))):
        with pytest.raises(dyn.SizeError):
            d.cholesky_solve(bad)


def test_energy(d, state):
    q, v = state[:2]
    energy = d.energy(q, v)
    M, com = d.crba(q), d.compute_com(q)
    assert energy.kinetic == pytest.approx(0.5 * v @ M @ v)
    assert energy.potential == pytest.approx(9.81 * d.model.total_mass * com[2])
    assert (d.kinetic_energy(q, v), d.potential_energy(q)) == energy
    d.energy(q, v)
    assert d.mechanical == pytest.approx(sum(energy)) and isinstance(d.kinetic, float)


def test_all_terms(d, state):
    q, v = state[:2]
    filled = d.all_terms(q=q, v=v)
    assert filled == dyn.Term.ALL
    M, nle, com = d.M.copy(), d.nle.copy(), d.com.copy()
    np.testing.assert_allclose(M, d.crba(q), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(nle, d.compute_nle(q, v), rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(com, d.compute_com(q), rtol=1e-12)
    d.set_state(q, v)
    assert dyn.Term.MASS in d.all_terms("mass") and dyn.Term.COM in d.all_terms(["mass", dyn.Term.COM])
    with pytest.raises(dyn.Error):
        d.all_terms(1 << 31)
    with pytest.raises(dyn.ArgumentError):
        d.all_terms("everything")


# ------------------------------------------------------------------------------------------------- simulation


@pytest.mark.parametrize("integrator, drift", [("semi_implicit_euler", 3e-2), (dyn.Integrator.RK4, 1e-9)])
def test_step(arm, integrator, drift):
    d = arm.data()
    d.set_effects(("armature", "limits"))
    d.set_state([1, 0.5], [0, 0])
    start = sum(d.energy())
    for _ in range(1000):
        d.step(1e-3, integrator)
    assert d.time == pytest.approx(1) and not np.array_equal(d.q, [1, 0.5])
    assert abs(sum(d.energy()) - start) < drift


def test_step_under_torque(arm):
    d = arm.data()
    d.set_effects("armature")
    d.set_state([0, 0], [0, 0], tau=[0.5, -0.25])
    ddq = d.aba([0, 0], [0, 0], [0.5, -0.25])
    d.step(1e-6)
    close(d.v, 1e-6 * ddq, rtol=1e-5)


def test_step_errors(arm):
    d = arm.data()
    for bad in (float("nan"), float("inf"), 0, -1e-3):
        with pytest.raises(dyn.Error):
            d.step(bad)
    with pytest.raises(dyn.ArgumentError, match="RK4"):
        d.step(1e-3, "euler")
    assert d.time == 0
    q = d.q.copy()
    d.set_state(v=[1e200, -1e200])
    with pytest.raises(dyn.NumericError):
        for _ in range(10):
            d.step(1e100, "rk4")
    np.testing.assert_array_equal(d.q, q)


def test_mimic(gripper):
    d = gripper.data()
    q, v = [0.4], [1.5]
    ddq = d.aba(q, v, [0.2])
    close(d.rnea(q, v, ddq), [0.2], atol=1e-12)
    assert d.crba(q).shape == d.M.shape == (1, 1) and d.joint_jacobians(q).shape == d.J.shape == (6, 1)
    d.forward_kinematics(q, v)
    assert d.frame_jacobian("thumb").shape == (6, 1)
    close(d.frame_jacobian("thumb") @ v, d.frame_velocity("thumb"), atol=1e-14)
>>>>>>> main
