"""Models that differ in their numbers: other masses, frictions, gains."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from ctypes import byref
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import abi
from .builder import Builder
from .enums import Effect, ModelArray
from .errors import ArgumentError
from .inertia import is_physically_consistent
from .library import lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .builder import Parameter
    from .model import Model

Spread = Union[float, tuple[float, float]]
"""s: a factor from 1 - s to 1 + s; (low, high): a factor from low to high."""


def _coefficients() -> Iterator[str]:
    """Those that effects have for each degree of freedom of a joint."""
    info = abi.EffectTypeInfo()
    for effect in Effect:
        if lib.dyn_effect_type_info(effect, byref(info)) == 0 and info.array >= 0:
            yield ModelArray(info.array).name.lower()


# name: objects, and quantities that share a factor. Masses scale inertias, too: each link stays one that can exist
QUANTITIES: dict[str, tuple[str, tuple[str, ...]]] = {
    "mass": ("link", ("mass", "inertia")),
    "contact_friction": ("shape", ("friction",)),
    "restitution": ("shape", ("restitution",)),
    **{name: ("joint", (name,)) for name in _coefficients()},
    "armature": ("joint", ("armature", "rotor_inertia")),
    "gains": ("actuator", ("kp", "ki", "kd", "kv", "gain", "bias")),
    "gravity": ("model", ("gravity",)),
}


def _range(name: str, spread: Any) -> tuple[float, float]:
    low, high = (1 - spread, 1 + spread) if np.ndim(spread) == 0 else spread
    if not 0 <= low <= high < np.inf:
        raise ArgumentError(f"{name} is {spread!r}, but must be a number from 0 to 1, or two factors (low, high), 0 <= low <= "
                            "high.")
    return float(low), float(high)


def vary(model: Model, random: np.random.Generator | int | None = None, *, com: float = 0.0, **spreads: Spread) -> Model:
    """A model whose numbers are drawn about those of another one, everything else being as there.

    >>> import libdyn as dyn
    >>> m = dyn.load("models/robots/go2.urdf", base="floating")
    >>> other = dyn.vary(m, 1, mass=0.2, contact_friction=(0.5, 1.2), com=0.01)
    >>> other.nq == m.nq and other.total_mass != m.total_mass
    True

    random   a generator of numpy, or a seed
    com      m: largest shift of each coordinate of a link's centre of mass
    spreads  s: each object's factor is from 1 - s to 1 + s; (low, high): from low to high. Of mass (and inertia with it),
             contact_friction and restitution (of shapes), damping, friction, armature, stiffness and coefficients of other
             effects (of joints), gains (of actuators), gravity

    Factors are drawn in the order of Builder.parameters, one an object, uniformly. It takes about 5 ms for a quadruped.
    """
    generator = random if isinstance(random, np.random.Generator) else np.random.default_rng(random)
    for name in spreads:
        if name not in QUANTITIES:
            raise ArgumentError(f"there is no quantity {name!r} to vary: there are com, {', '.join(QUANTITIES)}.")
    ranges = {name: _range(name, spread) for name, spread in spreads.items()}
    if not 0 <= com < np.inf:
        raise ArgumentError(f"com is {com!r}, but must be a distance, 0 or more.")
    rules = {(kind, quantity): name for name in ranges for kind, quantities in [QUANTITIES[name]] for quantity in quantities}
    factors: dict[tuple[str, str], float] = {}
    builder = Builder.from_model(model)
    massive = {p.name for p in builder.parameters() if p.quantity == "mass" and p.values[0] > 0}
    for p in builder.parameters():
        rule = rules.get((p.object, p.quantity))
        if rule is not None:
            key = rule, p.name
            if key not in factors:
                factors[key] = generator.uniform(*ranges[rule])
            if p.values.any():
                builder.set_parameter(p, p.values * factors[key])
        elif com and p.object == "link" and p.quantity == "com" and p.name in massive:
            builder.set_parameter(p, p.values + generator.uniform(-com, com, 3))
    return builder.finish()


def with_inertial_parameters(model: Model, pi: ArrayLike) -> Model:
    """The model with other bodies: pi as Model.inertial_parameters() returns it. Of a joint whose ten numbers change, the first
    link takes all, and its other links have no mass."""
    bodies, size = np.asarray(pi, float), 10 * (model.njoints - 1)
    if bodies.size != size:
        raise ArgumentError(f"pi has {bodies.size} numbers, but model {model.name!r} has {size}: ten a joint.")
    bodies = bodies.reshape(-1, 10)
    builder = Builder.from_model(model)
    found: dict[str, dict[str, Parameter]] = {}
    for p in builder.parameters():
        if p.object == "link":
            found.setdefault(p.name, {})[p.quantity] = p
    known = model.inertial_parameters().reshape(-1, 10)
    for joint, (body, before) in enumerate(zip(bodies, known), 1):
        if np.array_equal(body, before):
            continue
        if body.any() and not is_physically_consistent(body):
            raise ArgumentError(f"pi of joint {model.joint_name(joint)!r} is {body.tolist()}, which no body has: see "
                                "dyn.is_physically_consistent.")
        links = [f for f in model.frames if f.joint == joint and f.name in found]
        if not links:
            raise ArgumentError(f"joint {model.joint_name(joint)!r} carries no link that could take its parameters.")
        for link in links:  # the first takes all of them
            first = link is links[0]
            for quantity, value in _of_link(body if first else np.zeros(10), link.placement).items():
                builder.set_parameter(found[link.name][quantity], value)
    return builder.finish()


def _of_link(body: Any, placement: Any) -> Mapping[str, Any]:
    """Mass, centre of mass and inertia (xx, yy, zz, xy, xz, yz) in the axes of a link that lies at a placement in its joint's."""
    m, moment = body[0], body[1:4]
    if m == 0:
        return {"mass": 0.0, "com": np.zeros(3), "inertia": np.zeros(6)}
    c = moment / m
    xx, xy, yy, xz, yz, zz = body[4:]
    about_origin = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    about_com = about_origin - m * (c @ c * np.eye(3) - np.outer(c, c))
    R = placement.rotation
    i = R.T @ about_com @ R
    return {"mass": m, "com": R.T @ (c - placement.translation),
            "inertia": np.array([i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]])}
