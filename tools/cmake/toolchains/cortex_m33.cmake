# A Cortex-M33 with single precision: doubles are computed by libgcc.
set(CMAKE_SYSTEM_PROCESSOR cortex-m33)
set(processor "-mcpu=cortex-m33 -mfpu=fpv5-sp-d16 -mfloat-abi=hard")
set(DYN_QEMU qemu-system-arm -M mps2-an505)
set(DYN_BOARDS an505)
set(DYN_TICKS 20000000)
include(${CMAKE_CURRENT_LIST_DIR}/cortex_m.cmake)
