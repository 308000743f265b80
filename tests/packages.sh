#!/usr/bin/env bash
# What cpack makes, each unpacked into an empty root: the C99 consumer is built against it and run, the command finds its library
# there.   packages.sh BUILD_DIR LIBDIR
set -euo pipefail
build=$1 libdir=$2
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "packages: $*" >&2; exit 1; }
quiet() { "$@" >"$work/log" 2>&1 || { cat "$work/log"; fail "failed: $*"; }; }
cpack=${CPACK:-cpack}
command -v "$cpack" >/dev/null || { echo "cpack is not installed"; exit 77; }
cp -r "$here/consumer_c" "$work"

use() {  # what, root with include, bin and the like
  local prefix=$2
  export PKG_CONFIG_PATH=$prefix/$libdir/pkgconfig
  quiet make -C "$work/consumer_c" clean
  quiet make -C "$work/consumer_c" CC="${CC:-cc}"
  local said
  said=$(LD_LIBRARY_PATH=$prefix/$libdir "$work/consumer_c/consumer" "$prefix/share/dyn/models/robots/double_pendulum.urdf")
  case "$said" in *"nv 2"*) ;; *) fail "$1: the consumer printed: $said";; esac
  local loaded
  loaded=$(env -u LD_LIBRARY_PATH ldd "$prefix/bin/dyn" | awk '$1 == "libdyn.so.1" {print $3}')
  case "$(realpath "$loaded")" in "$(realpath "$prefix")"/*) ;; *) fail "$1: bin/dyn loads $loaded";; esac
  quiet "$prefix/bin/dyn" info "$prefix/share/dyn/models/robots/double_pendulum.urdf" --fixed
  local text=$prefix/share/doc
  [ ! -e /usr/share/doc/libeigen3-dev/copyright ] || [ -s "$(echo "$text"/*/licenses/libeigen3-dev.txt)" ] || fail "$1: no license of Eigen"
  ! grep -rIlF -e "$build" -e "$(dirname "$here")/" "$prefix" || fail "$1: paths of the build in the files above"
  echo "$1: consumer, $said"
}

cd "$work"
quiet "$cpack" --config "$build/CPackConfig.cmake" -G TGZ -B "$work/tgz"
mkdir tgz_root && tar -xzf tgz/*.tar.gz -C tgz_root
use ".tar.gz" "$(echo "$work"/tgz_root/*)"

command -v dpkg-deb >/dev/null || { echo "dpkg-deb is not installed: no .deb"; exit 0; }
quiet "$cpack" --config "$build/CPackConfig.cmake" -G DEB -B "$work/deb"
deb=$(echo deb/*.deb)
dpkg-deb -x "$deb" deb_root
use ".deb" "$work/deb_root/usr"
[ "$(dpkg-deb -f "$deb" Package)" = libdyn ] || fail "the package is called $(dpkg-deb -f "$deb" Package)"
depends=$(dpkg-deb -f "$deb" Depends)
if command -v dpkg-shlibdeps >/dev/null; then
  for needed in libc6 libstdc++6 liburdfdom; do case "$depends" in *$needed*) ;; *) fail "it does not depend on $needed, but on: $depends";; esac; done
fi
case "$(dpkg-deb --ctrl-tarfile "$deb" | tar -xO ./postinst)" in *ldconfig*) ;; *) fail "its postinst does not call ldconfig";; esac
echo "$(basename "$deb"), $(stat -c %s "$deb") bytes, needs $depends"
