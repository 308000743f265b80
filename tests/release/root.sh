#!/usr/bin/env bash
# Makes a bare root of a release of Debian, with Python alone, from this machine's mirror.   root.sh FOLDER RELEASE
set -euo pipefail
root=$1 release=$2
[ ! -e "$root/made" ] || exit 0
rm -rf "$root"
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Component: main' | head -n 1)
debootstrap --variant=minbase --include=python3,python3-venv,python3-pip,ca-certificates "$release" "$root" "$mirror"
rm -rf "$root"/var/cache/apt/archives/*.deb
touch "$root/made"
