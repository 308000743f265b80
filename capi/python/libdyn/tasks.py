"""What the environments of libdyn.gym are about: models, and rules for N robots at once, a row each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .builder import Builder
from .files import models
from .loading import load
from .material import Material
from .mesh import Mesh
from .picture import Camera
from .variation import vary

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .arrays import Numbers
    from .model import Model

    Booleans = NDArray[np.bool_]

FARTHEST = 100.0
"""Observations are clipped to this size: spaces are finite."""


class Task:
    """A model that is driven, and what is asked of it.

    vary       {quantity: spread}: each episode has one of `variants` models that differ by libdyn.vary
    """

    dt: float = 2e-3
    """s, of a step."""
    every: int = 10
    """Steps of an action."""
    max_episode_steps: int = 1000
    camera: Camera = Camera()
    """Of pictures."""

    model: Model
    actions: int
    q: Numbers

    def __init__(self, model: Model, actions: int, vary: Mapping[str, Any] | None, variants: int):
        self.model, self.actions = model, actions
        self.models: list[Model] = [model] if not vary else [_varied(model, k, vary) for k in range(variants)]
        if not self.models:
            raise ValueError(f"variants is {variants}, but must be at least 1.")
        self.q = model.configuration(model.initial_configuration)
        q, v, goal = self.q[None], np.zeros((1, model.nv)), self.begin(np.random.default_rng(0))[2][None]
        self.observations: int = self.observe(q, v, np.zeros((1, actions)), goal).shape[1]

    def begin(self, random: np.random.Generator) -> tuple[Numbers, Numbers, Numbers]:
        """q and v where an episode of one robot begins, and its goal: numbers that stay."""
        raise NotImplementedError

    def control(self, action: Numbers) -> Numbers:
        """(N, nu) of actions in -1 to 1."""
        raise NotImplementedError

    def look(self, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> list[Numbers]:
        """What a robot sees, in columns."""
        raise NotImplementedError

    def observe(self, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> Numbers:
        return np.clip(np.concatenate(self.look(q, v, action, goal), axis=1), -FARTHEST, FARTHEST)

    def rewards(self, before: Numbers, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> dict[str, Numbers]:
        """Terms (N,) that add up to the reward; before: q where the action began."""
        raise NotImplementedError

    def ends(self, q: Numbers, v: Numbers, goal: Numbers) -> dict[str, Booleans]:
        """Reasons for an end (N,)."""
        return {}

    def info(self, before: Numbers, q: Numbers, v: Numbers, goal: Numbers) -> dict[str, Numbers]:
        """What is worth a curve (N,)."""
        return {}


def _varied(model: Model, k: int, spreads: Mapping[str, Any]) -> Model:
    return vary(model, k, **spreads)


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


_LEGS = ("FL", "FR", "RL", "RR")
ROBOTS = {
    "go2": Robot(0.27, 0.15, {f"{leg}_{name}_joint": x for leg in _LEGS for name, x in (("thigh", 0.9), ("calf", -1.8))}, 0.4,
                 (60, 3)),
    "humanoid": Robot(0.92, 0.6, {}, 0.4, (500, 25)),
}
GROUNDS = ("flat", "rough", "obstacles")
_TILTED = -0.5  # z of gravity's direction in the base's axes: 60 degrees
_CELLS, _CELL = 128, 0.1  # of rough ground: a field of 12.8 m
_BUMP = 0.03  # m


class Walk(Task):
    """A robot that is to walk along x: on a floor, on rough ground (bumps of 3 cm), or over obstacles (boards of 1 to 4 cm)."""

    def __init__(self, robot: str, ground: str = "flat", vary: Mapping[str, Any] | None = None, variants: int = 16):
        if robot not in ROBOTS:
            raise ValueError(f"robot is {robot!r}, but must be one of {', '.join(ROBOTS)}.")
        if ground not in GROUNDS:
            raise ValueError(f"ground is {ground!r}, but must be one of {', '.join(GROUNDS)}.")
        self.robot: Robot = ROBOTS[robot]
        bare = load(models / "robots" / f"{robot}.urdf", base="floating")
        builder = Builder.from_model(bare)
        self._heights: Numbers | None = None
        if ground == "rough":
            self._heights = _bumps()
            builder.add_shape("universe", "height_field", surface=Mesh.height_field(self._heights, _CELL, -1.0), name="floor")
        else:
            builder.add_shape("universe", "half_space", name="floor")
        if ground == "obstacles":
            _boards(builder)
        driven = [j for j in bare.joints[2:] if j.nv == 1 and j.mimic_leader < 0]
        for j in driven:
            builder.add_actuator(j.name, j.name, type="position", kp=self.robot.gains[0], kv=self.robot.gains[1])
        self.joints: NDArray[np.int64] = np.array([j.idx_q for j in driven])
        self._start = bare.normalize(self.robot.stance)
        self._start[2] = self.robot.height
        self.stance: Numbers = self._start[self.joints]
        super().__init__(builder.finish(), len(driven), vary, variants)
        self.q: Numbers = self._start

    def begin(self, random: np.random.Generator) -> tuple[Numbers, Numbers, Numbers]:
        q = self._start.copy()
        q[self.joints] += random.uniform(-0.05, 0.05, len(self.joints))
        return q, np.zeros(len(q) - 1), np.empty(0)

    def control(self, action: Numbers) -> Numbers:
        found: Numbers = self.stance + self.robot.reach * np.clip(action, -1, 1)
        return found

    def _height(self, q: Numbers) -> Numbers:
        """(N, 1), m: of the base above the ground."""
        if self._heights is None:
            return q[:, 2:3]
        cell = np.clip(np.rint(np.nan_to_num(q[:, :2]) / _CELL + (_CELLS - 1) / 2).astype(int), 0, _CELLS - 1)
        above: Numbers = q[:, 2:3] - self._heights[cell[:, 1], cell[:, 0]][:, None]
        return above

    @staticmethod
    def _down(q: Numbers) -> Numbers:
        """(N, 3): gravity's direction in the base's axes."""
        x, y, z, w = q[:, 3:7].T
        return np.stack([2 * (y * w - x * z), -2 * (y * z + x * w), 2 * (x * x + y * y) - 1], axis=1)

    def look(self, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> list[Numbers]:
        return [self._height(q), self._down(q), q[:, self.joints] - self.stance, v, action]

    def rewards(self, before: Numbers, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> dict[str, Numbers]:
        """Speed along x, m/s, and 1 for being there, less what actions cost."""
        return {"speed": self._speed(before, q), "alive": np.ones(len(q)), "action": -0.05 * np.square(action).mean(axis=1)}

    def _speed(self, before: Numbers, q: Numbers) -> Numbers:
        speed: Numbers = (q[:, 0] - before[:, 0]) / (self.dt * self.every)
        return speed

    def ends(self, q: Numbers, v: Numbers, goal: Numbers) -> dict[str, Booleans]:
        return {"height": self._height(q)[:, 0] < self.robot.fallen, "tilt": self._down(q)[:, 2] > _TILTED}

    def info(self, before: Numbers, q: Numbers, v: Numbers, goal: Numbers) -> dict[str, Numbers]:
        return {"x": q[:, 0], "y": q[:, 1], "speed": self._speed(before, q),
                "tilt": np.arccos(np.clip(-self._down(q)[:, 2], -1, 1))}


def _bumps() -> Numbers:
    """Heights between 0 and a bump's, none where the robot begins: the same in every program."""
    heights = np.random.default_rng(1).uniform(0, _BUMP, (_CELLS, _CELLS))
    along = (np.arange(_CELLS) - (_CELLS - 1) / 2) * _CELL
    away = np.hypot(along[:, None], along[None, :])
    found: Numbers = heights * np.clip(away - 0.5, 0, 1)
    return found


