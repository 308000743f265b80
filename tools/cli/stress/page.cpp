#include "page.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "../cli.hpp"
#include "../page/markup.hpp"
#include "../system/system.hpp"

namespace cli::stress {

namespace {

std::size_t worst(const Outcome& o) {
  std::size_t at = 0;
  for (std::size_t k = 1; k < o.reference.size(); ++k)
    if (!(std::abs(o.result[k] - o.reference[k]) <= std::abs(o.result[at] - o.reference[at]))) at = k;
  return at;
}

using page::escaped;

struct Range {
  double low = HUGE_VAL, high = -HUGE_VAL;
  void take(double x) {
    if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
  }
  double place(double x, double from, double to) const {
    return from + (to - from) * (high > low ? (x - low) / (high - low) : 0.5);
  }
};

constexpr int width = 360, page_height = 200, left = 58, bottom = 34, max_points = 600;
constexpr const char* colours[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b", "#17becf"};

std::string svg(const Picture& p) {
  const auto scaled = [&](double y) { return p.logarithmic ? std::log10(std::max(y, 1e-17)) : y; };
  Range x, y;
  for (const Curve& c : p.curves)
    for (std::size_t k = 0; k < c.x.size(); ++k) x.take(c.x[k]), y.take(scaled(c.y[k]));
  if (!(x.high >= x.low) || !(y.high >= y.low)) return "";
  std::string out = "<svg viewBox=\"0 0 " + std::to_string(width) + " " + std::to_string(page_height) + "\">";
  const auto label = [&](double at_x, double at_y, const char* anchor, const std::string& text) {
    out += "<text x=\"" + short_number(at_x, 5) + "\" y=\"" + short_number(at_y, 5) + "\" text-anchor=\"" + anchor + "\">" +
           escaped(text) + "</text>";
  };
  const auto value = [&](double at) { return p.logarithmic ? short_number(std::pow(10, at), 2) : short_number(at, 3); };
  const double floor = page_height - bottom;
  out += "<rect x=\"" + std::to_string(left) + "\" y=\"14\" width=\"" + std::to_string(width - left - 8) + "\" height=\"" +
         std::to_string(page_height - bottom - 14) + "\"/>";
  label(left, floor + 13, "start", short_number(x.low, 3)), label(width - 8, floor + 13, "end", short_number(x.high, 3));
  label((left + width) / 2.0, page_height - 6, "middle", p.x), label(left - 4, floor, "end", value(y.low)),
      label(left - 4, 22, "end", value(y.high)), label(left, 10, "start", p.y);
  for (std::size_t i = 0; i < p.curves.size(); ++i) {
    const Curve& c = p.curves[i];
    const char* colour = colours[i % std::size(colours)];
    out += std::string("<polyline stroke=\"") + colour + "\" points=\"";
    const std::size_t every = std::max<std::size_t>(1, c.x.size() / max_points);
    for (std::size_t k = 0; k < c.x.size(); k += every)
      if (std::isfinite(c.x[k]) && std::isfinite(c.y[k]))
        out +=
            short_number(x.place(c.x[k], left, width - 8), 5) + "," + short_number(y.place(scaled(c.y[k]), floor, 14), 5) + " ";
    out += "\"/>";
    if (p.curves.size() > 1)
      out += std::string("<text fill=\"") + colour + "\" x=\"" + std::to_string(left + 4) + "\" y=\"" +
             std::to_string(26 + 11 * i) + "\">" + escaped(c.name) + "</text>";
  }
  return out + "</svg>";
}

}  // namespace

std::string Verdict::shown_reference() const {
  return outcome.reference.empty() ? "0" : short_number(outcome.reference[worst(outcome)], 12);
}
std::string Verdict::shown_result() const {
  return outcome.reference.empty() ? short_number(outcome.error, 3) : short_number(outcome.result[worst(outcome)], 12);
}

void write_page(const std::string& path, const std::vector<Verdict>& verdicts) {
  std::string out =
      "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>dyn stress</title><style>body{font:14px "
      "system-ui;margin:2em;max-width:1500px}"
      "table{border-collapse:collapse}td,th{padding:2px 8px;border-bottom:1px solid "
      "#ddd;text-align:left}.f{color:#b00;font-weight:bold}"
      "section{display:inline-block;width:360px;vertical-align:top;margin:8px 16px 8px 0}svg{width:360px}svg text{font:10px "
      "system-ui}"
      "svg rect{fill:none;stroke:#aaa}polyline{fill:none;stroke-width:1.2}h2{font-size:15px;margin:0}p{margin:2px "
      "0}</style><h1>dyn stress</h1><p>" +
      escaped(dyn_build_info()) +
      "</p><table><tr><th>case<th>metric<th>reference<th>result<th>error<th>tolerance<th>verdict<th>time, s</tr>\n";
  for (const Verdict& v : verdicts)
    out += "<tr><td><a href=\"#" + std::string(v.c->name) + "\">" + v.c->name + "</a><td>" + escaped(v.c->metric) + "<td>" +
           v.shown_reference() + "<td>" + v.shown_result() + "<td>" + short_number(v.outcome.error, 2) + "<td>" +
           short_number(v.c->tolerance, 2) + (v.passed ? "<td>passed" : "<td class=\"f\">failed") + "<td>" +
           short_number(v.wall_s, 2) + "</tr>\n";
  out += "</table>\n";
  for (const Verdict& v : verdicts)
    out += "<section id=\"" + std::string(v.c->name) + "\"><h2>" + v.c->name + "</h2><p>" + escaped(v.c->sentence) + "</p><p>" +
           escaped(v.c->metric) + ": " + short_number(v.outcome.error, 2) + " (at most " + short_number(v.c->tolerance, 2) +
           "). Reference: " + escaped(v.c->source) + ".</p>" +
           (v.failure.empty() ? "" : "<p class=\"f\">" + escaped(v.failure) + "</p>") + svg(v.outcome.picture) + "</section>\n";
  out += "</html>\n";
  errno = 0;
  std::FILE* file = open_file(path, "wb");
  const bool good = file && std::fwrite(out.data(), 1, out.size(), file) == out.size();
  if ((file && std::fclose(file) != 0) || !good) fail(path + ": cannot be written: " + std::strerror(errno) + ".");
}

}  // namespace cli::stress
