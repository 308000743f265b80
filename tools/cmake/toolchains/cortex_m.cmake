# A Cortex-M without an operating system, for the toolchain files that set `processor` flags, and include this one. What is linked, and how, is each
# image's (tests/boards/images.cmake): QEMU's machine, linker scripts of tools/bare_metal, ticks of SysTick a second there.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
# enumerations of dyn.h are int, as everywhere else
set(flags "${processor} -mthumb -fno-short-enums -ffunction-sections -fdata-sections")
set(CMAKE_C_FLAGS_INIT "${flags}")
set(CMAKE_CXX_FLAGS_INIT "${flags} -fno-exceptions -fno-rtti -fno-threadsafe-statics")
set(DYN_START start_cortex_m.cpp)
set(DYN_BOARD_LIBRARIES -Wl,--no-enum-size-warning -lc -lm -lgcc)
