#include <cstring>
#include <memory>

#include "model/save.hpp"
#include "dynb.hpp"

namespace dyn {

namespace {

// Clears padding bytes, so the same model gives the same file.
template <class T>
void clear_padding([[maybe_unused]] T& x) {
#if defined(__has_builtin)
#if __has_builtin(__builtin_clear_padding)
  __builtin_clear_padding(&x);
#endif
#endif
}

// Layout of records that begin with 3-vectors: their count, and the bytes after them.
template <class T>
struct Vectors {
  static constexpr std::size_t count = 0, rest = sizeof(T);
};
template <class T, std::size_t vectors, std::size_t end>
struct Begins {
  static constexpr std::size_t count = vectors, rest = end - vectors * sizeof(Vec3<double>);
};
#define DYN_BEGINS(T, vectors, last) \
  template <>                        \
  struct Vectors<T> : Begins<T, vectors, offsetof(T, last) + sizeof(T::last)> {}
DYN_BEGINS(Vec3<double>, 1, v);
DYN_BEGINS(Body, 4, joint);
DYN_BEGINS(SE3<double>, 4, p);
DYN_BEGINS(JointRecord, 3, spring_reference);
DYN_BEGINS(FrameRecord, 4, padding);
DYN_BEGINS(PathElement, 5, dof);
DYN_BEGINS(GravityCompensation, 1, link);
DYN_BEGINS(DragBox, 4, body);
DYN_BEGINS(FluidEllipsoid, 4, padding);
DYN_BEGINS(shape::Hull, 1, extent);
#undef DYN_BEGINS

// Layout of machines without SIMD: three doubles a vector, without extra alignment.
struct NarrowLayout {
  template <class T>
  static constexpr std::size_t size = Vectors<T>::count ? (24 * Vectors<T>::count + Vectors<T>::rest + 7) / 8 * 8 : sizeof(T);
  template <class T>
  static constexpr std::size_t alignment = Vectors<T>::count ? 8 : alignof(T);
};

template <class T>
constexpr std::size_t NarrowLayout::size<Stored<T>> = NarrowLayout::size<T> + 2 * sizeof(std::uint64_t);
template <class T>
constexpr std::size_t NarrowLayout::alignment<Stored<T>> = NarrowLayout::alignment<T>;

template <class Layout, class T>
void put(const T& x, char* to) {
  if constexpr (Layout::template size<T> == sizeof(T)) {
    std::memcpy(to, &x, sizeof x);
  } else {
    const char* from = reinterpret_cast<const char*>(&x);
    for (std::size_t k = 0; k < Vectors<T>::count; ++k) std::memcpy(to + 24 * k, from + k * sizeof(Vec3<double>), 24);
    std::memcpy(to + 24 * Vectors<T>::count, from + Vectors<T>::count * sizeof(Vec3<double>), Vectors<T>::rest);
  }
}

template <class Layout, class T>
void put(const Stored<T>& x, char* to) {
  put<Layout>(x.header, to);
  std::memcpy(to + Layout::template size<T>, &x.numbers, 2 * sizeof x.numbers);
}

void drop_name(JointRecord& r) { r.name = 0; }
void drop_name(FrameRecord& r) { r.name = 0; }
void drop_name(ShapeRecord& r) { r.name = r.mesh = 0; }
void drop_name(DisabledRecord& r) { r.reason = 0; }
void drop_name(ActuatorRecord& r) { r.name = 0; }
void drop_name(ConstraintRecord& r) { r.name = 0; }
template <class T>
void drop_name(T&) {}

template <class Layout>
std::string image(const Model& m, bool names) {
  alignas(Model) char head_memory[sizeof(Model)];
  std::memcpy(head_memory, &m, sizeof m);
  Model& head = *reinterpret_cast<Model*>(head_memory);
  head.id = 0;
  if (!names) head.n.text = 1, head.n.reports = 0, head.model_name = 0;
  const ModelSizes& n = head.n;
  std::string block(sizeof(Model), '\0');
  const auto pad = [&](std::size_t boundary) { block.resize((block.size() + boundary - 1) / boundary * boundary); };
#define FIELD(type, field, count, sentence)                                                          \
  static_assert(NarrowLayout::alignment<type> <= alignof(double), "its 3-vectors are not listed");     \
  pad(Layout::template alignment<type> > alignof(double) ? 64 : alignof(double));                    \
  head.offset[std::size_t(Model::Field::field)] = std::uint32_t(block.size() / 8);                   \
  for (std::size_t k = 0, at = block.size(), end = std::size_t(count); k < end; ++k) {               \
    if (k == 0) block.resize(at + end * Layout::template size<type>);                                \
    type x = m.field()[k];                                                                           \
    clear_padding(x);                                                                                \
    if (!names) drop_name(x);                                                                        \
    if (!names && Model::Field::field == Model::Field::configuration_names) x = type{};             \
    put<Layout>(x, block.data() + at + k * Layout::template size<type>);                             \
  }
#include "model/model_fields.def"
#undef FIELD
  pad(64);
  head.bytes = block.size();
  std::memcpy(block.data(), head_memory, sizeof head);
  // id from the content: a model used in place has no other id. Ids of models made in a process count from 1.
  const std::uint64_t id = dynb_checksum(block.data(), block.size()) | std::uint64_t(1) << 63;
  std::memcpy(block.data() + offsetof(Model, id), &id, sizeof id);
  std::string out(sizeof(DynbHeader), '\0');
  out += block;
  load::seal_dynb(out, dynb_tag<Layout>());
  return out;
}

}  // namespace

std::string save_dynb(const Model& m, bool narrow, bool names) {
  return narrow ? image<NarrowLayout>(m, names) : image<OwnLayout>(m, names);
}

}  // namespace dyn
