#!/usr/bin/env python3
"""Build pinocchio_bench against the headers of the PyPI wheel 'pin'.

Usage:  build_pinocchio.py [--venv DIR] [--out DIR] [--pin-version V] [--eigen DIR]
                           [--jobs N] [--force] [--timeout S] [--aarch64]

  --venv DIR     Python environment that holds the wheels (default: build/peers under the project).
                 Created, and pin, mujoco, example-robot-data and matplotlib installed in it, when missing.
  --out DIR      where the executables go (default: build/peers-bin under the project)
  --pin-version  version of pin to install when it is missing (default 4.1.0; '' for the newest)
  --eigen DIR    Eigen's include directory. Default: the one of the wheel cmeel-eigen, which
                 Pinocchio's own wheel is built with, installed under OUT/eigen; without network,
                 the system's /usr/include/eigen3.
  --jobs N       compilations at the same time (default 1)
  --force        rebuild even if nothing changed
  --aarch64      instead, into OUT/aarch64: for ARM Linux by cross compilers (aarch64-linux-gnu-g++, clang++), with -O3;
                 --count there takes qemu-aarch64 with the plugin tests/boards/linux/instructions.c

Compilers: g++ and clang++ (override with the environment variables GXX and CLANGXX), each with
-O3, -O3 -march=native and, on x86-64, -O3 -march=x86-64-v3; a compiler that is missing is skipped with a message. Prints the
path of each executable on stdout, one per line. Exit status 0 if at least one was built.
The executables link nothing from the environment.
"""
import argparse
import concurrent.futures
import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parent.parent
SOURCES = [*sorted(HERE.glob("pinocchio_*.cpp")), HERE.parent / "count.cpp"]
HEADERS = sorted(HERE.glob("pinocchio_*.hpp"))
# What Pinocchio's CMake target pinocchio_headers defines.
DEFINES = [
    "-DNDEBUG",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
]
COMPILERS = [("clang", os.environ.get("CLANGXX", "clang++")), ("gcc", os.environ.get("GXX", "g++"))]
FLAGS = [("O3", ["-O3"]), ("O3-native", ["-O3", "-march=native"])]
if platform.machine() == "x86_64":
    FLAGS.append(("O3-v3", ["-O3", "-march=x86-64-v3"]))


AARCH64_SOURCES = [*SOURCES[:-1], HERE.parent / "emulated/count.cpp"]
AARCH64_COMPILERS = [("clang", os.environ.get("CLANGXX", "clang++")), ("gcc", "aarch64-linux-gnu-g++")]
AARCH64_FLAGS = {"clang": ["--target=aarch64-linux-gnu", "-O3"], "gcc": ["-O3"]}


def say(text):
    print(text, file=sys.stderr, flush=True)


def die(text):
    sys.exit("build_pinocchio: " + text)


def find_prefix(venv):
    """The cmeel.prefix directory of the environment that holds Pinocchio's headers, or None."""
    for prefix in sorted(venv.glob("lib*/python*/site-packages/cmeel.prefix")):
        if (prefix / "include/pinocchio/config.hpp").is_file():
            return prefix
    return None


def make_venv(venv, pin_version):
    python = venv / "bin/python"
    if not python.exists():
        say(f"creating the environment {venv}")
        if subprocess.run([sys.executable, "-m", "venv", str(venv)]).returncode:
            die(f"cannot create {venv} (on Debian: apt install python3-venv)")
    probe = ("import importlib.metadata as m,sys\n"
             "for n in sys.argv[1:]:\n"
             "  try: m.version(n)\n"
             "  except m.PackageNotFoundError: print(n)")
    wanted = ["pin", "mujoco", "example-robot-data", "matplotlib"]
    run = subprocess.run([str(python), "-c", probe] + wanted, capture_output=True, text=True)
    if run.returncode:
        die(f"{python} does not work:\n{run.stderr}")
    missing = run.stdout.split()
    if missing:
        specs = [f"pin=={pin_version}" if n == "pin" and pin_version else n for n in missing]
        say("installing " + " ".join(specs))
        if subprocess.run([str(python), "-m", "pip", "install", "--quiet",
                           "--disable-pip-version-check"] + specs, stdout=sys.stderr).returncode:
            die("pip could not install " + " ".join(specs))
    return python


def find_eigen(given, python, prefix, out):
    def good(path):
        return (path / "Eigen/Core").is_file() and (path / "unsupported/Eigen/CXX11/Tensor").is_file()

    if given:
        if not good(given):
            die(f"{given} holds no Eigen (Eigen/Core and unsupported/ expected)")
        return given
    local = out / "eigen"
    candidates = [prefix / "include/eigen3", local / "cmeel.prefix/include/eigen3"]
    for path in candidates:
        if good(path):
            return path
    say("installing the headers of cmeel-eigen under " + str(local))
    subprocess.run([str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check",
                    "--no-deps", "--target", str(local), "cmeel-eigen"], stdout=sys.stderr)
    if good(candidates[1]):
        return candidates[1]
    system = Path("/usr/include/eigen3")
    if good(system):
        say("cmeel-eigen is not available, using " + str(system))
        return system
    die("no Eigen: neither cmeel-eigen from PyPI nor /usr/include/eigen3; give --eigen DIR")


