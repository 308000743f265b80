#!/usr/bin/env bash
# The source distribution: pip installs it into an environment of its own, which compiles the plain level of the library, and a robot is
# loaded there.   source.sh SDIST
set -euo pipefail
sdist=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
DYN_LEVELS=OFF "$work/venv/bin/pip" install -q "$sdist"
cd "$work"
env -u DYN_LIBRARY -u DYN_CLI -u PYTHONPATH "$work/venv/bin/python" - <<'PY'
from pathlib import Path
import libdyn as dyn
assert Path(dyn.library_path).is_relative_to(Path(dyn.__file__).parent), dyn.library_path
m = dyn.load(dyn.models / "robots/go2.urdf", base="floating")
print(dyn.build_info, m.nq, m.nv)
PY
"$work/venv/bin/dyn" info "$("$work/venv/bin/python" -m libdyn --models)/robots/panda.urdf" --fixed | sed -n 1,3p
