#ifdef _WIN32
#include <io.h>
#include <unistd.h>
#define NOMINMAX
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
// after windows.h
#include <shellapi.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "../cli.hpp"
#include "system.hpp"

namespace cli {

namespace {
// Of the C library's locale otherwise.
std::filesystem::path utf8_path(const std::string& path) { return std::u8string(path.begin(), path.end()); }
}  // namespace

bool on_terminal() { return _isatty(_fileno(stderr)); }

std::string own_file() {
  std::wstring path(32768, L'\0');
  path.resize(GetModuleFileNameW(nullptr, path.data(), static_cast<DWORD>(path.size())));
  const std::u8string text = std::filesystem::path(path).u8string();
  return std::string(text.begin(), text.end());
}

std::FILE* open_file(const std::string& path, const char* mode) {
  return _wfopen(utf8_path(path).c_str(), std::wstring(mode, mode + std::strlen(mode)).c_str());
}

int obstacle_to_write(const std::string& file) { return _waccess(utf8_path(file).c_str(), W_OK) == 0 ? 0 : errno; }
int obstacle_to_make(const std::string& folder) { return obstacle_to_write(folder); }

std::string open_in_browser(const std::string& address) {
  const auto answer = ShellExecuteA(nullptr, "open", address.c_str(), nullptr, nullptr, SW_SHOWNORMAL);
  return reinterpret_cast<INT_PTR>(answer) > 32 ? "the browser" : "";
}

namespace {
struct Work {
  const std::function<std::string()>& text;
  std::string out;
};
DWORD WINAPI compute(void* argument) {
  Work& work = *static_cast<Work*>(argument);
  work.out = work.text();
  return 0;
}
}  // namespace

// A process cannot be copied here: a thread computes. One that is late is inside a step, which holds no lock.
std::optional<std::string> compute_apart(const std::function<std::string()>& text, double most_s) {
  Work work{text, ""};
  const HANDLE thread = CreateThread(nullptr, 8 << 20, compute, &work, 0, nullptr);
  if (!thread) fail("no thread: error " + std::to_string(GetLastError()) + ".");
  const bool late = WaitForSingleObject(thread, static_cast<DWORD>(std::clamp(most_s * 1000, 0.0, 1e9))) != WAIT_OBJECT_0;
  if (late) TerminateThread(thread, 1);
  CloseHandle(thread);
  if (late) return std::nullopt;
  return work.out;
}

}  // namespace cli
#endif
