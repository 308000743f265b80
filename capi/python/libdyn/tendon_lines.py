"""Tendons as they are drawn: straight pieces of their paths."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .enums import ActuatorType, Part, Transmission

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers
    from .model import Model


class TendonLines:
    """Pieces of the paths of a model's tendons."""

    model: Model

    def __init__(self, model: Model):
        self.model, self._data = model, model.data(Part.ALL)
        self._muscles = {a.tendon: a.idx_act for a in map(model.actuator, range(model.nactuators))
                         if a.type == ActuatorType.MUSCLE and a.transmission == Transmission.TENDON}

    def __call__(self, q: ArrayLike, act: ArrayLike | None = None) -> Numbers:
        """(n, 7): both ends, m, and the activation of a muscle, else -1. act: activations; None: 0."""
        self._data.tendons(q)
        pieces = [np.empty((0, 7))]
        for t in range(self.model.ntendons):
            path = self._data.tendon_path(t)
            goes_on = np.flatnonzero(path.begins[1:] == 0) + 1
            pulls = -1.0 if t not in self._muscles else 0.0 if act is None else np.asarray(act)[self._muscles[t]]
            pieces.append(np.column_stack([path.points[goes_on - 1], path.points[goes_on], np.full(len(goes_on), pulls)]))
        return np.concatenate(pieces)
