// Words of a text, one after the other, with the line of the last one. No copies: a text may be large.
#pragma once

#include <algorithm>
#include <string_view>

namespace dyn::load {

class Words {
 public:
  explicit Words(std::string_view text, int first_line = 1) : text_(text), line_(first_line) {}

  int line() const { return line_; }
  // Returns the next word, "" at the end.
  std::string_view next() {
    skip_space();
    const std::size_t from = at_;
    while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
    return text_.substr(from, at_ - from);
  }
  // Skips the rest of the line.
  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }
  void skip_space() {
    for (; at_ < text_.size() && is_space(text_[at_]); ++at_) line_ += text_[at_] == '\n';
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_;
};

}  // namespace dyn::load
