"""Gymnasium environments (package gymnasium): robots that are to walk, reach, lift or balance, and models of files.

    import gymnasium                                       # after `import libdyn.gym` "dyn/Go2-v0" alone is an id
    env = gymnasium.make("libdyn.gym:dyn/Go2-v0")          # or dyn/Humanoid-v0, CartPole-v0, Reach-v0, Lift-v0, Model-v0
    env = gymnasium.make("libdyn.gym:dyn/Go2-v0", render_mode="rgb_array", ground="rough", vary={"mass": 0.2})
    env = gymnasium.make("libdyn.gym:dyn/Model-v0", model="scene.xml", key="home", frame_skip=5)
    envs = libdyn.gym.TaskVectorEnv("go2", 1024, threads=8)   # or gymnasium.make_vec("libdyn.gym:dyn/Go2-v0", 1024,
    vectorization_mode="vector_entry_point")

    recording = env.unwrapped.simulation.record()          # until the next reset; then recording.to_html("go2.html")

Of a robot that walks an action is what each servo's target is away from the stance, -1 to 1; an observation is the base's height,
gravity's direction in its axes, the joints' positions less the stance, v, and the last action. libdyn.tasks has the rules of
all. Environment k of a vector environment with seed s is bit for bit the single one with seed s + k.

vary draws models: {"mass": 0.2, "contact_friction": (0.5, 1.2)} of libdyn.vary. There are `variants` of them, made once; each
episode has one. render_mode "rgb_array": render() returns a picture; "human": a page in a browser shows each step.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from .loading import load
from .live import Viewer
from .model import Model
from .picture import Camera, Renderer
from .simulate import Simulation
from .tasks import FARTHEST, Task, task_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .arrays import Integers, Numbers
    from .picture import Image

MODES = ["human", "rgb_array"]


class _Drawn(gymnasium.Env):
    """What pictures and pages of an environment need. It has `simulation`."""

    metadata: dict[str, Any] = {"render_modes": MODES, "render_fps": 50}
    simulation: Simulation
    render_mode: str | None

    def _draws(self, render_mode: str | None, width: int, height: int, camera: Camera | None, period: float) -> None:
        if render_mode is not None and render_mode not in MODES:
            raise ValueError(f"render_mode is {render_mode!r}, but must be None or one of {', '.join(MODES)}.")
        self.render_mode, self._size, self._camera, self._period = render_mode, (width, height), camera, period
        self.metadata = {**self.metadata, "render_fps": max(1, round(1 / period))}
        self._renderer: Renderer | None = None
        self._viewer: Viewer | None = None
        self._due = 0.0

    def render(self) -> Image | None:
        """A picture (height, width, 3) with render_mode "rgb_array"."""
        if self.render_mode != "rgb_array":
            return None
        if self._renderer is None:
            self._renderer = Renderer(self.simulation.model, *self._size, self._camera)
        return self._renderer.render(self.simulation.q)

    def _show(self) -> None:
        """In a browser, not faster than real time."""
        if self.render_mode != "human":
            return
        if self._viewer is None:
            self._viewer = Viewer(self.simulation)
        self._viewer.simulation = self.simulation
        self._viewer.sync()
        self._due = max(self._due + self._period, time.monotonic())
        time.sleep(max(0.0, self._due - time.monotonic()))

    def close(self) -> None:
        if self._viewer is not None:
            self._viewer.close()
            self._viewer = None


def _box(low: Any, high: Any) -> gymnasium.spaces.Box:
    return gymnasium.spaces.Box(low, high, dtype=np.float64)


def _spaces(task: Task) -> tuple[gymnasium.spaces.Box, gymnasium.spaces.Box]:
    """Of actions and observations."""
    actions, observations = np.ones(task.actions), np.full(task.observations, FARTHEST)
    return _box(-actions, actions), _box(-observations, observations)


class TaskEnv(_Drawn):
    """One robot with a task: "go2", "humanoid", "cart_pole", "reach", "lift".

    ground         of those that walk: "flat", "rough", "obstacles"
    vary, variants see libdyn.gym
    width, height, camera  of pictures: see libdyn.Renderer

    info has what the task measures (of a robot that walks x, y, speed, tilt), the terms of the reward as reward_<name>, and
    `ended` with the reason for an end.
    """

    simulation: Simulation
    action_space: gymnasium.spaces.Box
    observation_space: gymnasium.spaces.Box

    def __init__(self, task: str, render_mode: str | None = None, *, width: int = 480, height: int = 360,
                 camera: Camera | None = None, **options: Any):
        self.task: Task = task_of(task, **options)
        self.action_space, self.observation_space = _spaces(self.task)
        self._simulations = [Simulation(m, dt=self.task.dt) for m in self.task.models]
        self.simulation = self._simulations[0]
        self._goal = np.empty(0)
        self._draws(render_mode, width, height, camera or self.task.camera, self.task.dt * self.task.every)

    def _observe(self, action: Numbers) -> Numbers:
        return self.task.observe(self.simulation.q[None], self.simulation.v[None], action[None], self._goal[None])[0]

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Numbers, dict[str, Any]]:
        super().reset(seed=seed)
        self.simulation = self._simulations[_variant(self.np_random, len(self._simulations))]
        q, v, self._goal = self.task.begin(self.np_random)
        self.simulation.reset(q, v)
        self._show()
        return self._observe(np.zeros(self.task.actions)), {}

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        task, sim, action = self.task, self.simulation, np.asarray(action, float)
        before = sim.q[None].copy()
        sim.step(task.every, task.control(action[None])[0])
        q, v, a, goal = sim.q[None], sim.v[None], action[None], self._goal[None]
        terms = task.rewards(before, q, v, a, goal)
        ends = [name for name, is_so in task.ends(q, v, goal).items() if is_so[0]]
        info: dict[str, Any] = {name: float(x[0]) for name, x in task.info(before, q, v, goal).items()}
        info |= {f"reward_{name}": float(x[0]) for name, x in terms.items()}
        if ends:
            info["ended"] = ends[0]
        self._show()
        return self._observe(action), float(sum(x[0] for x in terms.values())), bool(ends), False, info


class WalkEnv(TaskEnv):
    """One robot that walks: "go2" or "humanoid"."""

    def __init__(self, robot: str = "go2", render_mode: str | None = None, **options: Any):
        super().__init__(_walks(robot), render_mode, **options)


def _walks(robot: str) -> str:
    from .tasks import ROBOTS

    if robot not in ROBOTS:
        raise ValueError(f"robot is {robot!r}, but must be one of {', '.join(ROBOTS)}.")
    return robot


def _variant(random: np.random.Generator, n: int) -> int:
    return int(random.integers(n)) if n > 1 else 0


class ModelEnv(_Drawn):
    """A model as its file states it: its initial state or a key's, timestep, integrator, effects, controls and their ranges.

    An action is the controls, an observation q and v. frame_skip: steps of an action. reward, ended: of the environment.
    """

    simulation: Simulation
    model: Model
    frame_skip: int
    reward: Callable[[ModelEnv], float]
    ended: Callable[[ModelEnv], bool]
    action_space: gymnasium.spaces.Box
    observation_space: gymnasium.spaces.Box

    def __init__(
        self,
        model: Model | str | Path,
        key: str | None = None,
        frame_skip: int = 1,
        reward: Callable[[ModelEnv], float] = lambda env: 0.0,
        ended: Callable[[ModelEnv], bool] = lambda env: False,
        render_mode: str | None = None,
        *,
        width: int = 480,
        height: int = 360,
        camera: Camera | None = None,
    ):
        if frame_skip < 1:
            raise ValueError(f"frame_skip is {frame_skip}, but must be at least 1.")
        self.reward, self.ended = reward, ended
        self.model = model if isinstance(model, Model) else load(model)
        self.simulation, self.frame_skip = Simulation(self.model, key), frame_skip
        self.dt: float = self.simulation.dt * frame_skip
        self._draws(render_mode, width, height, camera, self.dt)
        low, high = np.full((2, self.model.nu), np.inf) * [[-1], [1]]
        for a in map(self.model.actuator, range(self.model.nactuators)):
            low[a.idx_u], high[a.idx_u] = a.control_range
        self.action_space = _box(low, high)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (self.model.nq + self.model.nv,), np.float64)

    def _observe(self) -> Numbers:
        return np.concatenate([self.simulation.q, self.simulation.v])

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Numbers, dict[str, Any]]:
        super().reset(seed=seed)
        self.simulation.reset()
        self._show()
        return self._observe(), {}

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        self.simulation.step(self.frame_skip, action)
        self._show()
        return self._observe(), float(self.reward(self)), bool(self.ended(self)), False, {}


class TaskVectorEnv(VectorEnv):
    """N robots with a task, stepped by one call of the batch a variant. An environment that ended is reset by the next step.

    max_episode_steps  None: as the task says
    Others as of TaskEnv. render() returns a picture for each environment.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 50, "autoreset_mode": AutoresetMode.NEXT_STEP}
    render_mode: str | None
    num_envs: int
    task: Task
    action_space: gymnasium.Space[Any]
    observation_space: gymnasium.Space[Any]
    single_action_space: gymnasium.spaces.Box
    single_observation_space: gymnasium.spaces.Box

    def __init__(self, task: str, num_envs: int = 1, threads: int | None = None, max_episode_steps: int | None = None,
                 render_mode: str | None = None, *, width: int = 480, height: int = 360, camera: Camera | None = None,
                 **options: Any):
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f'render_mode is {render_mode!r}, but must be None or "rgb_array".')
        self.render_mode, self.num_envs, self.task = render_mode, num_envs, task_of(task, **options)
        self.max_episode_steps: int = self.task.max_episode_steps if max_episode_steps is None else max_episode_steps
        self.single_action_space, self.single_observation_space = _spaces(self.task)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        m = self.task.model
        self._batches = [model.batch(threads) for model in self.task.models]
        self._singles = [Simulation(model, dt=self.task.dt) for model in self.task.models]
        self._random: list[np.random.Generator] = [np.random.default_rng() for _ in range(num_envs)]
        self._states = np.tile(np.frombuffer(self._singles[0].data.save_state(), np.uint8), (num_envs, 1))
        self._q, self._v = np.tile(self.task.q, (num_envs, 1)), np.zeros((num_envs, m.nv))
        goal = self.task.begin(np.random.default_rng(0))[2]
        self._goal, self._variant = np.tile(goal, (num_envs, 1)), np.zeros(num_envs, int)
        self._action = np.zeros((num_envs, self.task.actions))
        self._age, self._ended = np.zeros(num_envs, int), np.zeros(num_envs, bool)
        self._picture = (width, height, camera or self.task.camera)
        self._renderer: Renderer | None = None

    def _begin(self, k: Any) -> None:
        self._variant[k] = _variant(self._random[k], len(self._singles))
        single = self._singles[self._variant[k]]
        q, v, self._goal[k] = self.task.begin(self._random[k])
        single.reset(q, v)
        self._states[k] = np.frombuffer(single.data.save_state(), np.uint8)
        self._q[k], self._v[k], self._action[k], self._age[k], self._ended[k] = single.q, single.v, 0, 0, False

    def _observe(self) -> Numbers:
        return self.task.observe(self._q, self._v, self._action, self._goal)

    def reset(self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None) -> tuple[Numbers, dict[str, Any]]:
        seeds = ([None if seed is None else seed + k for k in range(self.num_envs)] if seed is None
                 or isinstance(seed, int) else seed)
        chosen = np.ones(self.num_envs, bool) if not options or "reset_mask" not in options else options["reset_mask"]
        for k in np.flatnonzero(chosen):
            if seeds[k] is not None:
                self._random[k] = gymnasium.utils.seeding.np_random(seeds[k])[0]
            self._begin(k)
        return self._observe(), {}

    def step(self, actions: Numbers) -> tuple[Numbers, Numbers, NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        task, reward, over = self.task, np.zeros(self.num_envs), np.zeros(self.num_envs, bool)
        if np.shape(actions) != (self.num_envs, task.actions):
            raise ValueError(f"actions have shape {np.shape(actions)}, but must have shape {(self.num_envs, task.actions)}.")
        info: dict[str, Any] = {}
        begins, go = np.flatnonzero(self._ended), np.flatnonzero(~self._ended)
        for k in begins:
            self._begin(k)
        if len(go):
            action, before = np.asarray(actions, float)[go], self._q[go]
            done = self._advance(go, task.control(action))
            self._action[go] = action
            self._age[go] += 1
            q, v, goal = self._q[go], self._v[go], self._goal[go]
            terms, ends = task.rewards(before, q, v, action, goal), task.ends(q, v, goal)
            reward[go] = sum(terms.values())
            over[go] = np.logical_or.reduce([*ends.values(), ~done])
            found = {**task.info(before, q, v, goal), **{f"reward_{name}": x for name, x in terms.items()}}
            for name, x in found.items():
                info[name], info[f"_{name}"] = np.zeros(self.num_envs), np.zeros(self.num_envs, bool)
                info[name][go], info[f"_{name}"][go] = x, True
            if over.any():
                reasons = np.full(self.num_envs, None, object)
                for name, is_so in [("failed", ~done), *reversed(ends.items())]:
                    reasons[go[is_so]] = name
                info["ended"], info["_ended"] = reasons, np.array([x is not None for x in reasons])
        late = ~over & (self._age >= self.max_episode_steps)
        self._ended = over | late
        return self._observe(), reward, over, late, info

    def _advance(self, go: Integers, control: Numbers) -> NDArray[np.bool_]:
        """Steps environments, and says of which the steps could be made; the others stay."""
        done = np.zeros(len(go), bool)
        for variant, batch in enumerate(self._batches):
            mine = np.flatnonzero(self._variant[go] == variant)
            if not len(mine):
                continue
            r = batch.rollout(states=self._states[go[mine]], control=control[mine][:, None], every=self.task.every,
                              dt=self.task.dt, keep_states=True, strict=False)
            well = r.status == 0
            good = go[mine[well]]
            self._q[good], self._v[good], self._states[good] = r.q[well, 0], r.v[well, 0], r.states[well]
            done[mine] = well
        return done

    def render(self) -> tuple[Image, ...] | None:
        if self.render_mode != "rgb_array":
            return None
        if self._renderer is None:
            self._renderer = Renderer(self.task.model, *self._picture)
        return tuple(map(self._renderer.render, self._q))


class WalkVectorEnv(TaskVectorEnv):
    """N robots that walk: "go2" or "humanoid"."""

    def __init__(self, robot: str = "go2", num_envs: int = 1, threads: int | None = None, max_episode_steps: int = 1000,
                 render_mode: str | None = None, **options: Any):
        super().__init__(_walks(robot), num_envs, threads, max_episode_steps, render_mode, **options)


for _id, _name in (("dyn/Go2-v0", "go2"), ("dyn/Humanoid-v0", "humanoid"), ("dyn/CartPole-v0", "cart_pole"),
                   ("dyn/Reach-v0", "reach"), ("dyn/Lift-v0", "lift")):
    if _id not in gymnasium.registry:
        gymnasium.register(
            _id, "libdyn.gym:TaskEnv", vector_entry_point="libdyn.gym:TaskVectorEnv",
            max_episode_steps={"cart_pole": 500, "reach": 150, "lift": 150}.get(_name, 1000), kwargs={"task": _name}
        )
if "dyn/Model-v0" not in gymnasium.registry:
    gymnasium.register("dyn/Model-v0", "libdyn.gym:ModelEnv")
