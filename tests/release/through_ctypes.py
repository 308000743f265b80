"""The wheel's dyn.dll in Python for Windows by ctypes alone: a scene is loaded and stepped.   through_ctypes.py DLL SCENE

Debian 12's wine lacks a function of the C library (crealf) that numpy calls, so the package itself cannot be imported there."""

import ctypes
import sys

lib = ctypes.CDLL(sys.argv[1])
lib.dyn_last_error.restype = lib.dyn_version.restype = ctypes.c_char_p
model, data = ctypes.c_void_p(), ctypes.c_void_p()


def check(status):
    assert status == 0, lib.dyn_last_error().decode()


check(lib.dyn_model_load(sys.argv[2].encode(), None, ctypes.byref(model)))
check(lib.dyn_data_new(model, 0, ctypes.byref(data)))
check(lib.dyn_data_reset(model, data, b"standing"))
for _ in range(200):
    check(lib.dyn_step(model, data))
print(f"Python {sys.version.split()[0]}, {sys.platform}: libdyn {lib.dyn_version().decode()}, 200 steps")
