#include "budget.hpp"

#include <ctime>

namespace dyn::load {

namespace {

constexpr int charges_between_checks = 64;  // of the clock

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

}  // namespace

Budget::Budget(const LoadLimits& limits)
    : limit_seconds_(limits.seconds),
      begin_(thread_seconds()),
      bytes_{"bytes of memory, by estimate", "max_bytes", limits.bytes, 0},
      bodies_{"bodies", "max_bodies", limits.bodies, bytes_of_body},
      joints_{"joints", "max_bodies", limits.bodies, bytes_of_joint},
      shapes_{"shapes", "max_shapes", limits.shapes, bytes_of_shape},
      rows_{"rows of constraints", "max_constraint_rows", limits.rows, 0},
      keys_{"named configurations", "max_keys", limits.keys, bytes_of_part} {}

void Budget::add(Account& a, std::int64_t n, const Report& report, int line) {
  if (n > a.limit - a.used)
    report.fail(DYN_ERROR_LIMIT, line,
                "it asks for more than " + std::to_string(a.limit) + " " + a.what + ", which is the limit: raise " + a.option +
                    " if the file is trusted");
  a.used += n;
  if (a.bytes_each) add(bytes_, n * a.bytes_each, report, line);
  if (until_check_-- <= 0) check_time(report, line);
}

void Budget::check_time(const Report& report, int line) {
  until_check_ = charges_between_checks;
  if (thread_seconds() - begin_ > limit_seconds_)
    report.fail(
        DYN_ERROR_LIMIT, line,
        "loading takes more than " + text(limit_seconds_) + " s of processor time, which is the limit: raise max_seconds");
}

}  // namespace dyn::load
