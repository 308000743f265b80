#include <algorithm>
#include <string_view>

#include "mjcf_settings.hpp"
#include "number.hpp"

namespace dyn::load {

namespace {

// Attributes that a file may give in part; missing numbers keep their values.
constexpr std::string_view partial[] = {"size", "friction", "gear", "gainprm", "biasprm", "dynprm", "polycoef"};

std::string with_rest(const std::string& attribute, const char* given, const std::string& before) {
  std::string out = given;
  if (std::find(std::begin(partial), std::end(partial), attribute) == std::end(partial)) return out;
  const auto all = split(before);
  for (size_t k = split(given).size(); k < all.size(); ++k) out.append(" ").append(all[k]);
  return out;
}

// <position> and similar shortcuts share the defaults of <general>.
std::string kind_of(const Element& e) { return is_actuator(e) ? "actuator" : e.Name(); }

bool is_rotation(std::string_view attribute) {
  return std::find(rotation_attributes.begin(), rotation_attributes.end(), attribute) != rotation_attributes.end();
}

}  // namespace

void MjcfDefaults::read(MjcfSource& source, Element& e) {
  const char* name = e.Attribute("class");
  if (name && *name) numbers_.erase(classes_[0].name), numbers_[classes_[0].name = name] = 0;  // it may be renamed
  read(source, e, 0);
}

// Reads settings first, because nested classes inherit all of them.
void MjcfDefaults::read(MjcfSource& source, Element& e, int at) {
  for (Element* c : source.children(e)) {
    if (std::string_view(c->Name()) == "default") continue;
    Attributes& known = classes_[size_t(at)].kinds[kind_of(*c)];
    if (is_actuator(*c)) write(source, known, *c), as_general(source.reader(*c, "<default>"), *c);
    if (load::has_rotation(*c)) std::erase_if(known, [](const auto& a) { return is_rotation(a.first); });
    for (const tinyxml2::XMLAttribute* a = c->FirstAttribute(); a; a = a->Next())
      known[a->Name()] = with_rest(a->Name(), a->Value(), known[a->Name()]);
  }
  for (Element* c : source.children(e, "default")) {
    const std::string name = source.reader(*c, "<default>").name(*c, "class");
    if (!numbers_.emplace(name, int(classes_.size())).second)
      source.report(*c).fail(DYN_ERROR_NAME, line(*c), "class " + load::in_quotes(name) + " of defaults is there already");
    std::int64_t inherited = bytes_of_element;
    for (const auto& [kind, attributes] : classes_[size_t(at)].kinds)
      for (const auto& [attribute, value] : attributes) inherited += bytes_of_attribute + std::int64_t(value.size());
    source.charge(&Budget::add_bytes, inherited, *c);
    classes_.push_back({name, classes_[size_t(at)].kinds});
    read(source, *c, int(classes_.size()) - 1);
  }
}

int MjcfDefaults::find(const MjcfSource& source, const Element& e, const std::string& name) const {
  if (const auto at = numbers_.find(name); at != numbers_.end()) return at->second;
  std::vector<const std::string*> all;
  for (const Class& c : classes_) all.push_back(&c.name);
  source.report(e).fail(DYN_ERROR_NAME, line(e),
                        "there is no class " + load::in_quotes(name) + " of defaults" + did_you_mean(name, all));
}

void MjcfDefaults::apply(const MjcfSource& source, Element& e, const std::string& kind, const std::string& around) const {
  const char* own = e.Attribute("class");
  const std::string name = own ? own : around;
  const Class& c = classes_[name.empty() ? 0 : size_t(find(source, e, name))];
  const auto at = c.kinds.find(kind);
  if (at != c.kinds.end()) write(source, at->second, e);
}

void MjcfDefaults::write(const MjcfSource& source, const Attributes& known, Element& e) {
  const bool turned = load::has_rotation(e);
  for (const auto& [attribute, value] : known) {
    if (attribute == "class" || (turned && is_rotation(attribute))) continue;
    const char* const given = e.Attribute(attribute.c_str());
    source.charge(&Budget::add_bytes, std::int64_t(value.size()) + (given ? 0 : bytes_of_attribute), e);
    e.SetAttribute(attribute.c_str(), given ? with_rest(attribute, given, value).c_str() : value.c_str());
  }
}

std::string MjcfDefaults::around(const MjcfSource& source, const Element& e, const std::string& outside) const {
  const char* name = e.Attribute("childclass");
  if (!name) return outside;
  find(source, e, name);
  return name;
}

}  // namespace dyn::load
