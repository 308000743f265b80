#!/usr/bin/env bash
# Makes one object of a level's objects. Its functions of dyn.h are named LEVEL.dyn_..., and everything else is local: no inline function
# of one level, not even of the C++ library, stands in for that of another. What runs when a library is loaded runs when the level is
# chosen (choose.c).   object.sh LD OBJCOPY LEVEL functions.inc OUT OBJECT...
set -euo pipefail
ld=$1 objcopy=$2 level=$3 functions=$4 out=$5
shift 5
names=$(sed -nE 's/^FUNCTION\((.*)\)$/\1/p' "$functions")
awk -v level="$level" '{print $1, level "." $1}' <<<"$names" >"$out.renamed"
awk -v level="$level" '{print level "." $1}' <<<"$names" >"$out.global"
printf '%s\n' "$@" >"$out.objects"
"$ld" -r --force-group-allocation -o "$out.joined" "@$out.objects"
nm "$out.joined" | awk '$2 == "u" {print $3}' >"$out.unique"  # GNU's unique symbols, which --keep-global-symbols leaves global: weak first
"$objcopy" --weaken-symbols="$out.unique" --redefine-syms="$out.renamed" --rename-section ".init_array=dyn_init_$level" "$out.joined" "$out.named"
"$objcopy" --keep-global-symbols="$out.global" "$out.named" "$out"
rm -f "$out".{objects,joined,unique,renamed,global,named}
