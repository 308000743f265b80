#!/usr/bin/env bash
# The npm package: its tests in Node.js, its types by TypeScript, the hashes of all scenes against this machine's, and a page that simulates
# by itself in a browser without a screen.   browser.sh PACKAGE.tgz FOLDER BUILD DYN
# FOLDER: kept for the next time; BUILD: the build by Emscripten, with dyn_soak; DYN: the command, which writes the page
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
package=$(realpath "$1") folder=$(realpath -m "$2") build=$(realpath "$3") dyn=$(realpath "$4") steps=500
"$root/tools/install_packages" "$root/tools/packages_browser"
rm -rf "$folder/package"
mkdir -p "$folder"
tar -xzf "$package" -C "$folder"
size=$(stat -c %s "$package")
echo "$(basename "$package"): $size bytes"
DYN_JS=$folder/package node --test "$root/capi/js/test/"

[ -x "$folder/node_modules/.bin/tsc" ] || (cd "$folder" && npm install --silent --no-audit --no-fund typescript@5 esbuild@0.25)
cp "$root/capi/js/test/types.mts" "$folder/package/types.mts"
(cd "$folder/package" && "$folder/node_modules/.bin/tsc" --noEmit --strict --target es2022 --module nodenext types.mts)
echo "types: fine"

same=$folder/same
cmake -S "$root" -B "$same" -G Ninja -DCMAKE_BUILD_TYPE=Release -DDYN_CORE_ONLY=ON -DDYN_TESTS=ON -DDYN_TOGETHER=ON -DDYN_REPRODUCIBLE=ON -DDYN_BOARD_TESTS= \
  "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG -Wno-maybe-uninitialized" >"$folder/log"
cmake --build "$same" --target dyn_soak >"$folder/log"
"$same/bin/dyn_soak" --hash --steps $steps >"$folder/hashes"
node --no-experimental-fetch "$build/bin/dyn_soak.js" --hash --steps $steps | diff "$folder/hashes" -
echo "the hashes of $(wc -l <"$folder/hashes") scenes after $steps steps: the same"

scene=$root/models/scenes/go2_stands.xml
"$dyn" view "$scene" --configuration standing --html "$folder/still.html" --no-browser >/dev/null
node "$root/capi/js/page.mjs" "$folder/node_modules/.bin/esbuild" "$folder/package" "$scene" "$folder/still.html" "$folder/page.html" standing
[ -x "$folder/venv/bin/python" ] || { python3 -m venv "$folder/venv" && "$folder/venv/bin/pip" install -q playwright; }
"$folder/venv/bin/python" "$here/in_browser.py" "$folder/page.html"
