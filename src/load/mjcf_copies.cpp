// Elements that refer to copies of <replicate>.
#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

// Attributes that name a part of the tree, and what they name.
constexpr std::pair<const char*, const char*> references[] = {
    {"joint", "joint"}, {"jointinparent", "joint"}, {"joint1", "joint"}, {"joint2", "joint"}, {"body", "body"},   {"body1", "body"},
    {"body2", "body"},  {"site", "site"},           {"site1", "site"},   {"site2", "site"},   {"geom1", "geom"}, {"geom2", "geom"}};

}  // namespace

void MjcfCopies::add(const Element& e, const std::string& suffix) {
  const std::string kind = e.Name(), name = attribute(e, "name");
  if (name.empty()) return;
  copies_[{kind == "freejoint" ? "joint" : kind, name}].insert(suffix);
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

void MjcfCopies::read_section(MjcfFile& file, Element& section, const MjcfContext& context, Read read) const {
  MjcfContext copy = context;
  copy.outer = context.suffix;
  std::vector<std::pair<Element*, const std::set<std::string>*>> copied;
  for (Element* e : file.source.children(section)) {
    const std::set<std::string>* suffixes = nullptr;
    for (const auto& [attribute, kind] : references)
      if (const char* name = e->Attribute(attribute); name && !suffixes) suffixes = suffixes_of(kind, name);
    if (suffixes) copied.emplace_back(e, suffixes);
    else read(file, *e, copy);
  }
  for (const std::string& suffix : suffixes_)
    for (const auto& [e, suffixes] : copied)
      if (suffixes->count(suffix)) copy.suffix = suffix, read(file, *e, copy);
}

}  // namespace dyn::load
