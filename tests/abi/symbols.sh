#!/usr/bin/env bash
# The library exports what dyn.h declares, under version DYN_1, and nothing else.   symbols.sh CC dyn.h libdyn.so
set -euo pipefail
cc=$1 header=$2 library=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$cc" -E -P -DDYN_STATIC -x c "$header" | tr '\n' ' ' | tr ';{}' '\n\n\n' | sed -nE 's/^[^(]*[ *](dyn_[A-Za-z0-9_]+) *\(.*/\1/p' | sort -u >"$work/declared"
nm -D --defined-only --with-symbol-versions "$library" | awk '$2 != "A" {print $3}' | sort -u >"$work/versioned"
sed -n 's/@@DYN_1$//p' "$work/versioned" >"$work/exported"

fail=0
report() {  # title, list
  [ -s "$2" ] || return 0
  echo "$1:"; sed 's/^/  /' "$2"; fail=1
}
grep -v '@@DYN_1$' "$work/versioned" >"$work/foreign" || true
comm -23 "$work/declared" "$work/exported" >"$work/missing"
comm -13 "$work/declared" "$work/exported" >"$work/extra"
report "exported outside version DYN_1" "$work/foreign"
report "declared in dyn.h, not exported" "$work/missing"
report "exported, not declared in dyn.h" "$work/extra"
soname=$(readelf -d "$library" | sed -nE 's/.*SONAME.*\[(.*)\]/\1/p')
[ "$soname" = libdyn.so.1 ] || { echo "SONAME is '$soname', not libdyn.so.1"; fail=1; }
echo "$(wc -l <"$work/exported") symbols exported, $(wc -l <"$work/declared") declared"
[ -s "$work/declared" ] || { echo "no declarations found in $header"; fail=1; }
exit $fail
