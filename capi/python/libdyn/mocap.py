"""Mocap bodies: links fixed to the world whose placement the caller sets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .arrays import address, checked
from .choices import size, string, text
from .fields import Fields
from .handles import ModelHandle
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class ModelMocaps(ModelHandle):
    """The part of Model that knows its mocap bodies."""

    @property
    def nmocaps(self) -> int:
        return size(lib.dyn_model_nmocaps(self._m))

    @property
    def mocap_names(self) -> list[str]:
        return [string(lib.dyn_model_frame_name(self._m, self.mocap_frame(k))) for k in range(self.nmocaps)]

    def mocap_frame(self, mocap: int) -> int:
        """Id of the frame of a mocap body."""
        return size(lib.dyn_model_mocap_frame(self._m, mocap))

    def mocap_id(self, name: str) -> int:
        """Number of a mocap body of the model."""
        return self._id(lib.dyn_model_mocap_id(self._m, text(name, "mocap")))

    def _mocap(self, mocap: int | str) -> int:
        return self.mocap_id(mocap) if isinstance(mocap, str) else self._index(mocap, self.nmocaps, "mocap")


class MocapCalls(Fields):
    """The part of Data that places mocap bodies. The field mocap, (12, nmocaps), reads all placements."""

    def set_mocap(self, mocap: str | int, translation: ArrayLike, rotation: ArrayLike | None = None) -> None:
        """Places a mocap body: translation (3,), m, and rotation (3, 3), None: as it is; world axes. What is fixed to it goes
        along, constraints pull other bodies to it, and sleeping bodies wake. It has no velocity."""
        id = self.model._mocap(mocap)
        x = self.field("mocap")[:, id].copy()
        x[9:] = checked(translation, (3,), "translation")
        if rotation is not None:
            x[:9] = checked(rotation, (3, 3), "rotation").T.ravel()
        check(lib.dyn_data_set_mocap(self._m, self._d, id, address(x)))
