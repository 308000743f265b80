// Simulates all scenes for many steps under changing controls, checks their states, and reports memory and a hash of all states.
//   dyn_soak [--steps N] [--hash] [--scene NAME]
// N steps in all, more of the cheap scenes. --hash: N steps of each scene, printing only the hashes. --scene: one scene alone.
// Exit status 0 only if all states stay in their bounds and, without --hash, memory does not grow.
#include <chrono>
#include <cstring>

#include "soak/simulation.hpp"

namespace {

// Returns the resident memory of the process in pages, but for those of files, which the system takes and gives back.
long resident() {
  long pages = 0, files = 0;
  if (std::FILE* f = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(f, "%*d %ld %ld", &pages, &files) != 2) pages = files = 0;
    std::fclose(f);
  }
  return pages - files;
}

#ifdef __SANITIZE_ADDRESS__
constexpr bool sanitized = true;  // shadow memory counts, too
#else
constexpr bool sanitized = false;
#endif

}  // namespace

int main(int count, char** argument) {
  long steps = 1000000;
  bool hash = false;
  const char* only = nullptr;
  for (int k = 1; k < count; ++k) {
    if (std::strcmp(argument[k], "--hash") == 0) hash = true;
    else if (std::strcmp(argument[k], "--steps") == 0 && k + 1 < count) steps = std::atol(argument[++k]);
    else if (std::strcmp(argument[k], "--scene") == 0 && k + 1 < count) only = argument[++k];
    else return std::fprintf(stderr, "dyn_soak [--steps N] [--hash] [--scene NAME]\n"), 2;
  }
  bool good = true, played = false;
  for (const soak::Scene& scene : soak::scenes) {
    if (only && std::strcmp(only, scene.name) != 0) continue;
    played = true;
    soak::Simulation play(scene);
    const long each = hash ? steps : steps / 100 * scene.share;
    const auto begin = std::chrono::steady_clock::now();
    long pages = 0, grown = 0;
    const char* wrong = nullptr;
    while (play.steps < each && !wrong) {
      if (play.step() != DYN_OK) wrong = dyn_last_error();
      else if (play.steps % 256 == 0) wrong = play.violation();
      if (play.steps == 1) pages = resident();
    }
    grown = resident() - pages;
    if (wrong) std::fprintf(stderr, "%s, step %ld: %s\n", scene.name, play.steps, wrong);
    good =
        good && !wrong &&
        (hash || sanitized || grown <= 256);  // 1 MiB: the kernel counts in batches, and under an emulator its memory counts, too
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (hash) std::printf("%-16s %016llx\n", scene.name, (unsigned long long)play.hash());
    else
      std::printf("%-16s %10ld steps, %6.1f s, %6.2f us a step, %ld pages more, %s\n", scene.name, play.steps, seconds,
                  1e6 * seconds / double(play.steps), grown, wrong ? wrong : "within bounds");
    std::fflush(stdout);
  }
  if (!played) return std::fprintf(stderr, "dyn_soak: no scene is called %s\n", only), 2;
  return good ? 0 : 1;
}
