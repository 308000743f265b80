#include "plot.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace cli::accuracy {

namespace {

constexpr double min_error = 1e-16;

std::string method_of(const Point& p) {
  return p.setting.accuracy > 0
             ? std::string(p.setting.integrator.id == DYN_INTEGRATOR_RK45 ? "rk45" : "reference") + ", by accuracy"
             : p.setting.integrator.name;
}

double log_error(const Point& p) { return std::log10(std::max(p.error.m, min_error)); }
double log_work(const Point& p, Work w) {
  return std::log10(w == Work::Seconds ? std::max(p.wall_s, 1e-9) : static_cast<double>(std::max(p.evaluations, 1LL)));
}

struct Frame {
  double left = HUGE_VAL, right = -HUGE_VAL, low = HUGE_VAL, high = -HUGE_VAL;
  Frame(const std::vector<Point>& points, Work w) {
    for (const Point& p : points) {
      low = std::min(low, std::floor(log_work(p, w))), high = std::max(high, std::ceil(log_work(p, w)));
      if (!p.failure.empty()) continue;
      left = std::min(left, std::floor(log_error(p))), right = std::max(right, std::ceil(log_error(p)));
    }
    if (!(left <= right)) left = -1, right = 0;
    if (left == right) ++right;
    if (low == high) ++high;
  }
  double across(double x) const { return std::clamp((x - left) / (right - left), 0.0, 1.0); }
  double up(double y) const { return std::clamp((y - low) / (high - low), 0.0, 1.0); }
};

using Lines = std::map<std::string, std::vector<const Point*>>;
Lines lines_of(const std::vector<Point>& points) {
  Lines lines;
  for (const Point& p : points) lines[method_of(p)].push_back(&p);
  return lines;
}

std::string power(double x) { return "1e" + std::to_string(static_cast<int>(x)); }

}  // namespace

std::string chart(const std::vector<Point>& points) {
  constexpr int width = 64, height = 16;
  if (points.empty()) return "";
  const Frame f(points, Work::Seconds);
  std::vector<std::string> grid(height + 1, std::string(width + 1, ' '));
  std::string legend;
  char mark = 'a';
  for (const auto& [name, line] : lines_of(points)) {
    for (const Point* p : line) {
      const std::size_t column =
          p->failure.empty() ? static_cast<std::size_t>(std::lround(width * f.across(log_error(*p)))) : width;
      char& cell = grid[static_cast<std::size_t>(std::lround(height * (1 - f.up(log_work(*p, Work::Seconds)))))][column];
      cell = p->failure.empty() ? (cell == ' ' || cell == mark ? (p->pareto ? static_cast<char>(mark - 'a' + 'A') : mark) : '*')
                                : 'x';
    }
    legend += std::string(legend.empty() ? "" : "  ") + mark++ + " " + name;
  }
  std::string out = "time, s, against error, m (capitals: nothing is both cheaper and nearer; *: several; x: failed)\n";
  for (int r = 0; r <= height; ++r)
    out += (r == 0        ? power(f.high)
            : r == height ? power(f.low)
                          : std::string())
               .append("      ")
               .substr(0, 6) +
           "|" + grid[static_cast<std::size_t>(r)] + "\n";
  out += "      +" + std::string(width + 1, '-') + "\n       " + power(f.left) + std::string(width - 8, ' ') + power(f.right) +
         "\n  " + legend + "\n";
  return out;
}

std::string svg(const std::vector<Point>& points, Work work) {
  constexpr int width = 620, height = 420, left = 64, right = 180, top = 14, bottom = 46;
  constexpr const char* colours[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b", "#17becf", "#7f7f7f"};
  if (points.empty()) return "";
  const Frame f(points, work);
  const auto x = [&](double e) { return left + (width - left - right) * f.across(e); };
  const auto y = [&](double w) { return height - bottom - (height - top - bottom) * f.up(w); };
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + std::to_string(width) + " " +
                    std::to_string(height) + "\" font-family=\"system-ui\" font-size=\"11\">";
  const auto text = [&](double at_x, double at_y, const char* anchor, const std::string& words, const std::string& more = "") {
    out += "<text x=\"" + short_number(at_x, 5) + "\" y=\"" + short_number(at_y, 5) + "\" text-anchor=\"" + anchor + "\"" + more +
           ">" + words + "</text>";
  };
  const auto rule = [&](double x1, double y1, double x2, double y2) {
    out += "<line stroke=\"#ddd\" x1=\"" + short_number(x1, 5) + "\" y1=\"" + short_number(y1, 5) + "\" x2=\"" +
           short_number(x2, 5) + "\" y2=\"" + short_number(y2, 5) + "\"/>";
  };
  const double every = std::ceil((f.right - f.left) / 10);  // names of powers that do not touch
  for (double e = f.left; e <= f.right; ++e) {
    rule(x(e), top, x(e), height - bottom);
    if (std::fmod(e - f.left, every) == 0) text(x(e), height - bottom + 14, "middle", power(e));
  }
  for (double w = f.low; w <= f.high; ++w) rule(left, y(w), width - right, y(w)), text(left - 5, y(w) + 4, "end", power(w));
  text((left + width - right) / 2.0, height - 10, "middle", "error, m");
  text(14, height / 2.0, "middle", work == Work::Seconds ? "time, s" : "evaluations of the dynamics",
       " transform=\"rotate(-90 14 " + std::to_string(height / 2) + ")\"");
  std::size_t number = 0;
  for (const auto& [name, line] : lines_of(points)) {
    const std::string colour = colours[number % std::size(colours)];
    std::string path, marks;
    for (const Point* p : line) {
      const double at_x = p->failure.empty() ? x(log_error(*p)) : width - right, at_y = y(log_work(*p, work));
      const std::string where = short_number(at_x, 5) + "," + short_number(at_y, 5);
      if (p->failure.empty()) path += where + " ";
      marks += "<circle cx=\"" + short_number(at_x, 5) + "\" cy=\"" + short_number(at_y, 5) + "\" r=\"" +
               (p->pareto ? "5" : "3") + "\" fill=\"" + (p->failure.empty() ? colour : "none") + "\" stroke=\"" + colour +
               "\"><title>" + name_of(p->setting) + ": " + (p->failure.empty() ? short_number(p->error.m, 3) + " m" : "failed") +
               ", " + short_number(p->wall_s, 3) + " s</title></circle>";
    }
    out += "<polyline fill=\"none\" stroke=\"" + colour + "\" points=\"" + path + "\"/>" + marks;
    text(width - right + 12, top + 16 + 16.0 * static_cast<double>(number++), "start", name, " fill=\"" + colour + "\"");
  }
  return out + "</svg>";
}

}  // namespace cli::accuracy
