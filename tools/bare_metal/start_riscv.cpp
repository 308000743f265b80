// Reset and traps of a RISC-V processor in machine mode.
extern "C" {
void start();
void fault();
}

// at the beginning of flash; the FPU, where there is one; traps end the program
__asm(R"(
  .section .vectors, "ax"
  .globl vectors, reset
  .option norvc
vectors:
reset:
  .option push
  .option norelax
  la gp, __global_pointer$
  .option pop
  la sp, stack_top
  la t0, fault
  csrw mtvec, t0
  li t0, 0x2000
  csrs mstatus, t0
  tail start
)");
