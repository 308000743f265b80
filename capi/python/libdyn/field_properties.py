"""A property of Data for each of the library's fields. What they look like is in field_properties.pyi, written by `python -m libdyn.stubs`."""

from __future__ import annotations

from .fields import FIELDS, FieldInfo

STATE = {"q": "q", "v": "v", "a": "a", "tau_applied": "tau"}  # field: argument of set_state


def description(info: FieldInfo) -> str:
    origin = f" Computed by {info.producer}." if info.producer else ""
    return f"{info.sentence} ({info.shape}; {info.unit or 'no unit'}; frame: {info.frame or 'none'}.){origin}"


def _property(info: FieldInfo) -> property:
    def get(self):
        return self.field(id)

    def put(self, value):
        self.set_state(**{STATE[name]: value})

    id, name = info.id, info.name
    return property(get, put if name in STATE else None, doc=description(info))


class Fields:
    """The part of Data that has the fields."""


for _info in FIELDS.values():
    setattr(Fields, _info.name, _property(_info))
