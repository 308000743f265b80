#!/usr/bin/env bash
# Builds the fuzzers with clang and runs each for some seconds, from tests/fuzz/corpus and what earlier runs found
# (build/fuzz/found), as many at once as there are processors.
#   run.sh [--all] BUILD [SECONDS each] [NAME...]     BUILD: a build of the library and its tests; without clang: 77; 0 s: builds alone
# --all: the builder, the algorithms and the C interface are watched, too (it takes some minutes to compile them so)
set -euo pipefail
cd "$(dirname "$0")/../.."
all=OFF out=$PWD/build/fuzz
if [ "$1" = --all ]; then
  shift
  all=ON out=$PWD/build/fuzz_all
fi
build=$(cd "$1" && pwd) seconds=${2:-10}
shift $(($# < 2 ? $# : 2))
command -v clang++ >/dev/null || { echo "clang++ is not installed"; exit 77; }
level=$(sed -n 's/^DYN_ARCH:STRING=//p' "$build/CMakeCache.txt")
[ "$level" != native ] || level=$(sed -n 's/.*-march=\(x86-64-v[34]\).*/\1/p' "$build/build.ninja" | head -1)
# the level that the tests link
for archive in "$build"/lib/libdyn_internal_v*.a; do
  [ ! -e "$archive" ] || level=x86-64-$(sed -E 's/.*_(v[34])\.a/\1/' <<<"$archive")
done
[ -e "$archive" ] || archive=$build/lib/libdyn_internal.a
mkdir -p "$out"
cmake -S tests/fuzz -B "$out" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" -DDYN_BUILD="$build" -DDYN_FUZZ_ALL=$all -DDYN_FUZZ_ARCH="$level" -DDYN_ARCHIVE="$archive" >"$out/log" 2>&1 &&
  cmake --build "$out" --parallel 2 >"$out/log" 2>&1 || { tail -n 40 "$out/log"; exit 1; }
[ "$seconds" != 0 ] || exit 0
[ $# -gt 0 ] || set -- urdf srdf mjcf mesh dynb state calls
export LD_LIBRARY_PATH=$build/lib  # of the module that reads meshes
export UBSAN_OPTIONS=print_stacktrace=1
# compiled models as they are today
mkdir -p "$out/found/dynb"
for robot in robots/double_pendulum mechanisms/four_bar; do
  "$build/bin/dyn" convert --fixed models/$robot.urdf "$out/found/dynb/$(basename $robot).dynb" 2>/dev/null
done
fuzz() {  # a name
  local name=$1 leaks=1 seeds=() dictionary=()
  mkdir -p "$out/found/$name" "$out/crashes"
  [ ! -d "tests/fuzz/corpus/$name" ] || seeds=("tests/fuzz/corpus/$name")
  [ ! -e "tests/fuzz/$name.dict" ] || dictionary=(-dict="tests/fuzz/$name.dict")
  if ASAN_OPTIONS=detect_leaks=$leaks:allocator_may_return_null=1 "$out/fuzz_$name" -detect_leaks=$leaks -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len=40000 -print_final_stats=1 "${dictionary[@]}" \
      -artifact_prefix="$out/crashes/$name-" "$out/found/$name" "${seeds[@]}" >"$out/$name.log" 2>&1; then
    echo "$name: $(sed -n 's/.*number_of_executed_units: *//p' "$out/$name.log") inputs, nothing found"
  else
    echo "$name: found something:
$(grep -E -A12 'ERROR|runtime error|SUMMARY|artifact' "$out/$name.log" | head -n 40)"
    return 1
  fi
}
export out seconds
export -f fuzz
printf '%s\n' "$@" | xargs -P "$(nproc)" -I{} bash -c 'fuzz {}' || exit 1
