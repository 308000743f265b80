// Text as it stands in a page: names in robot files are not trusted.
#pragma once

#include <string>

namespace cli::page {

inline std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

}  // namespace cli::page
