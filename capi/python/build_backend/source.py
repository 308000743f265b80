"""The source distribution: every file of the checkout, with pyproject.toml at its top, so that pip builds from it."""

import gzip
import io
import subprocess
import tarfile

import tree
import wheel_file

IGNORED = ("__pycache__", ".git", "build")


def files():
    """Paths in the checkout: what Git knows, or, unpacked from such an archive, all."""
    listed = subprocess.run(["git", "-C", tree.CHECKOUT, "ls-files", "-z"], capture_output=True, text=True)
    if listed.returncode == 0 and (tree.CHECKOUT / ".git").exists():
        return sorted(name for name in listed.stdout.split("\0") if name and (tree.CHECKOUT / name).is_file())
    every = (f.relative_to(tree.CHECKOUT) for f in tree.CHECKOUT.rglob("*") if f.is_file())
    kept = (f.as_posix() for f in every if not set(f.parts) & set(IGNORED))
    return sorted(name for name in kept if name not in ("PKG-INFO", "pyproject.toml"))  # those at the top


def write(out):
    """Writes the archive into a folder; returns its name."""
    if not (tree.CHECKOUT / "CMakeLists.txt").is_file():
        raise SystemExit("libdyn's sources are not beside this package: make the source distribution in a checkout.")
    root = f"libdyn-{tree.version()}"
    name = f"{root}.tar.gz"
    top = (tree.PACKAGE / "pyproject.toml").read_text(encoding="utf-8")
    top = top.replace('backend-path = ["build_backend"]', 'backend-path = ["capi/python/build_backend"]')
    top = top.replace('readme = "README.md"', 'readme = "capi/python/README.md"')
    made = {"PKG-INFO": wheel_file.metadata().encode(), "pyproject.toml": top.encode()}
    with open(out / name, "wb") as file, gzip.GzipFile("", "wb", fileobj=file, mtime=0) as packed:
        with tarfile.open(fileobj=packed, mode="w") as archive:
            for path in files():
                full = tree.CHECKOUT / path
                add(archive, f"{root}/{path}", full.read_bytes(), full.stat().st_mode & 0o100)
            for path, data in made.items():
                add(archive, f"{root}/{path}", data, 0)
    return name


def add(archive, path, data, executable):
    entry = tarfile.TarInfo(path)
    entry.size, entry.mode = len(data), 0o755 if executable else 0o644
    archive.addfile(entry, io.BytesIO(data))
