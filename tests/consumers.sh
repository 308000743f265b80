#!/usr/bin/env bash
# Installs a build into a folder of its own, then builds and runs, against that tree alone: a C99 program (pkg-config and make), a
# C++ program (find_package(dyn), shared and static), and the README's programs.   consumers.sh BUILD_DIR LIBDIR
set -euo pipefail
build=$1 libdir=$2
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake=${CMAKE:-cmake}
fail() { echo "consumers: $*" >&2; exit 1; }
quiet() { "$@" >"$work/log" 2>&1 || { cat "$work/log"; fail "failed: $*"; }; }

prefix=$work/prefix
quiet "$cmake" --install "$build" --prefix "$prefix"
for file in include/dyn.h "$libdir/libdyn.so" "$libdir/libdyn.so.1" "$libdir/libdyn.a" "$libdir/pkgconfig/dyn.pc" "$libdir/cmake/dyn/dynConfig.cmake"; do
  [ -e "$prefix/$file" ] || fail "not installed: $file"
done
# nothing in the text of the tree may know where it was built
! grep -rIlF -e "$build" -e "$(dirname "$here")/" "$prefix/include" "$prefix/$libdir/cmake" "$prefix/$libdir/pkgconfig" || fail "paths of the build in the installed files above"
mv "$prefix" "$work/moved" && prefix=$work/moved  # and it can be moved
robot=$prefix/share/dyn/models/robots/double_pendulum.urdf
expect() { echo "$1: $2"; case "$2" in *"nv 2"*) ;; *) fail "$1 printed something else";; esac; }

export PKG_CONFIG_PATH=$prefix/$libdir/pkgconfig
cp -r "$here/consumer_c" "$here/consumer_cpp" "$work"
quiet make -C "$work/consumer_c" CC="${CC:-cc}"
expect "C99, pkg-config" "$(LD_LIBRARY_PATH=$prefix/$libdir "$work/consumer_c/consumer" "$robot")"
quiet make -C "$work/consumer_c" clean
quiet make -C "$work/consumer_c" CC="${CC:-cc}" STATIC=1
expect "C99, pkg-config, static" "$("$work/consumer_c/consumer" "$robot")"

quiet "$cmake" -S "$work/consumer_cpp" -B "$work/consumer_cpp/build" -DCMAKE_BUILD_TYPE=Release -Ddyn_DIR="$prefix/$libdir/cmake/dyn" -DCMAKE_CXX_COMPILER="${CXX:-c++}"
quiet "$cmake" --build "$work/consumer_cpp/build"
expect "C++, find_package" "$("$work/consumer_cpp/build/consumer" "$robot")"
expect "C++, find_package, static" "$("$work/consumer_cpp/build/consumer_static" "$robot")"

# the installed command finds the installed library
if [ -x "$prefix/bin/dyn" ]; then
  loaded=$(env -u LD_LIBRARY_PATH ldd "$prefix/bin/dyn" | awk '$1 == "libdyn.so.1" {print $3}')
  case "$(realpath "$loaded")" in "$(realpath "$prefix")"/*) echo "bin/dyn loads ${loaded#"$prefix"/bin/../}";; *) fail "bin/dyn loads $loaded";; esac
  "$prefix/bin/dyn" info "$robot" --fixed >/dev/null || fail "the installed dyn info failed"
  for file in man/man1/dyn.1 bash-completion/completions/dyn zsh/site-functions/_dyn fish/vendor_completions.d/dyn.fish; do
    grep -q collision "$prefix/share/$file" || fail "not installed, or without the command's options: share/$file"
  done
fi

# the README's programs: its first block of C and its first block of Python, run from the project's folder
readme=$(dirname "$here")/README.md
block() { awk -v start="^\`\`\`$1\$" '$0 ~ start {on = 1; next} on && /^```/ {exit} on' "$readme"; }
if [ -e "$readme" ] && grep -q '^```c$' "$readme"; then
  block c >"$work/readme.c"
  flags=$(pkg-config --cflags --libs dyn)
  # shellcheck disable=SC2086
  quiet "${CC:-cc}" -std=c99 -Wall -Wextra -Werror "$work/readme.c" -o "$work/readme" $flags -lm
  (cd "$here/.." && LD_LIBRARY_PATH=$prefix/$libdir quiet "$work/readme") && echo "README, C: $(tail -1 "$work/log")"
fi
python=${DYN_PYTHON:-python3}
if [ -e "$readme" ] && grep -q '^```python$' "$readme"; then
  block python >"$work/readme.py"
  if "$python" -c 'import numpy' 2>/dev/null; then
    (cd "$here/.." && PYTHONPATH=capi/python DYN_LIBRARY=$prefix/$libdir quiet "$python" "$work/readme.py") && echo "README, Python: $(tail -1 "$work/log")"
  else
    echo "README, Python: not run, $python has no numpy (tools/test has one that does)"
  fi
fi
echo "all consumers built and ran"
