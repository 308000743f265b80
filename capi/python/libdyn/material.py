"""Materials of contacts."""

from __future__ import annotations

from typing import Any, NamedTuple, Tuple

from . import abi


class Material(NamedTuple):
    """Material of a collision shape. Two that touch have the larger friction, torsion, rolling, restitution and damping; their
    springs are in series."""

    friction: float = 1.0
    """Coulomb's coefficient."""
    torsion: float = 0.0
    """m: moment about the normal, by the normal force."""
    rolling: float = 0.0
    """m: moment across it."""
    restitution: float = 0.0
    """0 to 1."""
    stiffness: float = 0.0
    """N/m; 0: rigid."""
    damping: float = 0.0
    """N s/m of a contact with stiffness."""
    surface_velocity: Tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m/s, in the shape's frame: a conveyor belt."""

    def structure(self) -> abi.Material:
        """As the library takes it."""
        return abi.Material(*self[:6], tuple(self.surface_velocity))

    @classmethod
    def of(cls, x: Any) -> Material:
        """From the library's structure."""
        return cls(x.friction, x.torsion, x.rolling, x.restitution, x.stiffness, x.damping, tuple(x.surface_velocity))
