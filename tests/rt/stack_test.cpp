// Tests that the stack of every entry point is bounded, and that no page is missing after dyn_data_warm_up.
#include <link.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "rt/work.hpp"

namespace dyn_test {
namespace {

// How far down the stack f goes: on a painted one of its own.
std::size_t stack_of(const std::function<void()>& f) {
  constexpr std::size_t size = 1 << 20;
  constexpr unsigned char paint = 0xc5;
  unsigned char* const memory = static_cast<unsigned char*>(std::aligned_alloc(4096, size));
  std::memset(memory, paint, size);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes), pthread_attr_setstack(&attributes, memory, size);
  pthread_t thread;
  EXPECT_EQ(0, pthread_create(
                   &thread, &attributes,
                   [](void* work) -> void* { return (*static_cast<const std::function<void()>*>(work))(), nullptr; },
                   const_cast<std::function<void()>*>(&f)));
  pthread_join(thread, nullptr), pthread_attr_destroy(&attributes);
  std::size_t untouched = 0;
  while (untouched < size && memory[untouched] == paint) ++untouched;
  std::free(memory);
  return size - untouched;
}

// Every entry point stays within 128 KiB, of which dyn_data_warm_up touches all; printed with what a thread takes that does
// nothing.
TEST(Stack, IsBounded) {
  if (sanitized) GTEST_SKIP() << "sanitizers make frames larger";
  const std::size_t nothing = stack_of([] {});
  std::size_t most = 0;
  std::string where;
  for (const Robot& r : robots()) {
    Work work(r.m);
    for (const Ready& c : work.calls) {
      if (c.name.starts_with("dyn_data_warm_up")) continue;  // which takes what it touches
      const std::size_t bytes = stack_of(c.call) - nothing;
      if (bytes > most) most = bytes, where = std::string(r.name) + ": " + c.name;
    }
  }
  const Surfaces surfaces;
  const std::vector<dynGeometry> shapes = shapes_of(surfaces);
  const double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, Y[12] = {0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1, 0.05, 0.02, 0.3},
               motion[6] = {0.1, 0, -1, 0, 0.2, 0};
  for (const dynGeometry& a : shapes)
    for (const dynGeometry& b : shapes) {
      dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
      dynDistance d{};
      dynImpact impact{};
      d.struct_size = sizeof d, impact.struct_size = sizeof impact;
      int count = 0;
      const std::pair<const char*, std::function<void()>> queries[] = {
          {"dyn_geometry_distance", [&] { dyn_geometry_distance(&a, X, &b, Y, nullptr, &d); }},
          {"dyn_geometry_contacts",
           [&] { dyn_geometry_contacts(with<dynGeometryPair>({0, &a, &b, X, Y, nullptr, nullptr}), 0.05, 0, contacts, &count); }},
          {"dyn_geometry_sweep",
           [&] { dyn_geometry_sweep(with<dynGeometryPair>({0, &a, &b, X, Y, nullptr, motion}), 1, 0, &impact); }}};
      for (const auto& [name, query] : queries)
        if (const std::size_t bytes = stack_of(query) - nothing; bytes > most)
          most = bytes, where = std::string(name) + ", types " + std::to_string(a.type) + " and " + std::to_string(b.type);
    }
  std::printf("stack: %zu bytes at most, %s (a thread itself: %zu)\n", most, where.c_str(), nothing);
  EXPECT_LE(most, std::size_t(128) << 10);
  EXPECT_GT(most, std::size_t(1) << 10);
}

// The pages of the library's code are no longer mapped, as before its first use.
void forget_library() {
  dl_iterate_phdr([](dl_phdr_info* info, std::size_t, void*) {
    if (!std::strstr(info->dlpi_name, "libdyn.so")) return 0;
    for (int k = 0; k < info->dlpi_phnum; ++k)
      if (const auto& s = info->dlpi_phdr[k]; s.p_type == PT_LOAD && (s.p_flags & PF_X) && !(s.p_flags & PF_W)) {
        const std::uintptr_t from = (std::uintptr_t(info->dlpi_addr) + s.p_vaddr) / 4096 * 4096;
        madvise(reinterpret_cast<void*>(from), s.p_memsz, MADV_DONTNEED);
      }
    return 1;
  }, nullptr);
}

// The first calls on a new data after dyn_data_warm_up wait for no page of memory; without it they do.
TEST(Warmup, NoPageIsMissingAfterIt) {
  if (sanitized) GTEST_SKIP() << "sanitizers touch memory of their own";
  const Model m = robot("humanoid", DYN_BASE_FLOATING);
  const auto faults = [&](bool warm) {
    Data d(m);
    forget_library();
    if (warm) {
      EXPECT_EQ(DYN_OK, dyn_data_warm_up(m, d)) << dyn_last_error();
    }
    rusage before{}, after{};
    getrusage(RUSAGE_THREAD, &before), getrusage(RUSAGE_THREAD, &before);
    dyn_rnea(m, d, nullptr, nullptr, nullptr, nullptr, nullptr),
        dyn_aba_derivatives(m, d, nullptr, nullptr, nullptr, nullptr, nullptr);
    for (int k = 0; k < 5; ++k) dyn_step(m, d);
    dyn_rnea(m, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr);
    getrusage(RUSAGE_THREAD, &after);
    return after.ru_minflt - before.ru_minflt;
  };
  EXPECT_GT(faults(false), 0);
  EXPECT_EQ(0, faults(true));
}

}  // namespace
}  // namespace dyn_test
