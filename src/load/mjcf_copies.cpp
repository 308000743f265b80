// Elements that refer to copies of <replicate>.
#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

// Attributes that name a part of the tree or a tendon, and what they name.
constexpr std::pair<const char*, const char*> references[] = {
    {"joint", "joint"},   {"jointinparent", "joint"}, {"joint1", "joint"},   {"joint2", "joint"}, {"body", "body"},
    {"body1", "body"},    {"body2", "body"},          {"site", "site"},      {"site1", "site"},   {"site2", "site"},
    {"refsite", "site"},  {"sidesite", "site"},       {"geom", "geom"},      {"geom1", "geom"},   {"geom2", "geom"},
    {"tendon", "tendon"}, {"tendon1", "tendon"},      {"tendon2", "tendon"}};

}  // namespace

void MjcfCopies::add(const Element& e, const std::string& suffix) {
  const std::string kind = e.Name(), name = attribute(e, "name");
  if (name.empty()) return;
  const char* const known_as = kind == "freejoint" ? "joint" : kind == "fixed" || kind == "spatial" ? "tendon" : e.Name();
  copies_[{known_as, name}].insert(suffix);
  if (known_.insert(suffix).second) suffixes_.push_back(suffix);
}

const std::set<std::string>* MjcfCopies::suffixes_of(const std::string& kind, const std::string& name) const {
  const auto found = copies_.find({kind, name});
  return found == copies_.end() ? nullptr : &found->second;
}

std::string MjcfCopies::name(const MjcfContext& context, const std::string& kind, const std::string& name) const {
  const std::set<std::string>* const suffixes = suffixes_of(kind, name);
  const bool copied = suffixes && suffixes->count(context.suffix);
  return name.empty() || copied ? context.name(name) : context.prefix + name + context.outer;
}

const std::set<std::string>* MjcfCopies::suffixes_in(const Element& e) const {
  for (const auto& [attribute, kind] : references)
    if (const char* name = e.Attribute(attribute))
      if (const std::set<std::string>* const suffixes = suffixes_of(kind, name)) return suffixes;
  return nullptr;
}

void MjcfCopies::read_section(MjcfFile& file, Element& section, const MjcfContext& context, Read read) const {
  MjcfContext copy = context;
  copy.outer = context.suffix;
  std::vector<std::pair<Element*, const std::set<std::string>*>> copied;
  for (Element* e : file.source.children(section)) {
    const std::set<std::string>* suffixes = suffixes_in(*e);
    for (const Element* c = first(*e); c && !suffixes; c = next(*c)) suffixes = suffixes_in(*c);  // a tendon's elements
    if (suffixes) copied.emplace_back(e, suffixes);
    else read(file, *e, copy);
  }
  for (const std::string& suffix : suffixes_)
    for (const auto& [e, suffixes] : copied)
      if (suffixes->count(suffix)) copy.suffix = suffix, read(file, *e, copy);
}

}  // namespace dyn::load
