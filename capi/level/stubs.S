// Every function of dyn.h: a jump to the level that is used, through a slot. A slot leads to dyn_use_level until the function is
// called for the first time. It takes no lock then, and calls nothing once the level is chosen (choose.c).

.macro DYN_STUB name
  .section .text.\name, "ax", @progbits
  .globl \name
  .type \name, @function
  .p2align 4
\name:
  .cfi_startproc
  jmp *slot.\name(%rip)
1:
  leaq slot.\name(%rip), %r11
  jmp dyn_use_level
  .cfi_endproc
  .size \name, . - \name

  .section .data.slot.\name, "aw", @progbits
  .p2align 3
slot.\name:
  .quad 1b
#define LEVEL(level, architecture) .hidden level.\name; .quad level.\name;
#include "levels.inc"
#undef LEVEL
.endm

// %r11: a slot, and behind it the addresses of the function's levels
  .section .text.dyn_use_level, "ax", @progbits
  .hidden dyn_level
  .hidden dyn_choose_level
  .hidden dyn_use_level
  .globl dyn_use_level
  .type dyn_use_level, @function
  .p2align 4
dyn_use_level:
  .cfi_startproc
  movslq dyn_level(%rip), %r10
  testl %r10d, %r10d
  js 2f
1:
  movq 8(%r11, %r10, 8), %r10
  movq %r10, (%r11)
  jmp *%r10
2:  // a call before the library is initialized: arguments are kept
  pushq %rdi
  .cfi_adjust_cfa_offset 8
  pushq %rsi
  .cfi_adjust_cfa_offset 8
  pushq %rdx
  .cfi_adjust_cfa_offset 8
  pushq %rcx
  .cfi_adjust_cfa_offset 8
  pushq %r8
  .cfi_adjust_cfa_offset 8
  pushq %r9
  .cfi_adjust_cfa_offset 8
  pushq %rax
  .cfi_adjust_cfa_offset 8
  pushq %r11
  .cfi_adjust_cfa_offset 8
  subq $136, %rsp
  .cfi_adjust_cfa_offset 136
  movups %xmm0, (%rsp)
  movups %xmm1, 16(%rsp)
  movups %xmm2, 32(%rsp)
  movups %xmm3, 48(%rsp)
  movups %xmm4, 64(%rsp)
  movups %xmm5, 80(%rsp)
  movups %xmm6, 96(%rsp)
  movups %xmm7, 112(%rsp)
  call dyn_choose_level
  movups (%rsp), %xmm0
  movups 16(%rsp), %xmm1
  movups 32(%rsp), %xmm2
  movups 48(%rsp), %xmm3
  movups 64(%rsp), %xmm4
  movups 80(%rsp), %xmm5
  movups 96(%rsp), %xmm6
  movups 112(%rsp), %xmm7
  addq $136, %rsp
  .cfi_adjust_cfa_offset -136
  popq %r11
  .cfi_adjust_cfa_offset -8
  popq %rax
  .cfi_adjust_cfa_offset -8
  popq %r9
  .cfi_adjust_cfa_offset -8
  popq %r8
  .cfi_adjust_cfa_offset -8
  popq %rcx
  .cfi_adjust_cfa_offset -8
  popq %rdx
  .cfi_adjust_cfa_offset -8
  popq %rsi
  .cfi_adjust_cfa_offset -8
  popq %rdi
  .cfi_adjust_cfa_offset -8
  movslq dyn_level(%rip), %r10
  jmp 1b
  .cfi_endproc
  .size dyn_use_level, . - dyn_use_level

#define FUNCTION(name) DYN_STUB name
#include "table/functions.inc"

  .section .note.GNU-stack, "", @progbits
