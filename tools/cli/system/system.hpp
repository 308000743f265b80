// What systems call differently: terminals, processes, the command's own file. posix.cpp and windows.cpp define it.
#pragma once

#include <cstdio>
#include <functional>
#include <optional>
#include <string>

namespace cli {

// Standard error is one.
bool on_terminal();
// Path of the running command; "": unknown.
std::string own_file();
// std::fopen of a path in UTF-8.
std::FILE* open_file(const std::string& path, const char* mode);
// Why a file that is there cannot be written, or why none can be made in the folder, as errno says it; 0: it can.
int obstacle_to_write(const std::string& file);
int obstacle_to_make(const std::string& folder);
// Opens the address in a browser. Returns the program that does; "": there is neither a screen nor $BROWSER.
std::string open_in_browser(const std::string& address);
// What text() returns, computed apart; nothing if it is not there after most_s seconds, when what computes it is ended. Where a
// process computes it that ends early, the text is cut.
std::optional<std::string> compute_apart(const std::function<std::string()>& text, double most_s);

}  // namespace cli
