#!/usr/bin/env bash
# dyn_core needs no exceptions, RTTI, streams, files, heap or threads.   core_symbols.sh OBJECT...
set -euo pipefail
banned='^(__cxa_(throw|allocate_exception|begin_catch|rethrow|guard_acquire)|__dynamic_cast|_ZT[ISV].*|_Znwm.*|_Znam.*|_Zdl.*|_Zda.*|malloc|calloc|realloc|free|aligned_alloc|posix_memalign|fopen|fread|fwrite|printf|fprintf|puts|_ZNSt.*stream.*|_ZSt4cout|_ZSt4cerr|_ZSt20__throw.*|pthread_.*|abort|exit)$'
bad=$(nm -A --undefined-only "$@" | awk '{print $NF, $1}' | awk -v banned="$banned" '$1 ~ banned' || true)
[ -z "$bad" ] || { echo "dyn_core refers to:"; echo "$bad" | sed -E 's|^([^ ]*) .*/([^/:]*):?.*|  \1  in \2|'; exit 1; }
echo "$# objects, nothing forbidden"