def _boards(builder: Builder) -> None:
    random = np.random.default_rng(1)
    for k in range(30):
        height = random.uniform(0.01, 0.04)
        place = [0.8 + 0.4 * k, random.uniform(-0.3, 0.3), height / 2]
        builder.add_shape("universe", "box", [random.uniform(0.05, 0.2), 1.5, height], (np.eye(3), place), name=f"board_{k}")


class CartPole(Task):
    """A pole of 1 m on a cart that is pushed by up to 10 N: it is to stay upright, within 2.4 m. 1 for each action of 0.02 s; it
    ends with the pole 12 degrees or the cart 2.4 m away."""

    max_episode_steps: int = 500
    camera: Camera = Camera((0, 0, 0.4), 4.5, -90, 8)

    def __init__(self, vary: Mapping[str, Any] | None = None, variants: int = 16):
        b = Builder("cart_pole").add_joint("slide", "prismatic", axis=(1, 0, 0)).add_body("cart", "slide", 1.0)
        b.add_joint("hinge", "revolute", "slide", axis=(0, 1, 0))
        b.add_body("pole", "hinge", 0.1, (0, 0, 0.5), np.diag([0.1 / 12, 0.1 / 12, 1e-5]))
        b.add_shape("cart", "box", (0.3, 0.2, 0.15), role="visual", rgba=(0.3, 0.45, 0.65, 1))
        b.add_shape("pole", "capsule", (0.025, 1.0), (np.eye(3), [0, 0, 0.5]), role="visual", rgba=(0.85, 0.5, 0.2, 1))
        b.add_actuator("push", "slide")
        super().__init__(b.finish(), 1, vary, variants)

    def begin(self, random: np.random.Generator) -> tuple[Numbers, Numbers, Numbers]:
        x = random.uniform(-0.05, 0.05, 4)
        return x[:2], x[2:], np.empty(0)

    def control(self, action: Numbers) -> Numbers:
        return 10.0 * np.clip(action, -1, 1)

    def look(self, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> list[Numbers]:
        return [q, v]

    def rewards(self, before: Numbers, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> dict[str, Numbers]:
        return {"upright": np.ones(len(q))}

    def ends(self, q: Numbers, v: Numbers, goal: Numbers) -> dict[str, Booleans]:
        return {"cart": np.abs(q[:, 0]) > 2.4, "pole": np.abs(q[:, 1]) > np.deg2rad(12)}

    def info(self, before: Numbers, q: Numbers, v: Numbers, goal: Numbers) -> dict[str, Numbers]:
        return {"x": q[:, 0], "angle": q[:, 1]}


class Reach(Task):
    """A Panda arm whose hand is to come to a point that each episode draws: less the distance, and 1 within 5 cm."""

    max_episode_steps = 150
    _HOME = np.array([0, -0.4, 0, -2.2, 0, 1.9, 0.8])

    def __init__(self, vary: Mapping[str, Any] | None = None, variants: int = 16):
        bare = load(models / "robots" / "panda.urdf", base="fixed")
        builder = Builder.from_model(bare)
        driven = [j for j in bare.joints if j.name.startswith("panda_joint") and j.nv == 1]
        for f in bare.frames:
            if f.mass > 0 and f.joint > 0:
                builder.set_gravity_compensation(f.name)
        for j in driven:
            builder.add_actuator(j.name, j.name, type="position", kp=300, kv=40)
        self.joints: NDArray[np.int64] = np.array([j.idx_q for j in driven])
        self._batch = bare.batch(1)
        super().__init__(builder.finish(), len(driven), vary, variants)
        self.q: Numbers = bare.neutral()
        self.q[self.joints] = self._HOME

    def _hand(self, q: Numbers) -> Numbers:
        found: Numbers = self._batch.frame_placement("panda_hand", q).translation
        return found

    def begin(self, random: np.random.Generator) -> tuple[Numbers, Numbers, Numbers]:
        q = self._batch.model.neutral()
        q[self.joints] = self._HOME + random.uniform(-0.05, 0.05, len(self.joints))
        radius, angle, height = random.uniform([0.35, -1.0, 0.15], [0.6, 1.0, 0.6])
        return q, np.zeros(len(q)), np.array([radius * np.cos(angle), radius * np.sin(angle), height])

    def control(self, action: Numbers) -> Numbers:
        return self._HOME + 1.2 * np.clip(action, -1, 1)

    def look(self, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> list[Numbers]:
        return [q[:, self.joints] - self._HOME, v, goal, goal - self._hand(q), action]

    def _distance(self, q: Numbers, goal: Numbers) -> Numbers:
        found: Numbers = np.linalg.norm(self._hand(q) - goal, axis=1)
        return found

    def rewards(self, before: Numbers, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> dict[str, Numbers]:
        distance = self._distance(q, goal)
        return {"distance": -distance, "there": (distance < 0.05) * 1.0, "action": -0.01 * np.square(action).mean(axis=1)}

    def info(self, before: Numbers, q: Numbers, v: Numbers, goal: Numbers) -> dict[str, Numbers]:
        return {"distance": self._distance(q, goal)}


class Lift(Task):
    """A gripper that hangs from a slide, and a cube of 4 cm and 100 g below it: the cube is to be lifted. Less the distance from
    the fingers to the cube, and 10 for each metre that it is up, of at most 0.2 m. Actions: height, opening."""

    max_episode_steps = 150
    camera: Camera = Camera((0, 0, 0.15), 0.75)
    _SIDE = 0.04

    def __init__(self, vary: Mapping[str, Any] | None = None, variants: int = 16):
        rubber, finger = Material(friction=1.0), (0.02, 0.008, 0.06)
        b = Builder("lift").add_shape("universe", "half_space", name="floor", material=rubber)
        b.add_joint("slide", "prismatic", placement=(np.eye(3), [0, 0, 0.1]), damping=2.0)
        b.add_body("palm", "slide", 0.5, (0, 0, 0.05), np.diag([1e-3, 1e-3, 1e-3]))
        b.add_shape("palm", "box", (0.04, 0.14, 0.03), (np.eye(3), [0, 0, 0.05]), rgba=(0.4, 0.4, 0.45, 1))
        for name, side in (("left", 1.0), ("right", -1.0)):
            b.add_joint(name, "prismatic", "slide", axis=(0, side, 0), damping=1.0, lower=[0.0], upper=[0.05])
            b.add_body(f"{name}_finger", name, 0.05, inertia=np.diag([2e-5, 2e-5, 5e-6]))
            b.add_shape(f"{name}_finger", "box", finger, (np.eye(3), [0, side * finger[1] / 2, 0]), name=name, material=rubber,
                        rgba=(0.3, 0.45, 0.65, 1))
        b.add_joint("cube", "free_flyer").add_body("cube", "cube", 0.1, inertia=np.eye(3) * 0.1 * self._SIDE**2 / 6)
        b.add_shape("cube", "box", [self._SIDE] * 3, name="cube", material=rubber, rgba=(0.85, 0.5, 0.2, 1))
        b.set_gravity_compensation("palm").set_gravity_compensation("left_finger").set_gravity_compensation("right_finger")
        b.add_actuator("height", "slide", type="position", kp=300, kv=30)
        for name in ("left", "right"):
            b.add_actuator(name, name, type="position", kp=200, kv=4)
        model = b.finish()
        self._slide, self._cube = model.joint("slide").idx_q, model.joint("cube").idx_q
        self._fingers = np.array([model.joint(name).idx_q for name in ("left", "right")])
        self._neutral = model.neutral()
        super().__init__(model, 2, vary, variants)
        self.q: Numbers = self.begin(np.random.default_rng(0))[0]

    def begin(self, random: np.random.Generator) -> tuple[Numbers, Numbers, Numbers]:
        q = self._neutral.copy()
        q[self._slide], q[self._fingers] = random.uniform(0.0, 0.1), 0.04
        q[self._cube : self._cube + 3] = *random.uniform(-0.008, 0.008, 2), self._SIDE / 2
        return q, np.zeros(len(q) - 1), np.empty(0)

    def control(self, action: Numbers) -> Numbers:
        a = np.clip(action, -1, 1)
        width = 0.025 + 0.025 * a[:, 1]
        return np.stack([0.06 + 0.14 * a[:, 0], width, width], axis=1)

    def _up(self, q: Numbers) -> Numbers:
        """m: of the cube's middle above where it lies."""
        return q[:, self._cube + 2] - self._SIDE / 2

    def _away(self, q: Numbers) -> Numbers:
        """m: of the cube's middle below the fingers'."""
        return 0.1 + q[:, self._slide] - q[:, self._cube + 2]

    def look(self, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> list[Numbers]:
        return [q, v, self._away(q)[:, None], action]

    def rewards(self, before: Numbers, q: Numbers, v: Numbers, action: Numbers, goal: Numbers) -> dict[str, Numbers]:
        return {"distance": -np.abs(self._away(q)), "height": 10 * np.clip(self._up(q), 0, 0.2)}

    def ends(self, q: Numbers, v: Numbers, goal: Numbers) -> dict[str, Booleans]:
        return {"away": np.abs(q[:, self._cube : self._cube + 2]).max(axis=1) > 0.3}

    def info(self, before: Numbers, q: Numbers, v: Numbers, goal: Numbers) -> dict[str, Numbers]:
        return {"height": self._up(q)}


def task_of(name: str, **options: Any) -> Task:
    """A task by its name: "go2", "humanoid", "cart_pole", "reach", "lift"."""
    others = {"cart_pole": CartPole, "reach": Reach, "lift": Lift}
    if name in ROBOTS:
        return Walk(name, **options)
    if name not in others:
        raise ValueError(f"there is no task {name!r}: there are {', '.join([*ROBOTS, *others])}.")
    made: Task = others[name](**options)
    return made
