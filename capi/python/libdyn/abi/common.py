"""What all declarations share."""

from __future__ import annotations

import ctypes
from ctypes import Structure, c_char_p, c_double, c_int, c_int32, c_ssize_t, c_uint32, c_void_p

MAJOR = 1  # of the interface this package was written for


class Grown(Structure):
    """A structure that begins with its own size, so that it may grow."""

    def __init__(self, **values):
        super().__init__(**values)
        self.struct_size = ctypes.sizeof(self)


class Array(Grown):
    _fields_ = [("struct_size", c_uint32), ("rows", c_int32), ("cols", c_int32), ("stride", c_ssize_t * 2), ("data", c_void_p)]


class Material(Structure):
    _fields_ = [
        ("friction", c_double), ("torsion", c_double), ("rolling", c_double), ("restitution", c_double), ("stiffness", c_double),
        ("damping", c_double), ("surface_velocity", c_double * 3),
    ]  # fmt: skip

STATUS = c_int  # a dynStatus
p, s, i, d = c_void_p, c_char_p, c_int, c_double
ref = p  # of a structure or a handle that the call writes: byref() or an address
