#!/usr/bin/env bash
# The library uses the best of its levels that runs here, however it is opened: by its soname, by its path, linked statically. DYN_LEVEL
# asks for another one, all of them compute the same, and an old processor gets the plain one.   levels.sh CC BUILD LEVEL...
set -euo pipefail
cc=$1 build=$2
shift 2
here=$(cd "$(dirname "$0")" && pwd)
project=$(cd "$here/../.." && pwd)
robot=$project/models/robots/go2.urdf
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
compile() { "$cc" -std=gnu99 -Wall -Wextra -Werror -I"$project/include" "$@"; }
compile "$here/level/user.c" -L"$build/lib" -ldyn -Wl,-rpath,"$build/lib" -o "$work/by_soname"
compile -DBY_PATH "$here/level/user.c" -ldl -o "$work/by_path"
compile -DSTATIC -DDYN_STATIC "$here/level/user.c" "$build/lib/libdyn.a" -lurdfdom_model -lconsole_bridge -ltinyxml2 -lstdc++ -lm -o "$work/static"

failed=0
fail() { echo "$*"; failed=1; }
run() { "${emulator[@]}" "$work/$1" "$robot" "$build/lib/libdyn.so.1"; }
expect() {  # level, how
  local name=$1
  [ "$name" != plain ] || name=$(uname -m)
  run "$2" >"$work/$1.$2" || fail "$2, level $1: ended with $?"
  grep -q ", $name, " "$work/$1.$2" || fail "$2: expected $name: $(head -1 "$work/$1.$2")"
}
emulator=()
for how in by_soname by_path static; do
  unset DYN_LEVEL
  expect "${!#}" $how
  DYN_LEVEL=x86-64-v9 expect "${!#}" $how
  for level in "$@"; do
    DYN_LEVEL=$level expect "$level" $how
    # relative to the largest number of each column
    awk 'function size(x) {return x < 0 ? -x : x} FNR == 1 {next} NR == FNR {a[FNR] = $1; b[FNR] = $2; next}
         {for (k = 1; k <= 2; ++k) {o = k == 1 ? a[FNR] : b[FNR]; if (size(o) > most[k]) most[k] = size(o); if (size(o - $k) > off[k]) off[k] = size(o - $k)}}
         END {exit !(FNR > 6 && off[1] <= 1e-12 * most[1] && off[2] <= 1e-12 * most[2])}' "$work/plain.by_soname" "$work/$level.$how" ||
      fail "$how: $level computes something else than plain"
  done
done
if command -v qemu-x86_64 >/dev/null; then
  emulator=(qemu-x86_64 -cpu Nehalem)
  for how in by_soname by_path static; do expect plain $how; done
  DYN_LEVEL=x86-64-v3 expect plain by_soname  # does not run there
  old=", and without AVX"
fi
# without AVX lanes lie in two registers each, and not in memory: at most so many times the instructions of x86-64-v3
emulator=()
if [[ " $* " == *" x86-64-v3 "* ]]; then
  count() { DYN_LEVEL=$1 "$build/bin/dyn_bench" "$robot" --floating --only rnea,aba,crba,rnea_derivatives --count | grep -oE '"instructions":[0-9]+' | cut -d: -f2; }
  paste <(count plain) <(count x86-64-v3) >"$work/counts"
  awk '$1 > 3.2 * $2 {bad = 1; print "plain takes " $1 " instructions, x86-64-v3 " $2} END {exit bad || NR != 4}' "$work/counts" || fail "instructions of the plain level"
fi
[ $failed = 0 ] || exit 1
echo "levels: $*; three ways of opening the library${old:-}"
