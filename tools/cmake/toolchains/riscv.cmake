# A RISC-V processor without an operating system, for the toolchain files that set `processor` flags, and include this one.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_C_COMPILER riscv64-unknown-elf-gcc)
set(CMAKE_CXX_COMPILER riscv64-unknown-elf-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(flags "--specs=picolibc.specs ${processor} -mcmodel=medany -ffunction-sections -fdata-sections")
# Debian has no C++ headers for this compiler. Those for ARM are of the same version, and nothing of the C++ library is linked.
file(GLOB headers /usr/lib/arm-none-eabi/include/c++/12.*)
set(CMAKE_C_FLAGS_INIT "${flags}")
set(CMAKE_CXX_FLAGS_INIT "${flags} -nostdinc++ -isystem ${headers} -isystem ${headers}/arm-none-eabi -fno-exceptions -fno-rtti -fno-threadsafe-statics")
set(DYN_BOARDS virt)
set(DYN_START start_riscv.cpp)
set(DYN_BOARD_LIBRARIES -lc -lm -lgcc)
set(DYN_TICKS 1000000)  # not used: instructions are counted
