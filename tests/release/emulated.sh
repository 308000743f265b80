#!/usr/bin/env bash
# The wheel for aarch64 under qemu-user, with Debian's Python for that processor and PyPI's numpy: a quadruped stands and is pushed, a mesh
# is read, and the command dyn writes a page.   emulated.sh WHEEL [FOLDER]     FOLDER: kept for the next time, default: beside the wheel
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
wheel=$(realpath "$1") folder=$(realpath -m "${2:-$(dirname "$1")/aarch64}") python=3.11
"$here/../../tools/install_packages" <(echo qemu-user)
if [ ! -e "$folder/made" ]; then
  rm -rf "$folder"
  mkdir -p "$folder/root/site"
  "$here/../../tools/wheel/apt" "$folder" bookworm arm64 download libc6 libgcc-s1 libstdc++6 zlib1g libexpat1 libffi8 libssl3 libbz2-1.0 \
    liblzma5 libuuid1 python$python-minimal libpython$python-{minimal,stdlib}
  for package in "$folder"/*.deb; do dpkg-deb -x "$package" "$folder/root"; done
  python3 -m venv "$folder/venv"
  "$folder/venv/bin/pip" download -q --no-deps -d "$folder" --platform manylinux_2_28_aarch64 --platform manylinux2014_aarch64 \
    --python-version $python --only-binary :all: 'numpy<2.3'
  python3 -m zipfile -e "$folder"/numpy*.whl "$folder/root/site"
  touch "$folder/made"
fi
rm -rf "$folder/site"
mkdir "$folder/site"
python3 -m zipfile -e "$wheel" "$folder/site"
chmod +x "$folder/site/libdyn/bin/dyn"  # which zipfile leaves out
run() { qemu-aarch64 -L "$folder/root" -E PYTHONPATH="$folder/site:$folder/root/site" "$@"; }
cd "$folder"
run "root/usr/bin/python$python" "$here/stands.py" page.html --no-command
run site/libdyn/bin/dyn sim site/libdyn/share/dyn/models/scenes/go2_stands.xml --configuration standing --duration 0.2 --html page.html >dyn.log
grep -q 'id="dyn-head"' page.html
echo "page.html: $(stat -c %s page.html) bytes"