def run_compiler(command, timeout):
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        raise RuntimeError(f"more than {timeout} s: {shlex.join(command)}")
    if done.returncode:
        raise RuntimeError(f"failed: {shlex.join(command)}\n{done.stderr[-4000:]}")


def build(name, compiler, flags, sources, includes, out, args, version):
    exe = out / f"pinocchio_bench_{name}"
    objects = out / "obj"
    objects.mkdir(parents=True, exist_ok=True)
    common = [compiler, "-std=c++17", "-w"] + flags + DEFINES + includes
    common.append('-DBENCH_FLAGS="' + " ".join(flags) + '"')
    compiler_id = subprocess.run([compiler, "--version"], capture_output=True, text=True).stdout
    # -march=native depends on the processor.
    native = ""
    if "-march=native" in flags:
        native = subprocess.run([compiler, "-march=native", "-E", "-dM", "-x", "c", "/dev/null"],
                                capture_output=True, text=True).stdout
    shared = [f.read_text() for f in HEADERS] + [shlex.join(common), compiler_id, native, version]
    start = time.time()
    longest = 0.0
    files = []
    for source in sources:
        key = hashlib.sha256("\0".join([source.read_text()] + shared).encode()).hexdigest()
        obj, stamp = (objects / f"{name}_{source.stem}.{end}" for end in ("o", "key"))
        files.append(str(obj))
        if not args.force and obj.is_file() and stamp.is_file() and stamp.read_text() == key:
            continue
        t = time.time()
        run_compiler(common + ["-c", str(source), "-o", str(obj)], args.timeout)
        longest = max(longest, time.time() - t)
        stamp.write_text(key)
    if not longest and exe.is_file() and exe.stat().st_mtime >= max(os.path.getmtime(f) for f in files):
        say(f"{name}: up to date")
        return exe
    run_compiler([compiler] + flags + files + ["-o", str(exe)], args.timeout)
    say(f"{name}: built in {time.time() - start:.0f} s (longest compilation {longest:.0f} s)")
    return exe


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    p.add_argument("--venv", type=Path, default=PROJECT / "build/peers")
    p.add_argument("--out", type=Path, default=PROJECT / "build/peers-bin")
    p.add_argument("--pin-version", default="4.1.0")
    p.add_argument("--eigen", type=Path)
    p.add_argument("--jobs", type=int, default=1)
    p.add_argument("--force", action="store_true")
    p.add_argument("--timeout", type=float, default=1800, help="seconds per compilation")
    p.add_argument("--aarch64", action="store_true")
    args = p.parse_args()

    compilers = AARCH64_COMPILERS if args.aarch64 else COMPILERS
    found = [(n, c) for n, c in compilers if shutil.which(c)]
    for n, c in compilers:
        if not shutil.which(c):
            say(f"compiler '{c}' not found: its builds are skipped")
    if not found:
        die("no C++ compiler found (g++ or clang++)")

    venv = args.venv.resolve()
    out = args.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    python = make_venv(venv, args.pin_version)
    prefix = find_prefix(venv)
    if prefix is None:
        die(f"no Pinocchio headers under {venv}: the wheel 'pin' with its headers is needed "
            "(packages pin and libpinocchio)")
    version = next(line.split('"')[1] for line in
                   (prefix / "include/pinocchio/config.hpp").read_text().splitlines()
                   if "define PINOCCHIO_VERSION " in line)
    if int(version.split(".")[0]) < 4:
        die(f"Pinocchio {version} found, 4.x expected")
    eigen = find_eigen(args.eigen, python, prefix, out)
    say(f"Pinocchio {version}, Eigen in {eigen}")
    builds = [(f"{n}_{f}", c, flags, SOURCES) for n, c in found for f, flags in FLAGS]
    if args.aarch64:
        out = out / "aarch64"
        builds = [(f"{n}_O3", c, AARCH64_FLAGS[n], AARCH64_SOURCES) for n, c in found]
    includes = ["-isystem", str(eigen), "-isystem", str(prefix / "include")]

    built = []
    with concurrent.futures.ThreadPoolExecutor(max(1, args.jobs)) as pool:
        jobs = [(b[0], pool.submit(build, *b, includes, out, args, version)) for b in builds]
        for name, job in jobs:
            try:
                built.append(job.result())
            except RuntimeError as e:
                say(f"{name}: {e}")
    for exe in built:
        print(exe)
    if not built:
        die("nothing was built")


if __name__ == "__main__":
    main()
