# A Cortex-M7 with double precision.
set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(processor "-mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard")
set(DYN_QEMU qemu-system-arm -M mps2-an500)
set(DYN_BOARDS mps2 stm32h743)
set(DYN_TICKS 25000000)
include(${CMAKE_CURRENT_LIST_DIR}/cortex_m.cmake)
