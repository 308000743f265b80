// The time that memory alone takes from the recursions: reads once and writes once what each of them keeps for a joint, and
// computes nothing.
// usage: dyn_stream JOINTS [SECONDS]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "joint/body.hpp"
#include "base/simd.hpp"
#include "model/block.hpp"
#include "spatial/se3.hpp"

using namespace dyn;

namespace {

using Block = Simd<std::int64_t, 2>;
constexpr std::size_t blocks(std::size_t bytes) { return (bytes + sizeof(Block) - 1) / sizeof(Block); }

constexpr std::size_t placement = sizeof(SE3<double>) + sizeof(Vec3<double>);  // R_WB, p_WB, r
struct Recursion {
  const char* name;
  std::size_t read, written;  // bytes a joint
};
constexpr Recursion recursions[] = {
    {"forward_kinematics", sizeof(SE3<double>) + 8, placement},
    {"rnea", sizeof(SE3<double>) + sizeof(Body) + 3 * 8, placement + sizeof(Force<double>) + 8},
    {"aba", sizeof(SE3<double>) + sizeof(Body) + 3 * 8,
     placement + sizeof(Motion<double>) + sizeof(Inertia<double>) + 2 * sizeof(Force<double>) + 3 * 8},
};

void pass(const Block* in, Block* out, long joints, std::size_t reads, std::size_t writes) {
  Block seen = Block::zero();
  for (long i = 0; i < joints; ++i) {
    for (std::size_t k = 0; k < reads; ++k) seen = seen ^ *in++;
    for (std::size_t k = 0; k < writes; ++k) *out++ = seen;
  }
}

double seconds_now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double best_nanoseconds(const Recursion& r, long joints, double seconds) {
  const std::size_t reads = blocks(r.read), writes = blocks(r.written),
                    bytes = (reads + writes) * sizeof(Block) * std::size_t(joints);
  void* memory = allocate_block(bytes);
  if (!memory) return -1;
  std::memset(memory, 0, bytes);
  Block* in = static_cast<Block*>(memory);
  double best = 1e30;
  for (const double end = seconds_now() + seconds; seconds_now() < end;) {
    const int repeats = 1 + int(100000 / joints);
    const double start = seconds_now();
    for (int k = 0; k < repeats; ++k) {
      pass(in, in + reads * std::size_t(joints), joints, reads, writes);
      asm volatile("" ::: "memory");
    }
    const double each = (seconds_now() - start) / repeats;
    if (each < best) best = each;
  }
  std::free(memory);
  return best * 1e9;
}

}  // namespace

int main(int argc, char** argv) {
  const long joints = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 0;
  const double seconds = argc > 2 ? std::strtod(argv[2], nullptr) : 0.2;
  if (joints < 1 || joints > 10000000 || !(seconds > 0)) return std::fprintf(stderr, "usage: dyn_stream JOINTS [SECONDS]\n"), 2;
  std::printf("{\"rows\":[");
  for (const Recursion& r : recursions)
    std::printf("%s{\"name\":\"%s\",\"bytes\":%zu,\"ns\":%.2f}", &r == recursions ? "" : ",", r.name, r.read + r.written,
                best_nanoseconds(r, joints, seconds));
  std::puts("]}");
}
