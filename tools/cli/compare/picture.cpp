#include "picture.hpp"

#include <algorithm>
#include <cmath>

#include "../page/markup.hpp"

namespace cli::compare {

namespace {

constexpr std::size_t most_causes = 3;
constexpr double floor_of = 1e-14;  // m, rad: what is smaller is drawn there

}  // namespace

std::string picture(const Comparison& c) {
  constexpr int width = 720, height = 380, left = 60, right = 190, top = 14, bottom = 40;
  constexpr const char* colours[] = {"#2ca02c", "#9467bd", "#ff7f0e"};
  struct Line {
    std::string name, colour, dash;
    const Vector* y;
  };
  std::vector<Line> lines = {{"divergence", "#d62728", "", &c.divergence},
                             {"error of A", "#1f77b4", "4 3", &c.error_a},
                             {"error of B", "#17becf", "4 3", &c.error_b}};
  for (const Cause& x : c.causes)
    if (!x.remaining.empty() && lines.size() < 3 + most_causes)
      lines.push_back({"without " + x.name, colours[lines.size() - 3], "", &x.remaining});
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Line& l : lines)
    for (const double y : *l.y)
      if (std::isfinite(y)) low = std::min(low, std::max(y, floor_of)), high = std::max(high, std::max(y, floor_of));
  if (!(low <= high)) low = high = 1;
  const double from = std::floor(std::log10(low)), to = std::max(std::ceil(std::log10(high)), from + 1);
  const double end = std::max(c.every * static_cast<double>(c.divergence.size() - 1), 1e-300);
  const auto x_of = [&](double t) { return left + (width - left - right) * t / end; };
  const auto y_of = [&](double y) {
    return height - bottom - (height - top - bottom) * (std::log10(std::max(y, floor_of)) - from) / (to - from);
  };
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + std::to_string(width) + " " +
                    std::to_string(height) + "\" font-family=\"system-ui\" font-size=\"11\">";
  const auto text = [&](double x, double y, const char* anchor, const std::string& words, const std::string& more = "") {
    out += "<text x=\"" + short_number(x, 5) + "\" y=\"" + short_number(y, 5) + "\" text-anchor=\"" + anchor + "\"" + more + ">" +
           page::escaped(words) + "</text>";
  };
  const auto rule = [&](double x1, double y1, double x2, double y2, const char* colour) {
    out += "<line stroke=\"" + std::string(colour) + "\" x1=\"" + short_number(x1, 5) + "\" y1=\"" + short_number(y1, 5) +
           "\" x2=\"" + short_number(x2, 5) + "\" y2=\"" + short_number(y2, 5) + "\"/>";
  };
  for (double e = from; e <= to; ++e) {
    const double y = y_of(std::pow(10, e));
    rule(left, y, width - right, y, "#ddd");
    if (to - from < 11 || std::fmod(e - from, 2) == 0) text(left - 5, y + 4, "end", "1e" + std::to_string(static_cast<int>(e)));
  }
  for (int k = 0; k <= 5; ++k) text(x_of(end * k / 5), height - bottom + 15, "middle", short_number(end * k / 5, 3));
  text((left + width - right) / 2.0, height - 8, "middle", "time, s");
  text(14, height / 2.0, "middle", "m or rad", " transform=\"rotate(-90 14 " + std::to_string(height / 2) + ")\"");
  if (c.begins >= 0) rule(x_of(c.begins), top, x_of(c.begins), height - bottom, "#999");
  int row = 0;
  for (const Line& l : lines) {
    if (l.y->empty()) continue;
    std::string path;
    for (std::size_t k = 0; k < l.y->size(); ++k)
      if (std::isfinite((*l.y)[k]))
        path += short_number(x_of(c.every * static_cast<double>(k)), 5) + "," + short_number(y_of((*l.y)[k]), 5) + " ";
    out += "<polyline fill=\"none\" stroke=\"" + l.colour + "\"" +
           (l.dash.empty() ? "" : " stroke-dasharray=\"" + l.dash + "\"") + " points=\"" + path + "\"/>";
    text(width - right + 10, top + 14 + 16 * row++, "start", l.name, " fill=\"" + l.colour + "\"");
  }
  return out + "</svg>";
}

}  // namespace cli::compare
