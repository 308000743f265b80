#ifndef _WIN32
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "../cli.hpp"
#include "system.hpp"

namespace cli {

bool on_terminal() { return isatty(STDERR_FILENO); }

std::string own_file() {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored).string();
}

std::FILE* open_file(const std::string& path, const char* mode) { return std::fopen(path.c_str(), mode); }

int obstacle_to_write(const std::string& file) { return access(file.c_str(), W_OK) == 0 ? 0 : errno; }
int obstacle_to_make(const std::string& folder) { return access(folder.c_str(), W_OK | X_OK) == 0 ? 0 : errno; }

std::string open_in_browser(const std::string& address) {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value ? value : "");
  };
  const std::string named = variable("BROWSER"), browser = named.empty() ? "xdg-open" : named;
  const bool screen = !(named + variable("DISPLAY") + variable("WAYLAND_DISPLAY")).empty();
  const pid_t child = screen ? fork() : -1;
  if (child == 0) {
    std::signal(SIGPIPE, SIG_DFL);
    if (std::freopen("/dev/null", "w", stdout) && std::freopen("/dev/null", "w", stderr))
      execlp(browser.c_str(), browser.c_str(), address.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  return child > 0 ? browser : "";
}

std::optional<std::string> compute_apart(const std::function<std::string()>& text, double most_s) {
  using Clock = std::chrono::steady_clock;
  int ends[2];
  if (pipe(ends) != 0) fail(std::string("no pipe: ") + std::strerror(errno) + ".");
  const pid_t child = fork();
  if (child < 0) fail(std::string("no process: ") + std::strerror(errno) + ".");
  if (child == 0) {
    const std::string all = text();
    for (std::size_t at = 0; at < all.size();) {
      const ssize_t n = ::write(ends[1], all.data() + at, all.size() - at);
      if (n <= 0) break;
      at += static_cast<std::size_t>(n);
    }
    _exit(0);
  }
  close(ends[1]);
  const auto start = Clock::now();
  std::string out;
  bool late = false;
  for (char part[1 << 14];;) {
    const double left = most_s - std::chrono::duration<double>(Clock::now() - start).count();
    pollfd wait{ends[0], POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(std::clamp(left * 1000, 0.0, 1e9)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) {
      late = true;
      break;
    }
    const ssize_t n = ::read(ends[0], part, sizeof part);
    if (n <= 0) break;
    out.append(part, static_cast<std::size_t>(n));
  }
  close(ends[0]);
  if (late) kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  if (late) return std::nullopt;
  return out;
}

}  // namespace cli
#endif
