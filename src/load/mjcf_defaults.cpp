#include <algorithm>
#include <string_view>

#include "mjcf_settings.hpp"

namespace dyn::load {

namespace {

bool is_rotation(std::string_view attribute) {
  return std::find(rotation_attributes.begin(), rotation_attributes.end(), attribute) != rotation_attributes.end();
}

}  // namespace

void MjcfDefaults::read(MjcfSource& source, Element& e) {
  const char* name = e.Attribute("class");
  if (name && *name) classes_[0].name = name;  // the outermost class may have another name than main
  read(source, e, 0);
}

// Settings first: nested classes have them all, wherever they stand.
void MjcfDefaults::read(MjcfSource& source, Element& e, int at) {
  for (Element* c : source.children(e)) {
    if (std::string_view(c->Name()) == "default") continue;
    Attributes& known = classes_[size_t(at)].kinds[c->Name()];
    if (load::has_rotation(*c)) std::erase_if(known, [](const auto& a) { return is_rotation(a.first); });
    for (const tinyxml2::XMLAttribute* a = c->FirstAttribute(); a; a = a->Next()) known[a->Name()] = a->Value();
  }
  for (Element* c : source.children(e, "default")) {
    const std::string name = source.reader(*c, "<default>").name(*c, "class");
    for (const Class& k : classes_)
      if (k.name == name) source.report(*c).fail(DYN_ERROR_NAME, line(*c), "class " + load::quoted(name) + " of defaults is there already");
    classes_.push_back({name, classes_[size_t(at)].kinds});
    read(source, *c, int(classes_.size()) - 1);
  }
}

int MjcfDefaults::find(const MjcfSource& source, const Element& e, const std::string& name) const {
  std::vector<const std::string*> all;
  for (const Class& c : classes_) {
    if (c.name == name) return int(&c - classes_.data());
    all.push_back(&c.name);
  }
  source.report(e).fail(DYN_ERROR_NAME, line(e), "there is no class " + load::quoted(name) + " of defaults" + did_you_mean(name, all));
}

void MjcfDefaults::apply(const MjcfSource& source, Element& e, const std::string& kind, const std::string& around) const {
  const char* own = e.Attribute("class");
  const std::string name = own ? own : around;
  const Class& c = classes_[name.empty() ? 0 : size_t(find(source, e, name))];
  const auto at = c.kinds.find(kind);
  if (at == c.kinds.end()) return;
  const bool turned = load::has_rotation(e);
  for (const auto& [attribute, value] : at->second)
    if (attribute != "class" && !(turned && is_rotation(attribute)) && !e.Attribute(attribute.c_str())) e.SetAttribute(attribute.c_str(), value.c_str());
}

std::string MjcfDefaults::around(const MjcfSource& source, const Element& e, const std::string& outside) const {
  const char* name = e.Attribute("childclass");
  if (!name) return outside;
  find(source, e, name);
  return name;
}

}  // namespace dyn::load
