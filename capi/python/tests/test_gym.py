"""Gymnasium environments: the package's checker, vector environments that are the single ones bit for bit, falls and ends."""

import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import MODELS

gymnasium = pytest.importorskip("gymnasium", reason="package gymnasium is not installed")

import libdyn as dyn  # noqa: E402
import libdyn.gym  # noqa: E402
import libdyn.tasks  # noqa: E402

IDS = ("dyn/Go2-v0", "dyn/Humanoid-v0")
OTHERS = ("dyn/CartPole-v0", "dyn/Reach-v0", "dyn/Lift-v0")


@pytest.mark.parametrize("id", [*IDS, *OTHERS])
@pytest.mark.filterwarnings("error")
def test_checker(id):
    """Of the package: spaces, seeds, and pictures."""
    from gymnasium.utils.env_checker import check_env

    check_env(gymnasium.make(id, render_mode="rgb_array", width=32, height=24).unwrapped, skip_render_check=id in IDS)


@pytest.mark.parametrize("id", [*IDS, "dyn/Model-v0"])
def test_ids_need_no_import(id):
    """As README's page writes them, in a program that imports gymnasium alone."""
    more = f", model={str(MODELS / 'scenes/go2_stands.xml')!r}" if "Model" in id else ""
    program = f"import gymnasium\nenv = gymnasium.make('libdyn.gym:{id}'{more})\nprint(env.reset(seed=1)[0].shape)"
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", program], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("("), done.stderr


def test_an_environment_is_recorded():
    env = gymnasium.make("dyn/Go2-v0").unwrapped
    env.reset(seed=1)
    recording = env.simulation.record()
    for _ in range(5):
        env.step(np.zeros(env.action_space.shape))
    assert recording.t[-1] == pytest.approx(0.1, abs=0.02) and len(recording) > 5


@pytest.mark.parametrize("id", IDS)
def test_it_stands(id):
    """With no actions a second long: what it stands on carries it."""
    env = gymnasium.make(id)
    first, _ = env.reset(seed=1)
    for _ in range(50):
        observation, reward, fallen, late, _ = env.step(np.zeros(env.action_space.shape))
        assert not fallen and not late
    assert abs(observation[0] - first[0]) < 0.05 and observation[3] < -0.99  # height; gravity points down
    assert env.observation_space.contains(observation) and 0.5 < reward < 1.5


@pytest.mark.parametrize("id", IDS)
def test_a_vector_environment_is_the_single_ones(id):
    n, steps = 3, 25
    actions = np.random.default_rng(1).uniform(-1, 1, (steps, n, *gymnasium.make(id).action_space.shape))
    envs = gymnasium.make_vec(id, n, vectorization_mode="vector_entry_point", threads=2)
    assert isinstance(envs.unwrapped, dyn.gym.TaskVectorEnv)
    found = [envs.reset(seed=5)[0]]
    rewards, ends = [], []
    for a in actions:
        observation, reward, fallen, late, _ = envs.step(a)
        found.append(observation), rewards.append(reward), ends.append(fallen)
        assert envs.observation_space.contains(observation)
    for k in range(n):
        env = gymnasium.make(id)
        assert np.array_equal(env.reset(seed=5 + k)[0], found[0][k])
        over = False
        for i in range(steps):
            if over:  # the next step resets
                assert np.array_equal(env.reset()[0], found[i + 1][k]) and rewards[i][k] == 0
                over = False
                continue
            observation, reward, over, _, _ = env.step(actions[i, k])
            assert np.array_equal(observation, found[i + 1][k]) and reward == rewards[i][k] and over == ends[i][k], (k, i)


@pytest.mark.parametrize("task, options", [
    ("cart_pole", {}), ("reach", {}), ("lift", {}), ("go2", {"ground": "rough"}), ("go2", {"ground": "obstacles"}),
    ("go2", {"vary": {"mass": 0.2, "contact_friction": (0.5, 1.2), "com": 0.02}, "variants": 3}),
])  # fmt: skip
def test_tasks(task, options):
    """Vectors are the single ones, bit for bit; observations are in their finite space; the terms of the reward add up."""
    n, steps = 3, 8
    envs = dyn.gym.TaskVectorEnv(task, n, threads=1, **options)
    random = np.random.default_rng(1)
    actions, first = random.uniform(-1, 1, (steps, n, *envs.single_action_space.shape)), envs.reset(seed=5)[0]
    found = [envs.step(a) for a in actions]
    assert np.isfinite(envs.single_observation_space.high).all()
    env = dyn.gym.TaskEnv(task, **options)
    for k in range(n):
        assert np.array_equal(env.reset(seed=5 + k)[0], first[k])
        for i in range(steps):
            observation, reward, over, _, info = env.step(actions[i, k])
            assert np.array_equal(observation, found[i][0][k]) and reward == found[i][1][k] and over == found[i][2][k]
            assert env.observation_space.contains(observation)
            assert reward == pytest.approx(sum(x for name, x in info.items() if name.startswith("reward_")), abs=1e-12)
            assert all(found[i][4][name][k] == x and found[i][4][f"_{name}"][k] for name, x in info.items())
            if over:
                break


def test_episodes_have_models_of_their_own():
    env = dyn.gym.TaskEnv("go2", vary={"mass": 0.2, "contact_friction": (0.5, 1.2)}, variants=3)
    masses = {env.reset(seed=k)[0][0] and env.simulation.model.total_mass for k in range(12)}
    assert masses == {m.total_mass for m in env.task.models} and len(masses) == 3
    nominal = env.task.model.total_mass
    assert all(0.8 * nominal < m < 1.2 * nominal for m in masses)


def test_why_an_episode_ends():
    env = dyn.gym.TaskEnv("cart_pole")
    env.reset(seed=1)
    while True:
        _, _, over, _, info = env.step([1.0])
        if over:
            break
    assert info["ended"] == "pole" and abs(info["angle"]) > np.deg2rad(12)
    env = dyn.gym.TaskEnv("go2")
    env.reset(seed=1)
    q = env.task.q.copy()
    q[2], q[3:7] = 0.6, dyn.spatial.matrix_to_quaternion(dyn.spatial.rpy_to_matrix([1.2, 0, 0]))
    env.simulation.reset(q)
    _, _, over, _, info = env.step(np.zeros(12))
    assert over and info["ended"] == "tilt" and info["tilt"] == pytest.approx(1.2, abs=0.05)
    envs = dyn.gym.TaskVectorEnv("cart_pole", 2, threads=1)
    envs.reset(seed=1)
    while not (found := envs.step(np.array([[1.0], [0.0]])))[2].any():
        pass
    assert found[4]["ended"].tolist() == ["pole", None] and found[4]["_ended"].tolist() == [True, False]


def test_an_action_that_no_step_takes_ends_the_episode_with_a_reason():
    envs = gymnasium.make_vec("libdyn.gym:dyn/CartPole-v0", num_envs=2, vectorization_mode="vector_entry_point")
    envs.reset(seed=1)
    _, _, over, _, info = envs.step(np.array([[0.0], [np.nan]]))
    assert over.tolist() == [False, True] and info["ended"].tolist() == [None, "failed"]
    with pytest.raises(ValueError, match=r"shape \(1, 1\), but must have shape \(2, 1\)"):
        envs.step(np.zeros((1, 1)))


def test_a_cube_is_lifted():
    """By three targets in a row: down, closed, up."""
    env = dyn.gym.TaskEnv("lift")
    env.reset(seed=2)
    for action, steps in (([-1, 1], 40), ([-1, -1], 20), ([1, -1], 40)):
        for _ in range(steps):
            _, reward, over, _, info = env.step(np.array(action))
            assert not over
    assert info["height"] > 0.2 and reward > 1.9


def test_pictures():
    env = dyn.gym.TaskEnv("go2", "rgb_array", width=64, height=48)
    env.reset(seed=1)
    picture = env.render()
    assert picture.shape == (48, 64, 3) and picture.dtype == np.uint8
    for _ in range(10):
        env.step(np.ones(12))
    assert not np.array_equal(env.render(), picture)
    envs = dyn.gym.TaskVectorEnv("go2", 2, threads=1, render_mode="rgb_array", width=64, height=48)
    envs.reset(seed=1)
    both = envs.render()
    assert len(both) == 2 and np.array_equal(both[0], picture)
    assert dyn.gym.TaskEnv("go2").render() is None
    model = dyn.gym.ModelEnv(dyn.load_string(SCENE), render_mode="rgb_array", width=32, height=24)
    model.reset()
    assert model.render().std() > 5


def test_a_page_shows_each_step(monkeypatch):
    """The page of a live simulation, in real time."""
    shown = []

    class Viewer:
        def __init__(self, simulation):
            self.simulation = simulation

        def sync(self):
            shown.append(self.simulation.time)

        def close(self):
            shown.append("closed")

    monkeypatch.setattr(dyn.gym, "Viewer", Viewer)
    env = dyn.gym.TaskEnv("cart_pole", "human")
    env.reset(seed=1)
    began = time.monotonic()
    for _ in range(5):
        env.step([0.0])
    assert time.monotonic() - began > 0.07 and env.render() is None  # the first step may come at once
    env.close()
    assert shown == [0, *(pytest.approx(0.02 * k) for k in range(1, 6)), "closed"]


def test_falls_ends_and_masks():
    envs = dyn.gym.WalkVectorEnv("go2", 4, threads=1, max_episode_steps=3)
    envs.reset(seed=1)
    quiet = np.zeros(envs.action_space.shape)
    assert [envs.step(quiet)[3].all() for _ in range(5)] == [False, False, True, False, False]
    begun = envs.reset(seed=1)[0]
    moved = envs.step(quiet)[0]
    again, _ = envs.reset(options={"reset_mask": np.array([True, False, False, True])})
    assert (np.array_equal(again[1:3], moved[1:3]) and not np.array_equal(again[0], moved[0])
            and not np.array_equal(again[0], begun[0]))
    envs = dyn.gym.WalkVectorEnv("humanoid", 2)
    envs.reset(seed=1)
    actions = np.zeros(envs.action_space.shape)
    names = [j.name for j in envs.task.model.joints if j.idx_q in envs.task.joints]
    actions[0, [names.index(f"{side}_{joint}") for side in ("left", "right")
                for joint in ("ankle_pitch", "hip_pitch")]] = 1  # it leans forward
    for step in range(150):
        observation, _, fallen, _, _ = envs.step(actions)
        assert not fallen[1]
        if fallen[0]:
            break
    assert fallen[0] and (observation[0, 0] < dyn.tasks.ROBOTS["humanoid"].fallen or observation[0, 3] > -0.5)
    observation, reward, fallen, _, _ = envs.step(actions)
    assert observation[0, 0] == dyn.tasks.ROBOTS["humanoid"].height and reward[0] == 0 and not fallen.any()


def test_a_state_that_fails_ends_its_environment():
    envs = dyn.gym.WalkVectorEnv("go2", 2)
    first, _ = envs.reset(seed=1)
    actions = np.zeros(envs.action_space.shape)
    actions[1, 3] = np.nan
    observation, _, fallen, _, _ = envs.step(actions)
    assert fallen.tolist() == [False, True] and np.isfinite(envs._q).all()
    assert np.isfinite(envs.step(np.zeros(envs.action_space.shape))[0]).all()


def test_refusals():
    with pytest.raises(ValueError, match="must be one of go2, humanoid"):
        dyn.gym.WalkEnv("cat")
    with pytest.raises(ValueError, match="there is no task 'cat': there are go2, humanoid, cart_pole, reach, lift"):
        dyn.gym.TaskEnv("cat")
    with pytest.raises(ValueError, match="must be one of flat, rough, obstacles"):
        dyn.gym.TaskEnv("go2", ground="sand")
    with pytest.raises(ValueError, match="must be None or one of human, rgb_array"):
        dyn.gym.TaskEnv("cart_pole", "ansi")
    with pytest.raises(ValueError, match='must be None or "rgb_array"'):
        dyn.gym.TaskVectorEnv("cart_pole", 2, render_mode="human")
    with pytest.raises(dyn.ArgumentError, match="no quantity 'weight' to vary"):
        dyn.gym.TaskEnv("cart_pole", vary={"weight": 0.1})
    with pytest.raises(ValueError, match="variants is 0"):
        dyn.gym.TaskEnv("cart_pole", vary={"mass": 0.1}, variants=0)


SCENE = """<mujoco><option timestep="0.004" integrator="implicitfast"/><worldbody>
  <body pos="0 0 1"><joint name="hinge" axis="0 1 0" ref="30" damping="0.1"/><geom size=".1" pos=".3 0 0"/></body></worldbody>
  <actuator><motor joint="hinge" ctrlrange="-2 3"/><motor joint="hinge"/></actuator>
  <keyframe><key name="up" qpos="-1.5" qvel="2"/></keyframe></mujoco>"""


@pytest.mark.filterwarnings("error", "ignore:.*infinity", "ignore:.*symmetric")
def test_a_model_of_a_file_runs_as_the_file_states(tmp_path):
    from gymnasium.utils.env_checker import check_env

    (tmp_path / "scene.xml").write_text(SCENE)
    env = gymnasium.make("dyn/Model-v0", model=tmp_path / "scene.xml", frame_skip=3, disable_env_checker=True).unwrapped
    check_env(env, skip_render_check=True)
    assert env.dt == pytest.approx(0.012, abs=1e-15) and env.simulation.dt == 0.004
    np.testing.assert_array_equal(env.action_space.low, [-2, -np.inf])
    np.testing.assert_array_equal(env.action_space.high, [3, np.inf])
    np.testing.assert_allclose(env.reset()[0], [np.pi / 6, 0], atol=1e-15)
    sim = dyn.Simulation(env.model)
    sim.step(3, [1.0, 0.5])
    observation, *_ = env.step(np.array([1.0, 0.5]))
    np.testing.assert_array_equal(observation, np.r_[sim.q, sim.v])


def test_a_model_begins_at_a_key_and_ends_by_its_rules():
    model, angle = dyn.load_string(SCENE), lambda env: env.simulation.q[0]
    env = dyn.gym.ModelEnv(model, "up", reward=angle, ended=lambda env: angle(env) > -1.4)
    assert env.reset()[0].tolist() == [-1.5, 2]
    while True:
        observation, reward, ended, _, _ = env.step(np.zeros(2))
        assert reward == observation[0] and ended == (reward > -1.4)
        if ended:
            break
    assert env.reset()[0].tolist() == [-1.5, 2]
    with pytest.raises(ValueError, match="frame_skip"):
        dyn.gym.ModelEnv(env.model, frame_skip=0)
