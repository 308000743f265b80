"""Vector environments of Stable-Baselines3."""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3", reason="package stable-baselines3 is not installed")

from libdyn.gym import TaskVectorEnv  # noqa: E402
from libdyn.sb3 import Vector  # noqa: E402


def test_ends_are_reset_by_the_same_step():
    mine, theirs = Vector("cart_pole", 3, threads=1, seed=4), TaskVectorEnv("cart_pole", 3, threads=1)
    assert np.array_equal(mine.reset(), theirs.reset(seed=4)[0].astype(np.float32))
    push = np.array([[1.0], [0.0], [0.0]])
    for k in range(1, 200):
        observation, reward, ended, infos = mine.step(push)
        found, _, over, _, _ = theirs.step(push)
        if over[0]:
            break
        assert np.array_equal(observation, found.astype(np.float32)) and not ended.any()
    assert ended.tolist() == [True, False, False] and infos[0]["ended"] == "pole" and infos[1] == {}
    assert np.array_equal(infos[0]["terminal_observation"], found[0].astype(np.float32))
    assert infos[0]["episode"] == {"r": k, "l": k} and infos[0]["TimeLimit.truncated"] is False
    assert np.abs(observation[0]).max() <= 0.05, "a new episode"


def test_it_learns():
    from stable_baselines3 import PPO

    vector = Vector("cart_pole", 16, threads=1, seed=1)
    model = PPO("MlpPolicy", vector, n_steps=64, batch_size=256, learning_rate=1e-3, seed=1, device="cpu")
    returns = []
    for _ in range(2):
        model.learn(12_000)
        returns.append(np.mean([x["r"] for x in model.ep_info_buffer]))
    assert returns[1] > 1.5 * returns[0] > 30
