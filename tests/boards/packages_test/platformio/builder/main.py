# A PlatformIO platform for QEMU's mps2-an500, of Debian's compiler (tests/boards/packages). DYN_ROOT: the repository.
import os

from SCons.Script import Default, DefaultEnvironment

env = DefaultEnvironment()
root = os.environ["DYN_ROOT"]
cpu = ["-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-mfloat-abi=hard", "-mthumb"]
env.Replace(AR="arm-none-eabi-gcc-ar", CC="arm-none-eabi-gcc", CXX="arm-none-eabi-g++", RANLIB="arm-none-eabi-gcc-ranlib",
            ARFLAGS=["rc"], PROGSUFFIX=".elf")
env.Append(CCFLAGS=cpu + ["-O2", "-ffunction-sections"], CXXFLAGS=["-std=gnu++20", "-fno-exceptions", "-fno-rtti"],
           CPPDEFINES=[("DYN_TICKS", 25000000)], CPPPATH=[root + "/tools/bare_metal", root + "/tests/boards/packages_test/stubs"],
           LINKFLAGS=cpu + ["-nostdlib", "-Wl,--gc-sections", "-Wl,--fatal-warnings", "-T", "mps2.ld"],
           LIBPATH=[root + "/tools/bare_metal"], LIBS=["c", "m", "gcc"])
Default(env.BuildProgram())
