#!/usr/bin/env python3
"""Writes the names that Emscripten exports: the functions of dyn.h, malloc and free.   exports.py functions.inc OUT"""

import json
import re
import sys

with open(sys.argv[1], encoding="utf-8") as file:
    names = re.findall(r"FUNCTION\((\w+)\)", file.read())
with open(sys.argv[2], "w", encoding="utf-8") as file:
    json.dump([f"_{name}" for name in [*names, "malloc", "free"]], file)
