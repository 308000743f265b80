# A Cortex-M4 with single precision: doubles are computed by libgcc.
set(CMAKE_SYSTEM_PROCESSOR cortex-m4f)
set(processor "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard")
set(DYN_QEMU qemu-system-arm -M mps2-an386)
set(DYN_BOARDS an386)
set(DYN_TICKS 25000000)
include(${CMAKE_CURRENT_LIST_DIR}/cortex_m.cmake)
