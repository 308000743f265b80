"""Gymnasium environments: the package's checker, vector environments that are the single ones bit for bit, falls and ends."""

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="package gymnasium is not installed")

import libdyn as dyn  # noqa: E402
import libdyn.gym  # noqa: E402

IDS = ("dyn/Go2-v0", "dyn/Humanoid-v0")


@pytest.mark.parametrize("id", IDS)
@pytest.mark.filterwarnings("error", "ignore:.*infinity")
def test_checker(id):
    from gymnasium.utils.env_checker import check_env

    check_env(gymnasium.make(id).unwrapped, skip_render_check=True)


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
    assert isinstance(envs.unwrapped, dyn.gym.WalkVectorEnv)
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
    assert fallen[0] and observation[0, 0] < dyn.gym.ROBOTS["humanoid"].fallen
    observation, reward, fallen, _, _ = envs.step(actions)
    assert observation[0, 0] == dyn.gym.ROBOTS["humanoid"].height and reward[0] == 0 and not fallen.any()


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
    with pytest.raises(ValueError, match="draw nothing"):
        dyn.gym.WalkEnv("go2", render_mode="human")
