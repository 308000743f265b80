// Verdicts, and the page that shows them.
#pragma once

#include "case.hpp"

namespace cli::stress {

struct Verdict {
  const Case* c;
  Outcome outcome;
  double wall_s;
  bool passed;
  std::string failure;  // the library's sentence, when it refused
  // The number that is most off, as it should be and as it is.
  std::string shown_reference() const;
  std::string shown_result() const;
};

void write_page(const std::string& path, const std::vector<Verdict>& verdicts);

}  // namespace cli::stress
