"""A property of Model for each array of the library: limits, armature, damping, and so on."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

from .arrays import view
from .choices import member
from .enums import ModelArray
from .handles import ModelHandle
from .library import fail, lib

if TYPE_CHECKING:
    from .arrays import Numbers
    from .enums import ModelArrayLike

DESCRIBED: dict[Any, tuple[str, str]] = {array: (array.__doc__ or "").partition(": ")[::2] for array in ModelArray}
"""Size of each array, "nq", "nv" or a number, and its sentence."""


_HINT = "a model is not changed: dyn.Builder.from_model(model) makes another one. To change a copy of the array: x.copy()."


class ModelArrays(ModelHandle):
    """The part of Model that has arrays."""

    def array(self, which: ModelArrayLike) -> Numbers:
        """Read-only view of an array of the model."""
        which = member(ModelArray, which, "which")
        start = lib.dyn_model_array(self._m, which)
        size = DESCRIBED[which][0]
        n = int(size) if size.isdigit() else {"nq": self.nq, "nv": self.nv}[size]
        if start is None and n:
            fail(2)
        return view(start, n, None, (1, 0), self._owner, _HINT)


def _property(which: Any, size: str, sentence: str) -> cached_property:
    found = cached_property(lambda self: self.array(which))
    found.__doc__ = f"({size},): {sentence}"
    found.__set_name__(ModelArrays, which.name.lower())
    return found


for _array, (_size, _sentence) in DESCRIBED.items():
    setattr(ModelArrays, _array.name.lower(), _property(_array, _size, _sentence))
