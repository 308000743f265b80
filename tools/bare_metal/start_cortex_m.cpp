// Reset and exceptions of a Cortex-M with an FPU.
#include <cstdint>

extern "C" {
extern char stack_top[];
void reset();
void start();
void fault();
__attribute__((weak)) void SysTick_Handler() { fault(); }  // a program may define it
}

// the stack, then 15 exceptions of the processor
__attribute__((section(".vectors"), used)) void (*const vectors[16])() = {reinterpret_cast<void (*)()>(stack_top),
                                                                          reset,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          fault,
                                                                          SysTick_Handler};

void reset() {
  volatile std::uint32_t* const access = reinterpret_cast<std::uint32_t*>(0xe000ed88);
  *access = *access | 0xfu << 20;  // the FPU
  __asm volatile("dsb\n isb");
  start();
}
