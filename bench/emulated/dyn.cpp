// Instructions of libdyn's calls, as dyn_bench --count has them, where an emulator counts and no robot file is read.
//
// usage: dyn_bench MODEL.dynb JOINT ROW...
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "../count.hpp"
#include "../rows.hpp"

namespace {

// The file in memory for good, where an image may lie.
const dynModel* open(const char* path) {
  constexpr std::size_t boundary = 64;
  std::FILE* const file = std::fopen(path, "rb");
  if (!file) std::perror(path), std::exit(1);
  std::fseek(file, 0, SEEK_END);
  const std::size_t size = std::size_t(std::ftell(file));
  std::rewind(file);
  void* const bytes = std::aligned_alloc(boundary, (size + boundary - 1) / boundary * boundary);
  if (!bytes || std::fread(bytes, 1, size, file) != size) std::fprintf(stderr, "%s: cannot be read\n", path), std::exit(1);
  std::fclose(file);
  const dynModel* m = nullptr;
  bench::require(dyn_model_from_buffer(bytes, size, &m));
  return m;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) std::fprintf(stderr, "usage: dyn_bench MODEL.dynb JOINT ROW...\n"), std::exit(2);
  bench::Robot robot(open(argv[1]), argv[2]);
  std::printf("{\"nq\":%d,\"nv\":%d,\"rows\":[", robot.nq, robot.nv);
  const char* separator = "\n";
  for (bench::Row& row : robot.rows) {
    if (std::find(argv + 3, argv + argc, row.name) == argv + argc) continue;
    if (row.prepare) row.prepare();
    for (int k = 0; k < bench::states; ++k) row.call(k);
    std::printf("%s{\"name\":\"%s\",\"instructions\":%ld}", separator, row.name.c_str(), bench::instructions([&] { row.call(0); }));
    separator = ",\n";
  }
  std::printf("]}\n");
}
