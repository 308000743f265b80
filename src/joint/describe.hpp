// The chain of a kind as text, as "prismatic axis_x, prismatic axis_y, revolute axis", and what it reads of a JointGeometry.
#pragma once

#include "joint/kinds.hpp"
#include "table/names.hpp"

namespace dyn {

struct KindText {
  char chain[100] = {};
  bool axis = false, axis2 = false, pitch = false;
  int used = 0;

  constexpr void add(const char* word) {
    while (*word) chain[used++] = *word++;
  }
};

// elements() of marks, which tell where each axis comes from.
template <class K>
constexpr KindText describe_kind() {
  constexpr JointGeometry marks = {{2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}, 6};
  constexpr struct {
    Axis axis;
    const char* name;
  } axes[] = {{marks.axis, " axis"}, {marks.axis2, " axis2"}, {marks.x, " axis_x"}, {marks.y, " axis_y"},
              {x_axis, " x"},        {y_axis, " y"},          {z_axis, " z"}};
  constexpr struct {
    BodyType type;
    const char* name;
    bool has_axis;
  } primitives[] = {
#define DYN_PRIMITIVE(J) {BodyType::J, name_of(kind::J::type), J::nv == 1},
      DYN_PRIMITIVES(DYN_PRIMITIVE)
#undef DYN_PRIMITIVE
  };
  KindText out;
  for (const Element& e : K::elements(marks)) {
    if (out.used) out.add(", ");
    bool has_axis = false;
    for (const auto& p : primitives)
      if (p.type == e.type) out.add(p.name), has_axis = p.has_axis;
    for (const auto& a : axes)
      if (has_axis && a.axis == e.axis) out.add(a.name);
    out.axis |= e.axis == marks.axis || e.axis == marks.x || e.axis == marks.y;
    out.axis2 |= e.axis == marks.axis2, out.pitch |= e.pitch == marks.pitch;
  }
  return out;
}

template <class K>
inline constexpr KindText kind_text = describe_kind<K>();

}  // namespace dyn
