// The account of one load: what a file has asked for so far, by LoadLimits. A loader charges it before it makes something, so
// that what a short file asks for in many copies is refused before it is there.
#pragma once

#include "report.hpp"

namespace dyn::load {

// Estimates of memory in bytes, from measured peaks.
inline constexpr std::int64_t bytes_of_body = 1500, bytes_of_joint = 1500, bytes_of_shape = 1500, bytes_of_part = 2500,
                              bytes_of_visit = 100, bytes_of_element = 200, bytes_of_attribute = 90, bytes_of_vertex = 80,
                              bytes_of_triangle = 80, bytes_of_mesh_file = 2, bytes_of_height = 60;

class Budget {
 public:
  explicit Budget(const LoadLimits& limits);

  // Throws DYN_ERROR_LIMIT at a line of the report where there are more than the limit with n more.
  void add_bodies(std::int64_t n, const Report& report, int line) { add(bodies_, n, report, line); }
  void add_joints(std::int64_t n, const Report& report, int line) { add(joints_, n, report, line); }
  void add_shapes(std::int64_t n, const Report& report, int line) { add(shapes_, n, report, line); }
  void add_rows(std::int64_t n, const Report& report, int line) { add(rows_, n, report, line); }
  void add_keys(std::int64_t n, const Report& report, int line) { add(keys_, n, report, line); }
  void add_bytes(std::int64_t n, const Report& report, int line) { add(bytes_, n, report, line); }

 private:
  struct Account {
    const char *what, *option;
    std::int64_t limit, bytes_each, used = 0;
  };
  void add(Account& a, std::int64_t n, const Report& report, int line);
  void check_time(const Report& report, int line);

  double limit_seconds_, begin_;
  int until_check_ = 0;
  Account bytes_, bodies_, joints_, shapes_, rows_, keys_;
};

}  // namespace dyn::load
