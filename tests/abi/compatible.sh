#!/usr/bin/env bash
# What programs of 1.0 rely on is there: functions, types and layouts of dyn.h as libabigail sees them, against those of
# tests/abi/1.0/dyn.h.gz. Functions and enumerators may be added. (A struct that grows at its end keeps old callers, whose
# struct_size is smaller; it has to be recorded anew.)
#   compatible.sh CC dyn.h            compares (abidiff); 77, skipped, without abigail-tools
#   compatible.sh CC dyn.h --record   records dyn.h as what is promised
set -euo pipefail
cc=$1 header=$2 record=${3:-}
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The library knows every struct that may grow (capi/structs.def), and each init passes the caller's size.
root=$(cd "$here/../.." && pwd)
sized=$(awk '/^typedef struct [A-Za-z]+ \{/ {name = $3; getline; if ($0 ~ /uint32_t struct_size;/) print name}' "$header" | sort)
listed=$(sed -nE 's/^DYN_(READ|READ_KIND|WRITTEN)\((dyn[A-Za-z]+).*/\2/p' "$root/capi/structs.def" | sort)
[ "$sized" = "$listed" ] || { echo "dyn.h (<) and capi/structs.def (>) name different structs:"; diff <(echo "$sized") <(echo "$listed"); exit 1; }
sed -e ':a' -e '/\\$/{N;s/\\\n *//;ba}' "$header" >"$work/joined.h"
sed -nE 's/^DYN_(READ|READ_KIND)\((dyn[A-Za-z]+), (dyn_[a-z_]+_init).*/\3 \2/p' "$root/capi/structs.def" | while read -r init struct; do
  grep -qE "^#define $init\((.*)\) $init\([a-z]+, sizeof\($struct\)" "$work/joined.h" ||
    { echo "$init is no macro that passes sizeof($struct)"; exit 1; }
done
command -v abidw >/dev/null || { echo "abidw is not installed (package abigail-tools)"; exit 77; }

# a library that defines what the header declares: its debug information is the ABI, whatever compiled the real one (symbols.sh
# compares their names)
abi_of() {  # HEADER OUT
  "$cc" -E -P -DDYN_STATIC -x c "$1" | tr '\n' ' ' |
    awk 'BEGIN {RS = ";"} /typedef/ || !/dyn_[a-z0-9_]+ *\(.*\) *$/ {print $0 ";"; next} {print $0 " {__builtin_trap();}"}' | sed '$ s/;$//' >"$work/stub.c"
  "$cc" -std=gnu2x -g -fPIC -shared -w "$work/stub.c" -o "$work/libdyn.so"
  abidw --no-corpus-path --no-comp-dir-path --no-show-locs --no-architecture --no-elf-needed "$work/libdyn.so" >"$2"
}
abi_of "$header" "$work/dyn.abi"
functions=$(grep -c "<elf-symbol name='dyn_" "$work/dyn.abi")
[ "$functions" = "$(grep -c '^DYN_API' "$header")" ] || { echo "$functions of $(grep -c '^DYN_API' "$header") functions of the header were understood"; exit 1; }

if [ "$record" = --record ]; then
  gzip -9nc "$header" >"$here/1.0/dyn.h.gz"
  echo "recorded: $functions functions"
  exit 0
fi
gzip -dc "$here/1.0/dyn.h.gz" >"$work/1.0.h"
abi_of "$work/1.0.h" "$work/1.0.abi"
abidiff --no-added-syms "$work/1.0.abi" "$work/dyn.abi" || { echo "dyn.h breaks programs of 1.0 (before 1.0 is released: $0 CC dyn.h --record)"; exit 1; }
echo "$functions functions, $(grep -c "<elf-symbol name='dyn_" "$work/1.0.abi") of them of 1.0, nothing changed"

# structs that a caller makes say how large they are, and none ends in bytes that a new member would fill unseen
plain='dynMaterial|dynMuscle|dynDcMotor|dynRowReport|dynContact|dynContactForce|dynPlanPoint'  # parts of others, and elements of arrays that the library fills
unsized=$(awk '/^typedef struct [A-Za-z]+ \{/ {name = $3; getline; if ($0 !~ /uint32_t struct_size;/) print name}' "$header" | grep -vxE "$plain" || true)
[ -z "$unsized" ] || { echo "structs without struct_size: $unsized"; exit 1; }
padded=$("$cc" -std=c99 -Wpadded -fsyntax-only -x c "$header" 2>&1 | grep 'padding struct size' || true)
[ -z "$padded" ] || { echo "structs that end in padding:"; echo "$padded"; exit 1; }
