// The part of Zephyr that samples/gravity uses is zephyr/sys/printk.h (tests/boards/packages).
