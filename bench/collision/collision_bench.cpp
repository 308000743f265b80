// Times of distance queries by pair of shapes.   usage: dyn_collision_bench [part of a pair's name]
#include <cmath>
#include <cstdio>
#include <string>

#include "poses.hpp"

int main(int argc, char** argv) {
  using namespace dyn_bench;
  std::printf("%-24s %10s %10s %10s   ns (iterations)\n", "pair", "apart", "near", "penetrating");
  double log_sum[classes] = {};
  int rows = 0;
  for (int a = 0; a < shape::type_count; ++a)
    for (int b = std::max(a, 1); b < shape::type_count; ++b) {
      const std::string name = std::string(name_of(Type(a))) + "-" + name_of(Type(b));
      if (argc > 1 && name.find(argv[1]) == std::string::npos) continue;
      const PairOfShapes pair = make_pair(Type(a), Type(b));
      std::printf("%-24s", name.c_str());
      for (int c = 0; c < classes; ++c) {
        double iterations = 0, sum = 0;
        for (const Scene& s : pair.scenes[c]) iterations += query(s).iterations;
        const double ns = time(pair.scenes[c], [&](const Scene& s) { sum += query(s).distance; });
        std::printf(" %6.0f (%2.0f)", ns + (std::isnan(sum) ? NAN : 0), iterations / poses);
        log_sum[c] += std::log(ns);
      }
      std::printf("\n");
      ++rows;
    }
  std::printf("%-24s", "geometric mean");
  for (double s : log_sum) std::printf(" %6.0f     ", std::exp(s / rows));
  std::printf("\n");
}
