# A 32-bit RISC-V processor without floating point: doubles are computed by libgcc.
set(CMAKE_SYSTEM_PROCESSOR rv32imac)
set(processor "-march=rv32imac -mabi=ilp32")
set(DYN_QEMU qemu-system-riscv32 -M virt -bios none)
include(${CMAKE_CURRENT_LIST_DIR}/riscv.cmake)
