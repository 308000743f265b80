// Instructions of a step, scene by scene: name, libdyn's, and those of the bare recursion where there is one. See
// bench/effects.py.
#include <fstream>

#include "scenes.hpp"

int main(int argc, char** argv) {
  using namespace bench;
  struct {
    const char* name;
    std::string text;
  } scenes[] = {
      {"free body, no gravity", scene(free_body(masked), "0 0 0")},
      {"free body", scene(free_body(masked))},
      {"chain of 10", scene(chain(10, "", masked))},
      {"chain of 10, 10 inactive limits", scene(chain(10, limited, masked))},
      {"chain of 10, damping", scene(chain(10, damped, masked))},
      {"chain of 10, 1 far static box", scene(chain(10, "", touching) + far_boxes(1))},
      {"chain of 10, 100 far static boxes", scene(chain(10, "", touching) + far_boxes(100))},
      {"chain of 10, 900 far static boxes", scene(chain(10, "", touching) + far_boxes(900))},
      {"chain of 10, box within reach",
       scene(chain(10, "", touching) + "<geom type='box' contype='0' conaffinity='1' size='.1 .1 .1' pos='0 0 1'/>")},
  };
  int file = 0;
  for (const auto& s : scenes) {
    if (argc > 1) std::ofstream(std::string(argv[1]) + "/" + std::to_string(file++) + ".xml") << s.text;
    Counted c(s.text);
    const long step = c.step(), bare = c.error.empty() ? c.bare() : -1;
    if (!c.error.empty()) return std::fprintf(stderr, "%s: %s\n", s.name, c.error.c_str()), 1;
    std::printf("%s\t%ld\t%ld\n", s.name, step, bare);
  }
}
