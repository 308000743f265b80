#!/usr/bin/env bash
# A program beside the library is given the variant for this processor.   loader.sh PROGRAM VARIANT|plain
set -euo pipefail
path=$(ldd "$1" | awk '$1 == "libdyn.so.1" {print $3}')
variant=$(echo "$path" | sed -nE 's|.*/glibc-hwcaps/([^/]*)/.*|\1|p')
[ "${variant:-plain}" = "$2" ] || { echo "loaded '$path', expected the variant $2"; exit 1; }
echo "$path"
