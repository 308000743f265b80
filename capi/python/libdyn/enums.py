"""The enumerations of dyn.h, made from the library's own description.

Wherever one is expected, a member, its name in either case, or its number is accepted.
"""

from __future__ import annotations

import enum

from .interface import INTERFACE, public_name


def _make(described: dict[str, Any]) -> type[enum.Enum]:
    values = {value["name"]: value["value"] for value in described["values"]}
    masks = described["bits"] or max(values.values()) > len(values)
    made: type[enum.Enum] = (enum.IntFlag if masks else enum.IntEnum)(public_name(described), values, module=__name__)
    sentences = [f"{value['name']}: {value['doc']}" for value in described["values"] if value["doc"]]
    made.__doc__ = "\n".join([described["doc"], *sentences]).strip()
    for value in described["values"]:
        made[value["name"]].__doc__ = value["doc"]
    return made


__all__ = []
for _described in INTERFACE["enums"]:
    globals()[public_name(_described)] = _make(_described)
    __all__ += [public_name(_described)]
