// Instructions of this thread in user mode, where the system has a counter for them.
#pragma once

#include <cstdint>
#include <optional>

#if defined(__linux__)
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace cli {

class InstructionCounter {
 public:
#if defined(__linux__)
  InstructionCounter() {
    perf_event_attr attr{};
    attr.size = sizeof attr;
    attr.type = PERF_TYPE_HARDWARE;
    attr.config = PERF_COUNT_HW_INSTRUCTIONS;
    attr.exclude_kernel = attr.exclude_hv = 1;
    file_ = static_cast<int>(syscall(SYS_perf_event_open, &attr, 0, -1, -1, 0));
  }
  ~InstructionCounter() {
    if (file_ >= 0) close(file_);
  }
  // Since the counter was made.
  std::optional<uint64_t> read() const {
    uint64_t value;
    if (file_ < 0 || ::read(file_, &value, sizeof value) != sizeof value) return std::nullopt;
    return value;
  }
#else
  std::optional<uint64_t> read() const { return std::nullopt; }
#endif
  InstructionCounter(const InstructionCounter&) = delete;

 private:
  int file_ = -1;
#if !defined(__linux__)
 public:
  InstructionCounter() = default;
#endif
};

}  // namespace cli
