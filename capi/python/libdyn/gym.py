"""Gymnasium environments (package gymnasium): a quadruped and a humanoid that are to walk along x on a floor, and files.

    import gymnasium                                       # after `import libdyn.gym` "dyn/Go2-v0" alone is an id
    env = gymnasium.make("libdyn.gym:dyn/Go2-v0")          # or dyn/Humanoid-v0, dyn/Model-v0
    env = gymnasium.make("libdyn.gym:dyn/Model-v0", model="scene.xml", key="home", frame_skip=5)
    envs = libdyn.gym.WalkVectorEnv("go2", 1024, threads=8)   # or gymnasium.make_vec("libdyn.gym:dyn/Go2-v0", 1024,
    vectorization_mode="vector_entry_point")

    recording = env.unwrapped.simulation.record()          # until the next reset; then recording.to_html("go2.html")

An action is what each servo's target is away from the stance, -1 to 1; an observation is the base's height, gravity's direction
in its axes, the joints' positions less the stance, v, and the last action. Environment k of a vector environment with seed s is
bit for bit the single one with seed s + k.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, NamedTuple

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from .builder import Builder
from .files import models
from .loading import load
from .model import Model
from .simulate import Simulation

if TYPE_CHECKING:
    from .arrays import Numbers

DT, EVERY = 2e-3, 10  # s; steps of an action
_LEGS = ("FL", "FR", "RL", "RR")


class Robot(NamedTuple):
    """A robot that walks."""

    height: float
    """m, of the base where it begins."""
    fallen: float
    """m: it has fallen where the base is lower."""
    stance: dict[str, float]
    """Joints that are not at zero, rad."""
    reach: float
    """rad, of an action of 1."""
    gains: tuple[float, float]
    """kp, kv of the servos, N m/rad, N m s/rad."""


ROBOTS = {
    "go2": Robot(0.27, 0.15, {f"{leg}_{name}_joint": x for leg in _LEGS for name, x in (("thigh", 0.9), ("calf", -1.8))}, 0.4,
                 (60, 3)),
    "humanoid": Robot(0.92, 0.6, {}, 0.4, (500, 25)),
}


class Task:
    """The rules, for N robots at once: a row each."""

    def __init__(self, name: str):
        if name not in ROBOTS:
            raise ValueError(f"robot is {name!r}, but must be one of {', '.join(ROBOTS)}.")
        self.robot = ROBOTS[name]
        bare = load(models / "robots" / f"{name}.urdf", base="floating")
        builder = Builder.from_model(bare).add_shape("universe", "half_space", name="floor")
        driven = [j for j in bare.joints[2:] if j.nv == 1 and j.mimic_leader < 0]
        for j in driven:
            builder.add_actuator(j.name, j.name, type="position", kp=self.robot.gains[0], kv=self.robot.gains[1])
        self.model: Model = builder.finish()
        self.q = self.model.normalize(self.robot.stance)
        self.q[2] = self.robot.height
        self.joints = np.array([j.idx_q for j in driven])
        self.stance = self.q[self.joints]
        n = 4 + 2 * len(self.joints) + self.model.nv
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(self.joints),), np.float64)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (n,), np.float64)

    def begin(self, random: np.random.Generator) -> Numbers:
        """q of one robot, near the stance."""
        q = self.q.copy()
        q[self.joints] += random.uniform(-0.05, 0.05, len(self.joints))
        return q

    def control(self, action: Numbers) -> Numbers:
        return self.stance + self.robot.reach * np.clip(action, -1, 1)

    def observe(self, q: Numbers, v: Numbers, action: Numbers) -> Numbers:
        x, y, z, w = q[:, 3:7].T
        down = np.stack([2 * (y * w - x * z), -2 * (y * z + x * w), 2 * (x * x + y * y) - 1], axis=1)
        return np.concatenate([q[:, 2:3], down, q[:, self.joints] - self.stance, v, action], axis=1)

    def reward(self, before: Numbers, q: Numbers, action: Numbers) -> Numbers:
        """Speed along x, m/s, and 1 for being there, less what actions cost."""
        return (q[:, 0] - before[:, 0]) / (DT * EVERY) + 1.0 - 0.05 * np.square(action).mean(axis=1)

    def fallen(self, q: Numbers) -> Numbers:
        return q[:, 2] < self.robot.fallen


class WalkEnv(gymnasium.Env):
    """One robot."""

    metadata = {"render_modes": []}

    def __init__(self, robot: str = "go2", render_mode: None = None):
        if render_mode is not None:
            raise ValueError(f"render_mode is {render_mode!r}, but these environments draw nothing: see dyn.meshcat.")
        self.render_mode = None
        self.task = Task(robot)
        self.action_space, self.observation_space = self.task.action_space, self.task.observation_space
        self.simulation = Simulation(self.task.model, dt=DT)

    def _observe(self, action: Numbers) -> Numbers:
        return self.task.observe(self.simulation.q[None], self.simulation.v[None], action[None])[0]

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Numbers, dict]:
        super().reset(seed=seed)
        self.simulation.reset(self.task.begin(self.np_random))
        return self._observe(np.zeros(len(self.task.joints))), {}

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict]:
        sim, action = self.simulation, np.asarray(action, float)
        before = sim.q[None].copy()
        sim.step(EVERY, self.task.control(action))
        reward = self.task.reward(before, sim.q[None], action[None])[0]
        return self._observe(action), float(reward), bool(self.task.fallen(sim.q[None])[0]), False, {}


class ModelEnv(gymnasium.Env):
    """A model as its file states it: its initial state or a key's, timestep, integrator, effects, controls and their ranges.

    An action is the controls, an observation q and v. frame_skip: steps of an action. reward, ended: of the environment.
    """

    metadata = {"render_modes": []}

    def __init__(
        self,
        model: Model | str | Path,
        key: str | None = None,
        frame_skip: int = 1,
        reward: Callable[[ModelEnv], float] = lambda env: 0.0,
        ended: Callable[[ModelEnv], bool] = lambda env: False,
        render_mode: None = None,
    ):
        if frame_skip < 1:
            raise ValueError(f"frame_skip is {frame_skip}, but must be at least 1.")
        self.render_mode, self.reward, self.ended = None, reward, ended
        self.model = model if isinstance(model, Model) else load(model)
        self.simulation, self.frame_skip = Simulation(self.model, key), frame_skip
        self.dt: float = self.simulation.dt * frame_skip
        low, high = np.full((2, self.model.nu), np.inf) * [[-1], [1]]
        for a in map(self.model.actuator, range(self.model.nactuators)):
            low[a.idx_u], high[a.idx_u] = a.control_range
        self.action_space = gymnasium.spaces.Box(low, high, dtype=np.float64)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (self.model.nq + self.model.nv,), np.float64)

    def _observe(self) -> Numbers:
        return np.concatenate([self.simulation.q, self.simulation.v])

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Numbers, dict]:
        super().reset(seed=seed)
        self.simulation.reset()
        return self._observe(), {}

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict]:
        self.simulation.step(self.frame_skip, action)
        return self._observe(), float(self.reward(self)), bool(self.ended(self)), False, {}


class WalkVectorEnv(VectorEnv):
    """N robots, stepped by one call of the batch. An environment that ended is reset by the next step."""

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(self, robot: str = "go2", num_envs: int = 1, threads: int | None = None, max_episode_steps: int = 1000,
                 render_mode: None = None):
        self.render_mode = render_mode
        self.num_envs, self.task, self.max_episode_steps = num_envs, Task(robot), max_episode_steps
        task = self.task
        self.single_action_space, self.single_observation_space = task.action_space, task.observation_space
        self.action_space = batch_space(task.action_space, num_envs)
        self.observation_space = batch_space(task.observation_space, num_envs)
        self.batch = task.model.batch(threads)
        self._single = Simulation(task.model, dt=DT)
        self._random: list[np.random.Generator] = [np.random.default_rng() for _ in range(num_envs)]
        self._states = np.tile(np.frombuffer(self._single.data.save_state(), np.uint8), (num_envs, 1))
        self._q, self._v = np.tile(task.q, (num_envs, 1)), np.zeros((num_envs, task.model.nv))
        self._action = np.zeros((num_envs, len(task.joints)))
        self._age, self._ended = np.zeros(num_envs, int), np.zeros(num_envs, bool)

    def _begin(self, k: int) -> None:
        self._single.reset(self.task.begin(self._random[k]))
        self._states[k] = np.frombuffer(self._single.data.save_state(), np.uint8)
        self._q[k], self._v[k], self._action[k], self._age[k], self._ended[k] = self._single.q, 0, 0, 0, False

    def _observe(self) -> Numbers:
        return self.task.observe(self._q, self._v, self._action)

    def reset(self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None) -> tuple[Numbers, dict]:
        seeds = ([None if seed is None else seed + k for k in range(self.num_envs)] if seed is None
                 or isinstance(seed, int) else seed)
        chosen = np.ones(self.num_envs, bool) if not options or "reset_mask" not in options else options["reset_mask"]
        for k in np.flatnonzero(chosen):
            if seeds[k] is not None:
                self._random[k] = gymnasium.utils.seeding.np_random(seeds[k])[0]
            self._begin(k)
        return self._observe(), {}

    def step(self, actions: Numbers) -> tuple[Numbers, Numbers, Numbers, Numbers, dict]:
        task, reward, fallen = self.task, np.zeros(self.num_envs), np.zeros(self.num_envs, bool)
        begins, go = np.flatnonzero(self._ended), np.flatnonzero(~self._ended)
        for k in begins:
            self._begin(k)
        if len(go):
            action, before = np.asarray(actions, float)[go], self._q[go]
            r = self.batch.rollout(
                states=self._states[go], control=task.control(action)[:, None], every=EVERY, dt=DT, keep_states=True, strict=False
            )
            good = go[r.status == 0]
            done = r.status == 0
            self._q[good], self._v[good], self._states[good] = r.q[done, 0], r.v[done, 0], r.states[done]
            self._action[go] = action
            self._age[go] += 1
            reward[go] = task.reward(before, self._q[go], action)
            fallen[go] = task.fallen(self._q[go]) | ~done
        late = ~fallen & (self._age >= self.max_episode_steps)
        self._ended = fallen | late
        return self._observe(), reward, fallen, late, {}


for _name, _id in (("go2", "dyn/Go2-v0"), ("humanoid", "dyn/Humanoid-v0")):
    if _id not in gymnasium.registry:
        gymnasium.register(
            _id, "libdyn.gym:WalkEnv", vector_entry_point="libdyn.gym:WalkVectorEnv", max_episode_steps=1000,
            kwargs={"robot": _name}
        )
if "dyn/Model-v0" not in gymnasium.registry:
    gymnasium.register("dyn/Model-v0", "libdyn.gym:ModelEnv")
