#include "pack.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace cli::page {

static_assert(std::endian::native == std::endian::little, "pages are little-endian");

template <class T>
json Pack::append(const std::vector<T>& x, const char* as) {
  bytes_.resize((bytes_.size() + 3) / 4 * 4);  // typed arrays begin at multiples of their size
  const std::size_t at = bytes_.size();
  bytes_.resize(at + x.size() * sizeof(T));
  if (!x.empty()) std::memcpy(bytes_.data() + at, x.data(), x.size() * sizeof(T));
  return {{"at", at}, {"n", x.size()}, {"as", as}};
}

json Pack::f32(const Vector& x) { return append(std::vector<float>(x.begin(), x.end()), "f32"); }

json Pack::q16(const Vector& x, std::size_t columns) {
  Vector lower(columns, HUGE_VAL), upper(columns, -HUGE_VAL), step;
  for (std::size_t k = 0; k < x.size(); ++k)
    if (std::isfinite(x[k]))
      lower[k % columns] = std::min(lower[k % columns], x[k]), upper[k % columns] = std::max(upper[k % columns], x[k]);
  for (std::size_t c = 0; c < columns; ++c) {
    if (!(lower[c] <= upper[c])) lower[c] = upper[c] = 0;
    step.push_back((upper[c] - lower[c]) / 65535);
  }
  std::vector<std::uint16_t> out;
  out.reserve(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::size_t c = k % columns;
    if (step[c] > 0)
      out.push_back(
          std::isfinite(x[k]) ? static_cast<std::uint16_t>(std::clamp(std::lround((x[k] - lower[c]) / step[c]), 0L, 65535L)) : 0);
  }
  json made = append(out, "q16");
  made["n"] = x.size(), made["lower"] = lower, made["step"] = step;
  return made;
}

json Pack::indices(const std::vector<std::uint32_t>& x) {
  if (std::any_of(x.begin(), x.end(), [](std::uint32_t i) { return i > 65535; })) return append(x, "u32");
  return append(std::vector<std::uint16_t>(x.begin(), x.end()), "u16");
}

std::string Pack::base64() const {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes_.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes_.size(); i += 3) {
    const auto byte = [&](std::size_t k) { return i + k < bytes_.size() ? std::uint32_t{bytes_[i + k]} : 0u; };
    const std::uint32_t word = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (int k = 0; k < 4; ++k) out += i + static_cast<std::size_t>(k) <= bytes_.size() ? digits[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

}  // namespace cli::page
