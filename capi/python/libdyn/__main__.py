"""What a compiler needs to know of the package, or the command dyn.

    cc robot.c $(python3 -m libdyn --cflags --libs)            C and C++ programs
    cmake -S . -B build -Ddyn_DIR=$(python3 -m libdyn --cmake)  find_package(dyn), target dyn::dyn
    python3 -m libdyn --models                                  folder of robots and scenes
    python3 -m libdyn info robot.urdf --fixed                   the command dyn
"""

import os
import subprocess
import sys

from . import files


def _flags(words: list[str]) -> str:
    folder = files.library_folder()
    options = {
        "--cflags": lambda: f"-I{files.include()}",
        "--libs": lambda: f"-L{folder} -Wl,-rpath,{folder} -ldyn",
        "--cmake": lambda: str(folder / "cmake/dyn"),
        "--models": lambda: str(files.models),
    }
    unknown = [w for w in words if w not in options]
    if unknown:
        raise SystemExit(f"python -m libdyn: {unknown[0]} is none of {', '.join(options)}; these stand alone.")
    return " ".join(options[w]() for w in words)


def main() -> None:
    words = sys.argv[1:]
    if words and words[0] in ("--cflags", "--libs", "--cmake", "--models"):
        print(_flags(words))
        return
    command = [files.command(), *words]
    if os.name == "nt":  # where execv returns to the caller at once
        raise SystemExit(subprocess.run(command, check=False).returncode)
    os.execv(command[0], command)


if __name__ == "__main__":
    main()
