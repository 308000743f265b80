#!/usr/bin/env bash
# A program compiled with the header of 1.0 runs with this library and prints what it printed then: words as they are, numbers to
# 1e-8.
#   old_consumer.sh CC libdyn.so robot.urdf [--record]
set -euo pipefail
cc=$1 library=$2 robot=$3 record=${4:-}
here=$(cd "$(dirname "$0")" && pwd)/1.0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/include"
gzip -dc "$here/dyn.h.gz" >"$work/include/dyn.h"
"$cc" -std=c99 -Wall -Wextra -Werror -I"$work/include" "$here/consumer.c" -L"$(dirname "$library")" -ldyn -lm -o "$work/consumer"
LD_LIBRARY_PATH=$(dirname "$library") "$work/consumer" "$robot" >"$work/out"
[ "$record" != --record ] || { cp "$work/out" "$here/consumer.txt"; exit 0; }
awk 'function near(x, y) {return x == y || (x + 0 != 0 || y + 0 != 0) && (x - y < 1e-8 * (1 + (x < 0 ? -x : x)) && y - x < 1e-8 * (1 + (x < 0 ? -x : x)) && x ~ /^[-+0-9.e]+$/ && y ~ /^[-+0-9.e]+$/)}
     NR == FNR {expected[FNR] = $0; lines = FNR; next}
     {n = split(expected[FNR], x); bad = n != NF; for (k = 1; k <= NF; ++k) bad += !near(x[k], $k); if (bad) {print "expected: " expected[FNR] "\nprinted:  " $0; failed = 1}}
     END {if (FNR != lines) {print FNR " lines, expected " lines; failed = 1} exit failed}' "$here/consumer.txt" "$work/out"
echo "$(wc -l <"$work/out") lines as in 1.0"
