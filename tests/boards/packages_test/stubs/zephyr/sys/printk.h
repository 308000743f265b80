/* printk of samples/gravity for QEMU (tests/boards/packages): main.cpp has it. */
void printk(const char* format, ...);
