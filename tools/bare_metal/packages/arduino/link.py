# PlatformIO: links the archive of the board's processor and floating point. A Cortex-M7 with single precision runs that of a Cortex-M4.
import os

Import("env")  # noqa: F821

flags = [str(f) for key in ("ASFLAGS", "CCFLAGS", "LINKFLAGS") for f in env.get(key, [])]  # noqa: F821
processor = next((f.split("=")[1] for f in flags if f.startswith("-mcpu=")), "").split("+")[0]
fpu = next((f.split("=")[1] for f in flags if f.startswith("-mfpu=")), "auto")
folders = [os.path.join(processor, fpu + "-hard")]
if processor in ("cortex-m4", "cortex-m7") and "-sp-" in fpu:
    folders.append("cortex-m4/fpv4-sp-d16-hard")
found = [f for f in (os.path.join(os.getcwd(), "src", f) for f in folders) if os.path.isdir(f)]
if "-mfloat-abi=hard" not in flags or not found:
    raise SystemExit(f"libdyn has no archive for {processor or 'this processor'} with {fpu}: see its README.md")
env.Append(LIBPATH=found[:1], LIBS=["dyn"], LINKFLAGS=["-Wl,--no-enum-size-warning"])  # noqa: F821
