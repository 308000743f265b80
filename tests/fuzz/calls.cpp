// Sequences of valid and invalid calls. The bytes choose functions, handles (live, null, freed, of another model) and numbers.
#include "capi/calls.hpp"
#include "fuzz/fuzz.hpp"

using namespace dyn_test;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const Model models[] = {all_types(), chain(3), robot("gripper"), singular_at_zero(true)};
  static const double odd[] = {0,     -0.0,   1,     -1,      1e-310,        4.9e-324,      1e-200,
                               1e100, -1e160, 1e200, 1.7e308, dyn_test::nan, dyn_test::inf, -dyn_test::inf,
                               0.5,   3};
  const uint8_t* const end = bytes + size;
  const auto next = [&] { return bytes < end ? *bytes++ : uint8_t(0); };
  const auto one_of = [&](int n) { return int(next()) % n; };
  const int own = one_of(4);
  dynData *live = nullptr, *other = nullptr, *freed = nullptr;
  if (dyn_data_new(models[own], one_of(2) ? 0 : dynParts(next() | next() << 8) & DYN_PART_ALL, &live) != DYN_OK) return 0;
  dyn_data_new(models[(own + 1) % 4], DYN_PART_KINEMATICS, &other), dyn_data_new(models[own], DYN_PART_KINEMATICS, &freed);
  dyn_data_free(freed);
  for (int calls = 0; bytes < end && calls < 30; ++calls) {
    Prepared p(call_rows[one_of(int(std::size(call_rows)))], models[own], random_state(models[own], next()));
    for (int changes = one_of(4); changes > 0; --changes) {
      Numbers* const arrays[] = {&p.s.q, &p.s.v, &p.s.a, &p.s.tau};
      Numbers& x = *arrays[one_of(4)];
      if (!x.empty()) x[size_t(next()) % x.size()] = odd[one_of(16)];
    }
    if (one_of(8) == 1) p.x.frame = int8_t(next()), p.x.joint = int8_t(next()), p.x.dt = odd[one_of(16)], p.x.mask = next();
    if (one_of(16) == 1) p.x.q = nullptr;
    dynData* const handles[] = {live, live, live, live, live, live, nullptr, other, freed, live};
    const dynStatus s = p(one_of(32) == 31 ? nullptr : models[own].m, handles[one_of(10)]);
    if (s == DYN_ERROR_INTERNAL || s < DYN_OK || s > DYN_ERROR_INTERNAL) std::abort();
    if (s != DYN_OK && !p.untouched()) std::abort();
  }
  dyn_data_free(live), dyn_data_free(other);
  return 0;
}
