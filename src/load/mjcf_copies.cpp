// Elements that refer to copies of <replicate>.
#include <algorithm>

#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

// Attributes that name a part of the tree or a tendon, and what they name.
constexpr std::pair<const char*, const char*> references[] = {
    {"joint", "joint"},   {"jointinparent", "joint"}, {"joint1", "joint"},   {"joint2", "joint"}, {"body", "body"},
    {"body1", "body"},    {"body2", "body"},          {"site", "site"},      {"site1", "site"},   {"site2", "site"},
    {"refsite", "site"},  {"sidesite", "site"},       {"geom", "geom"},      {"geom1", "geom"},   {"geom2", "geom"},
    {"tendon", "tendon"}, {"tendon1", "tendon"},      {"tendon2", "tendon"},
    {"objname", "body"}};

}  // namespace

void MjcfCopies::add(const Element& e, const MjcfContext& context) {
  const std::string kind = e.Name(), name = attribute(e, "name");
  if (name.empty()) return;
  const char* const known_as = kind == "freejoint" ? "joint" : kind == "fixed" || kind == "spatial" ? "tendon" : e.Name();
  const Replica replica = {context.replicate, context.suffix};
  Copied& copied = copies_[{known_as, name}];
  copied.replicas.insert(replica), copied.suffixes.insert(context.suffix);
  if (known_.insert(replica).second) replicas_.push_back(replica);
}

const MjcfCopies::Copied* MjcfCopies::copied(const std::string& kind, const std::string& name) const {
  const auto found = copies_.find({kind, name});
  return found == copies_.end() ? nullptr : &found->second;
}

std::string MjcfCopies::name(const MjcfContext& context, const std::string& kind, const std::string& name) const {
  const Copied* const known = copied(kind, name);
  return name.empty() || (known && known->suffixes.count(context.suffix)) ? context.name(name)
                                                                          : context.prefix + name + context.outer;
}

const MjcfCopies::Replicas* MjcfCopies::replicas_in(const Element& e) const {
  for (const auto& [attribute, kind] : references)
    if (const char* name = e.Attribute(attribute))
      if (const Copied* const known = copied(kind, name)) return &known->replicas;
  return nullptr;
}

void MjcfCopies::read_section(MjcfFile& file, Element& section, const MjcfContext& context, Read read) const {
  MjcfContext copy = context;
  copy.outer = context.suffix;
  std::map<Replica, std::vector<Element*>> again;  // elements of each copy, in the file's order
  for (Element* e : file.source.children(section)) {
    const Replicas* replicas = replicas_in(*e);
    for (const Element* c = first(*e); c && !replicas; c = next(*c)) replicas = replicas_in(*c);  // a tendon's elements
    if (!replicas) {
      file.source.charge(&Budget::add_bytes, bytes_of_part, *e);
      read(file, *e, copy);
      continue;
    }
    file.source.charge(&Budget::add_bytes, (bytes_of_part + bytes_of_visit) * std::int64_t(replicas->size()), *e);
    for (const Replica& replica : *replicas) again[replica].push_back(e);
  }
  for (const Replica& replica : replicas_)
    if (const auto at = again.find(replica); at != again.end())
      for (Element* const e : at->second) copy.replicate = replica.first, copy.suffix = replica.second, read(file, *e, copy);
}

}  // namespace dyn::load
