#!/usr/bin/env bash
# The same five lines through the foreign-function interfaces of other languages: each that is installed prints what C does.
#   run.sh CC dyn.h libdyn.so robot.urdf [--all: languages that tools/packages names must be there]
set -euo pipefail
cc=$1 include=$(cd "$(dirname "$2")" && pwd) library=$3 robot=$4
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
folder=$(dirname "$library")
export LD_LIBRARY_PATH=$folder
cat >"$work/gravity.c" <<'C'
#include <dyn.h>
#include <stdio.h>
int main(int argc, char** argv) {
  dynModel* model = NULL;
  dynData* data = NULL;
  double q[2] = {0.3, -0.4}, tau[2];
  if (argc != 2 || dyn_model_load(argv[1], NULL, &model) || dyn_data_new(model, 0, &data) || dyn_gravity_torque(model, data, q, tau)) return puts(dyn_last_error()), 1;
  return printf("nv %d, gravity %.9f %.9f\n", dyn_model_nv(model), tau[0], tau[1]) < 0;
}
C
"$cc" -std=c99 -I"$include" "$work/gravity.c" -L"$folder" -ldyn -o "$work/gravity_c"
expected=$("$work/gravity_c" "$robot")
echo "C: $expected"
failed=0 ran=0
try() {  # name, command...
  local name=$1 got
  shift
  got=$("$@" 2>"$work/log") || { cat "$work/log"; got="failed"; }
  [ "$got" = "$expected" ] && ran=$((ran + 1)) || failed=1
  echo "$name: $got"
}
has() { command -v "$1" >/dev/null || { echo "$1: not installed"; return 1; }; }
has luajit && try LuaJIT luajit "$here/gravity.lua" "$library" "$robot"
has ruby && try Ruby ruby "$here/gravity.rb" "$library" "$robot"
perl -MFFI::Platypus -e1 2>/dev/null && try Perl perl "$here/gravity.pl" "$library" "$robot" || echo "Perl: no FFI::Platypus"
has rustc && try Rust sh -c "rustc -o '$work/gravity_rs' -L '$folder' -l dyn '$here/gravity.rs' && '$work/gravity_rs' '$robot'"
has go && try Go env GOCACHE="$work/go" GOFLAGS=-mod=mod CGO_CFLAGS="-I$include" CGO_LDFLAGS="-L$folder -ldyn" go run "$here/gravity.go" "$robot"
echo "$ran other languages say what C says"
[ "$failed" = 0 ]
