"""Environments of libdyn.gym for Stable-Baselines3 (package stable-baselines3), which has vector environments of its own kind.

    from stable_baselines3 import PPO
    from libdyn.sb3 import Vector
    PPO("MlpPolicy", Vector("go2", 64), n_steps=64, batch_size=2048).learn(1_000_000)
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from stable_baselines3.common.vec_env import VecEnv  # type: ignore[import-not-found, unused-ignore]

from .errors import ArgumentError
from .gym import TaskVectorEnv

if TYPE_CHECKING:
    from .arrays import Numbers


class Vector(VecEnv):  # type: ignore[misc, unused-ignore]
    """Environments of a task, stepped by one call: see libdyn.gym.TaskVectorEnv, whose arguments these are.

    As Stable-Baselines3 has it, an environment that ended is reset by the same step. Its info has "terminal_observation",
    "TimeLimit.truncated", and "episode" with the return "r" and the length "l".
    """

    def __init__(self, task: str, num_envs: int = 1, threads: int | None = None, seed: int | None = None, **options: Any):
        self.envs: TaskVectorEnv = TaskVectorEnv(task, num_envs, threads, **options)
        self.render_mode: str | None = self.envs.render_mode
        super().__init__(num_envs, self.envs.single_observation_space, self.envs.single_action_space)
        self._seed, self._actions = seed, np.zeros(self.envs.action_space.shape)
        self._return, self._length = np.zeros(num_envs), np.zeros(num_envs, int)

    def reset(self) -> Numbers:
        observation, _ = self.envs.reset(seed=self._seed)
        self._seed = None
        self._return[:], self._length[:] = 0, 0
        return observation.astype(np.float32)

    def step_async(self, actions: Numbers) -> None:
        self._actions = actions

    def step_wait(self) -> tuple[Numbers, Numbers, Numbers, list[dict[str, Any]]]:
        observation, reward, over, late, info = self.envs.step(self._actions)
        self._return += reward
        self._length += 1
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        ended = over | late
        if ended.any():
            final, reasons = observation.astype(np.float32), info.get("ended")
            observation, _ = self.envs.reset(options={"reset_mask": ended})
            for k in np.flatnonzero(ended):
                infos[k] = {"terminal_observation": final[k], "TimeLimit.truncated": bool(late[k]),
                            "episode": {"r": float(self._return[k]), "l": int(self._length[k])}}
                if reasons is not None and reasons[k] is not None:
                    infos[k]["ended"] = reasons[k]
            self._return[ended], self._length[ended] = 0, 0
        return observation.astype(np.float32), reward.astype(np.float32), ended, infos

    def close(self) -> None:
        self.envs.close()

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        self._seed = seed
        return [None if seed is None else seed + k for k in range(self.num_envs)]

    def get_images(self) -> Sequence[Any]:
        return self.envs.render() or ()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [getattr(self.envs, attr_name)] * len(self._chosen(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        setattr(self.envs, attr_name, value)

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        raise ArgumentError(f"environments of a batch have no method {method_name!r} of their own: see Vector.envs.")

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        return [False] * len(self._chosen(indices))

    def _chosen(self, indices: Any) -> Sequence[int]:
        if indices is None:
            return range(self.num_envs)
        return list(indices) if isinstance(indices, Iterable) else [indices]
