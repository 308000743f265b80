// <disable_collisions> and MoveIt's defaults. <disable_default_collisions> disables all pairs of a link, <enable_collisions>
// enables single ones again. <disable_collisions> comes last.
#include <algorithm>
#include <set>

#include "reader.hpp"
#include "srdf.hpp"

namespace dyn::load {

namespace {

constexpr std::size_t max_pairs = 1000000;

using PairNames = std::pair<std::string, std::string>;
PairNames ordered(const std::string& a, const std::string& b) { return a < b ? PairNames{a, b} : PairNames{b, a}; }

}  // namespace

std::vector<Srdf::Pair> read_pairs(const Element& root, const SrdfContext& context) {
  Report& report = context.report;
  std::vector<Srdf::Pair> out;
  std::set<PairNames> disabled, enabled;
  const auto add = [&](const Element& e, const std::string& a, const std::string& b, const std::string& reason) {
    if (!disabled.insert(ordered(a, b)).second) return false;
    if (out.size() == max_pairs)
      report.fail(DYN_ERROR_LIMIT, line(e), "more than " + std::to_string(max_pairs) + " disabled pairs, which is the limit");
    if (context.budget) context.budget->add_bytes(bytes_of_part, report, line(e));
    out.push_back({a, b, printable(reason)});
    return true;
  };
  // Reads the two links of an element. Returns false unless they are a pair of the robot.
  const auto pair = [&](const Element& e, PairNames& names) {
    const Reader reader{report, std::string("<") + e.Name() + ">"};
    reader.unread(e, {"link1", "link2", "reason"}, {});
    names = {reader.name(e, "link1"), reader.name(e, "link2")};
    const bool one = known_link(e, names.first, reader.owner, context), two = known_link(e, names.second, reader.owner, context);
    if (one && names.first == names.second)
      report.warning(line(e), reader.owner + ": link " + in_quotes(names.first) + " and itself: not used");
    return one && two && names.first != names.second;
  };

  PairNames names;
  std::set<std::string> by_default;  // links
  for (const Element* e = first(root, "disable_collisions"); e; e = next(*e, "disable_collisions"))
    if (pair(*e, names) && !add(*e, names.first, names.second, e->Attribute("reason") ? e->Attribute("reason") : ""))
      report.count("<disable_collisions> of a pair that is disabled already", line(*e));
  for (const Element* e = first(root, "enable_collisions"); e; e = next(*e, "enable_collisions"))
    if (pair(*e, names)) enabled.insert(ordered(names.first, names.second));
  for (const Element* e = first(root, "disable_default_collisions"); e; e = next(*e, "disable_default_collisions")) {
    const Reader reader{report, "<disable_default_collisions>"};
    reader.unread(*e, {"link"}, {});
    const std::string link = reader.name(*e, "link");
    if (!known_link(*e, link, reader.owner, context) || !by_default.insert(link).second) continue;
    for (const UrdfLink& other : context.robot.links)
      if (other.name != link && !enabled.count(ordered(link, other.name))) add(*e, link, other.name, "Default");
  }
  return out;
}

}  // namespace dyn::load
