// Reset and traps of a RISC-V processor in machine mode.
extern "C" {
void start();
void fault();
}

// Semihosting is asked for by these three instructions, within a line of 16 bytes.
__asm(R"(
  .section .text.semihosting, "ax"
  .globl semihosting
  .option push
  .option norvc
  .option norelax
  .balign 16
semihosting:
  slli x0, x0, 0x1f
  ebreak
  srai x0, x0, 7
  ret
  .option pop
)");

// at the beginning of flash; the FPU, where there is one; traps end the program
__asm(R"(
  .section .vectors, "ax"
  .globl vectors, reset
  .option norvc
  .option arch, +zicsr
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
