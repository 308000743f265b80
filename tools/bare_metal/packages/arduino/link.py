# PlatformIO: links the archive of the board's processor and floating point.
import os

Import("env")  # noqa: F821

flags = [str(f) for key in ("ASFLAGS", "CCFLAGS", "LINKFLAGS") for f in env.get(key, [])]  # noqa: F821
processor = next((f.split("=")[1] for f in flags if f.startswith("-mcpu=")), "").split("+")[0]
fpu = next((f.split("=")[1] for f in flags if f.startswith("-mfpu=")), "auto")
folder = os.path.join(os.getcwd(), "src", processor, fpu + "-hard")
if "-mfloat-abi=hard" not in flags or not os.path.isdir(folder):
    raise SystemExit(f"libdyn has no archive for {processor or 'this processor'} with {fpu}: see its README.md")
env.Append(LIBPATH=[folder], LIBS=["dyn"])  # noqa: F821
