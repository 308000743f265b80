"""A wheel of a folder: metadata, notices, hashes of the files, and the archive. The same files give the same bytes."""

import base64
import hashlib
import os
import sysconfig
import zipfile

import tree

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.9 and 3.10
    import tomli as tomllib

# the command dyn: not an entry point, which would import the package, and numpy with it
COMMAND = """#!python
import importlib.util
import os
import sys

command = os.path.join(os.path.dirname(importlib.util.find_spec("libdyn").origin), "bin", "dyn")
os.execv(command, [command, *sys.argv[1:]])
"""
# of Windows: Scripts lies beside Lib, or for one user beside site-packages
BATCH = """@setlocal
@set command="%~dp0..\\Lib\\site-packages\\libdyn\\bin\\dyn.exe"
@if not exist %command% set command="%~dp0..\\site-packages\\libdyn\\bin\\dyn.exe"
@%command% %*
"""


def project():
    return tomllib.loads((tree.PACKAGE / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def metadata():
    p = project()
    lines = ["Metadata-Version: 2.1", f"Name: {p['name']}", f"Version: {p['version']}", f"Summary: {p['description']}",
             f"Keywords: {','.join(p['keywords'])}", f"License: {p['license']['text']}",
             f"Requires-Python: {p['requires-python']}"]
    lines += [f"Classifier: {c}" for c in p["classifiers"]]
    lines += [f"Requires-Dist: {d}" for d in p["dependencies"]]
    for extra, needed in p["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f"Requires-Dist: {d}; extra == '{extra}'" for d in needed)]
    lines += ["Description-Content-Type: text/markdown", "", (tree.PACKAGE / p["readme"]).read_text(encoding="utf-8")]
    return "\n".join(lines)


def tag():
    """Any Python 3, this platform: the library is reached through ctypes."""
    platform = os.environ.get("DYN_PLATFORM") or sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"py3-none-{platform}"


def write_metadata(folder):
    """Writes libdyn-VERSION.dist-info into a folder; returns its name."""
    info = folder / f"libdyn-{tree.version()}.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(metadata(), encoding="utf-8")
    lines = ["Wheel-Version: 1.0", "Generator: libdyn_build", "Root-Is-Purelib: false", f"Tag: {tag()}", ""]
    (info / "WHEEL").write_text("\n".join(lines), encoding="utf-8")
    return info.name


def notices(folder, prefix):
    """The license, and those of what the installed tree has compiled in (tools/release)."""
    folder.mkdir()
    files = [tree.CHECKOUT / "LICENSE", *sorted((prefix / "share/licenses").glob("*"))]
    for file in files:
        if file.is_file():
            (folder / file.name).write_bytes(file.read_bytes())


def write(root, out, prefix):
    """Adds metadata to a folder, and writes it as a wheel into another; returns the wheel's name."""
    info = root / write_metadata(root)
    notices(info / "licenses", prefix)
    for command, script, text in (("dyn", "dyn", COMMAND), ("dyn.exe", "dyn.bat", BATCH.replace("\n", "\r\n"))):
        if (root / "libdyn/bin" / command).is_file():
            scripts = root / f"libdyn-{tree.version()}.data/scripts"
            scripts.mkdir(parents=True)
            (scripts / script).write_bytes(text.encode("ascii"))
            (scripts / script).chmod(0o755)
    files = sorted(f for f in root.rglob("*") if f.is_file())
    name = f"libdyn-{tree.version()}-{tag()}.whl"
    record = ""
    with zipfile.ZipFile(out / name, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as wheel:
        for file in files:
            path, data = file.relative_to(root).as_posix(), file.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record += f"{path},sha256={digest},{len(data)}\n"
            add(wheel, path, data, os.access(file, os.X_OK))
        path = f"{info.name}/RECORD"
        add(wheel, path, (record + f"{path},,\n").encode(), False)
    return name


def add(wheel, path, data, executable):
    entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))
    entry.compress_type = zipfile.ZIP_DEFLATED
    entry.external_attr = (0o100755 if executable else 0o100644) << 16
    wheel.writestr(entry, data)
