#!/usr/bin/env bash
# What libdyn.so pulls in at run time, all the way down, is on the list.   dependencies.sh libdyn.so
set -euo pipefail
allowed='linux-vdso|linux-gate|ld-linux.*|libc|libm|libstdc\+\+|libgcc_s|libpthread|libdl|librt|liburdfdom_[a-z_]*|libtinyxml2?|libconsole_bridge'
all=$(ldd "$1" | awk '{print $1}' | sed -E 's|.*/||')
bad=$(echo "$all" | grep -vE "^($allowed)([.-].*)?\.so(\..*)?$" || true)
ldd "$1" | grep 'not found' && exit 1
[ -z "$bad" ] || { echo "not on the list of run-time dependencies:"; echo "$bad"; exit 1; }
echo "direct: $(readelf -d "$1" | sed -nE 's/.*NEEDED.*\[(.*)\]/\1/p' | tr '\n' ' ')"
