# A 64-bit RISC-V processor with double precision.
set(CMAKE_SYSTEM_PROCESSOR rv64gc)
set(processor "-march=rv64gc -mabi=lp64d")
set(DYN_QEMU qemu-system-riscv64 -M virt -bios none)
include(${CMAKE_CURRENT_LIST_DIR}/riscv.cmake)
