#include "page.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "../system/system.hpp"

namespace cli::page {

namespace {

constexpr std::string_view marker = "<!--dyn:data-->";

// JSON that may stand in a <script>: "<" only as an escape, so that no name ends it.
std::string in_script(const json& head) {
  std::string out;
  for (const char c : head.dump(-1, ' ', false, json::error_handler_t::replace)) out += c == '<' ? "\\u003c" : std::string(1, c);
  return out;
}

}  // namespace

std::string page_template() {
  const std::filesystem::path command = own_file();
  const std::filesystem::path path = (command.parent_path() / DYN_VIEWER_FROM_BIN).lexically_normal();
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file || text.str().find(marker) == std::string::npos)
    fail("there is no page to fill: " + path.string() +
         " is missing. It is made when libdyn is built with npm and a network, or with Debian's packages: apt-get install "
         "esbuild libjs-three libjs-dygraphs; then build again.");
  return text.str();
}

std::string filled(const std::string& page, const json& head, const Pack& pack) {
  const std::size_t at = page.find(marker);
  return page.substr(0, at) + "<script type=\"application/json\" id=\"dyn-head\">" + in_script(head) +
         "</script>\n<script type=\"text/plain\" id=\"dyn-numbers\">" + pack.base64() + "</script>" +
         page.substr(at + marker.size());
}

void write_file(const std::string& path, const std::string& text) {
  errno = 0;
  std::FILE* file = open_file(path, "wb");
  const bool good = file && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if ((file && std::fclose(file) != 0) || !good) fail(path + ": cannot be written: " + std::strerror(errno) + ".");
}

}  // namespace cli::page
