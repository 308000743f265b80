#!/usr/bin/env bash
# PlatformIO packs the library, and builds its example by a platform of its own (platformio/) for QEMU, whose output this prints.
# SCons, PlatformIO's builder, comes from PyPI (pip install platformio scons) in place of PlatformIO's registry.
#   platformio.sh LIBRARY WORK
set -euo pipefail
library=$1 work=$2
here=$(cd "$(dirname "$0")" && pwd)
DYN_ROOT=$(cd "$here/../../.." && pwd)
export DYN_ROOT PLATFORMIO_CORE_DIR=$work/core

pack() {  # a copy's name, and what sed changes in its manifest
  cp -r "$library" "$work/$1"
  sed -i "$2" "$work/$1/library.json"
  pio pkg pack "$work/$1" --output "$work/$1.tar.gz" >"$work/log" 2>&1
}
if pack packed ''; then
  echo "library.json: packed by pio" >&2
elif grep -q "Could not load SPDX licenses" "$work/log"; then  # whose names pio asks the network for
  pack unlicensed '/"license"/d' || { cat "$work/log" >&2; exit 1; }
  echo "library.json: packed by pio, its license unchecked" >&2
else
  cat "$work/log" >&2
  exit 1
fi

python=$(sed -n '1s/^#!//p' "$(command -v pio)")
"$python" -c 'import SCons' 2>/dev/null || { echo "PlatformIO did not build: no SCons" >&2; exit 3; }
version=$("$python" -c 'from platformio.dependencies import get_core_dependencies as d; print(d()["tool-scons"].lstrip("~"))')
scons=$PLATFORMIO_CORE_DIR/packages/tool-scons platforms=$PLATFORMIO_CORE_DIR/platforms
mkdir -p "$scons" "$platforms" "$work/project/src"
installed() {  # type, name, version, owner
  local spec="{\"owner\": $4, \"id\": null, \"name\": \"$2\", \"requirements\": null, \"uri\": null}"
  echo "{\"type\": \"$1\", \"name\": \"$2\", \"version\": \"$3\", \"spec\": $spec}"
}
printf '{"name": "tool-scons", "version": "%s"}' "$version" >"$scons/package.json"
installed tool tool-scons "$version" '"platformio"' >"$scons/.piopm"
printf 'import SCons.Script\nSCons.Script.main()\n' >"$scons/scons.py"
cp -r "$here/platformio" "$platforms/bare"
installed platform bare 1.0.0 null >"$platforms/bare/.piopm"

cat >"$work/project/platformio.ini" <<INI
[env:an500]
platform = bare
board = an500
lib_deps = symlink://$library
lib_compat_mode = off
INI
cp "$library"/examples/gravity/*.[ch] "$DYN_ROOT"/tools/bare_metal/start{,_cortex_m}.cpp "$work/project/src"
{ echo '#include <Arduino.h>' && cat "$library/examples/gravity/gravity.ino"; } >"$work/project/src/main.cpp"
pio run -d "$work/project" >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; exit 1; }
timeout 60 qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none -icount shift=0,sleep=off \
  -semihosting-config enable=on,target=native -kernel "$work/project/.pio/build/an500/program.elf" 2>&1
