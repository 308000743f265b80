# A Cortex-M55 with double precision and vectors of single precision.
set(CMAKE_SYSTEM_PROCESSOR cortex-m55)
set(processor "-mcpu=cortex-m55 -mfloat-abi=hard")
set(DYN_QEMU qemu-system-arm -M mps3-an547)
set(DYN_BOARDS an547)
set(DYN_TICKS 32000000)
include(${CMAKE_CURRENT_LIST_DIR}/cortex_m.cmake)
