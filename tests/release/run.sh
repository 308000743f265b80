#!/usr/bin/env bash
# The wheel in bare Debian roots with Python alone (root.sh): installed by pip, it lets a quadruped stand, writes its page, reads meshes
# and sweeps accuracies, in less than a minute and without a compiler. Then C and C++ programs are compiled against it.
#   run.sh WHEEL [ROOTS [RELEASE...]]
# ROOTS: where the roots are made and kept, default: beside the wheel; releases, by default: bullseye bookworm trixie
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
limit=60

inside() {  # root, command: a clean environment, but where pip looks
  local root=$1
  shift
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    ${PIP_INDEX_URL:+PIP_INDEX_URL="$PIP_INDEX_URL"} PIP_CERT=/certificates.crt PIP_DISABLE_PIP_VERSION_CHECK=1 "$@"
}
one() {  # wheel, root
  local wheel=$1 root=$2 level
  mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
  # shellcheck disable=SC2064
  trap "umount '$root/proc'; rm -rf '$root.programs'" EXIT
  rm -rf "$root/venv" "$root/home"
  mkdir "$root/home"
  cp "$wheel" "$here"/{stands.py,hello.c,hello.cpp} "$root/home"
  cp -L /etc/resolv.conf "$root/etc/resolv.conf"
  cp /etc/ssl/certs/ca-certificates.crt "$root/certificates.crt"
  ! inside "$root" sh -c 'command -v cc gcc g++ clang' || { echo "there is a compiler in $root"; exit 1; }
  inside "$root" python3 -m venv /venv
  local began=$SECONDS
  inside "$root" /venv/bin/pip install -q "/home/$(basename "$wheel")"
  echo "installed in $((SECONDS - began)) s"
  inside "$root" /venv/bin/python /home/stands.py /home/stands.html
  local took=$((SECONDS - began))
  echo "installed, stood and drawn in $took s"
  [ $took -lt $limit ] || { echo "that is longer than $limit s"; exit 1; }
  for level in plain x86-64-v3; do
    inside "$root" env DYN_LEVEL=$level /venv/bin/python -c 'import libdyn as dyn; print(dyn.build_info)'
  done
  # programs: the compilers come now, into a copy
  rm -rf "$root.programs"
  mkdir "$root.programs"
  tar -C "$root" --one-file-system -c . | tar -C "$root.programs" -x
  inside "$root.programs" sh -c 'apt-get -qq update && apt-get -qq install -y --no-install-recommends gcc g++ libc6-dev' >"$root.log" 2>&1
  inside "$root.programs" sh -ec 'cd /home
    flags=$(/venv/bin/python -m libdyn --cflags --libs) robot=$(/venv/bin/python -m libdyn --models)/robots/go2.urdf
    gcc -std=c99 -Wall -Wextra -Werror hello.c -o hello_c $flags && ./hello_c $robot
    g++ -std=c++17 -Wall -Wextra -Werror hello.cpp -o hello_cpp $flags && ./hello_cpp $robot'
}
if [ "${1:-}" = --one ]; then
  one "$2" "$3"
  exit
fi

wheel=$(realpath "$1") roots=$(realpath -m "${2:-$(dirname "$1")/roots}") failed=0
shift $(($# < 2 ? $# : 2))
[ $# -gt 0 ] || set -- bullseye bookworm trixie
mkdir -p "$roots"
for release in "$@"; do
  root=$roots/$release
  if ! "$here/root.sh" "$root" "$release" >"$root.log" 2>&1; then
    tail -n 5 "$root.log"
    echo "$release: no root could be made"
    failed=$((failed + 1))
    continue
  fi
  echo "== $release: $(inside "$root" sh -c 'python3 --version; /sbin/ldconfig --version' | head -n 2 | tr '\n' ' ')"
  "$0" --one "$wheel" "$root" || { echo "$release: failed"; failed=$((failed + 1)); }
done
echo "$(($# - failed)) passed, $failed failed"
[ $failed = 0 ]
