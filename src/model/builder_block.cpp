// One block of memory: the header, then the arrays, at offsets that follow from their sizes.
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>

#include "builder_compile.hpp"
#include "effect/list.hpp"
#include "model/block.hpp"
#include "model/unit_norms.hpp"

namespace dyn {

namespace {

std::atomic<std::uint64_t> next_id{1};

}  // namespace

void ModelDeleter::operator()(Model* m) const { free_aligned(m); }

void Compiler::allocate() {
  // capacity of the elimination tree, which takes the finished model
  a.dof_parent.assign(std::size_t(n.nv), -1);
  a.dof_depth = a.dof_descendants_end = a.dof_run = a.dof_parent;
  a.dof_forks.assign(std::size_t(n.nv), 0), a.dof_groups.resize(std::size_t(n.nv));
  auto round_up = [](std::uint64_t x, std::uint64_t boundary) {
    return (x + boundary - 1) / boundary * boundary;
  };  // vectors on lines of the cache
  std::uint64_t bytes = sizeof(Model);
  std::uint64_t offset[std::size_t(Model::Field::count_)];
#define FIELD(type, field, count, sentence)                                                  \
  if (a.field.size() != std::size_t(count)) throw Error(DYN_ERROR_INTERNAL, "model field " #field " has a wrong size"); \
  offset[std::size_t(Model::Field::field)] = bytes = round_up(bytes, alignof(type) > alignof(double) ? 64 : alignof(double)); \
  bytes += a.field.size() * sizeof(type);
#include "model/model_fields.def"
#undef FIELD
  bytes = round_up(bytes, 64);
  if (bytes / 8 > UINT32_MAX) throw Error(DYN_ERROR_LIMIT, "the model has more than 2^35 bytes: simplify its meshes");
  model.reset(static_cast<Model*>(allocate_block(bytes)));
  if (!model) throw std::bad_alloc();
  std::memset(static_cast<void*>(model.get()), 0, bytes);
  model->bytes = bytes;
  std::transform(std::begin(offset), std::end(offset), model->offset, [](std::uint64_t x) { return std::uint32_t(x / 8); });
}

void Compiler::fill_header() {
  model->magic = Model::magic_value;
  model->id = next_id++;
  model->n = n;
  model->model_name = name;
  model->has_mimic = mimic;
  auto small = [](double x) { return std::abs(x) < 1e25; };
  auto all_small = [&](const Vec3<double>& x) { return small(x[0]) && small(x[1]) && small(x[2]); };
  model->no_overflow = std::all_of(a.armature.begin(), a.armature.end(), small) &&
                       std::all_of(a.bodies.begin(), a.bodies.end(), [&](const Body& b) {
                         return small(b.m) && small(b.pitch) && small(b.ratio) && all_small(b.h) && all_small(b.I.x) &&
                                all_small(b.I.y) && all_small(b.I.z);
                       });
  std::copy(in.gravity.begin(), in.gravity.end(), model->gravity);
  model->contact_capacity = in.contact_capacity;
  model->density = in.density, model->viscosity = in.viscosity;
  std::copy(in.wind.begin(), in.wind.end(), model->wind);
  for (Index i = 1; i < n.bodies; ++i) model->total_mass += a.bodies[std::size_t(i)].m;
}

void Compiler::copy_arrays() {
#define FIELD(type, field, count, sentence) \
  if (!a.field.empty()) std::memcpy(array<char>(Model::Field::field), a.field.data(), a.field.size() * sizeof(type));
#include "model/model_fields.def"
#undef FIELD
  model->effects = effects_of(*model);
}

// Named configurations are points of the configuration space: quaternions and (cos, sin) pairs of norm 1.
void Compiler::settle_configurations() {
  const Model& m = *model;
  double* q = array<double>(Model::Field::configurations);
  for (Index k = 0; k < m.n.configurations; ++k, q += m.n.nq) {
    if (const Index j = zero_norm_joint(m, q))
      throw Error(DYN_ERROR_QUATERNION, "configuration '" + std::string(m.string(m.configuration_names()[k])) +
                                            "': the quaternion or (cos, sin) of joint '" + m.string(m.joints()[j].name) +
                                            "' is zero: give one of norm 1, such as that of 'neutral'");
    if (norm_error(m, q) > 1e-15) normalize(m, q);  // so that it changes nothing when done again
  }
}

void Compiler::fill_elimination_tree() {
  elimination_tree(*model, a.dof_parent);
  for (std::size_t k = 0; k < std::size_t(n.nv); ++k) {
    const Index p = a.dof_parent[k];
    a.dof_depth[k] = p >= 0 ? a.dof_depth[std::size_t(p)] + 1 : 0;
    a.dof_run[k] = k > 0 && p == Index(k) - 1 ? a.dof_run[k - 1] : Index(k);
    if (p >= 0 && p != Index(k) - 1) a.dof_forks[std::size_t(p)] = 1;
    a.dof_descendants_end[k] = Index(k) + 1;
  }
  for (std::size_t k = std::size_t(n.nv); k-- > 0;)
    if (a.dof_parent[k] >= 0) {
      Index& up = a.dof_descendants_end[std::size_t(a.dof_parent[k])];
      up = std::max(up, a.dof_descendants_end[k]);
    }
  model->groups = make_dof_groups(a.dof_parent, a.dof_depth, a.dof_descendants_end, array<DofGroup>(Model::Field::dof_groups));
  auto fill_in = [&](Model::Field field, const std::vector<Index>& x) { std::copy(x.begin(), x.end(), array<Index>(field)); };
  fill_in(Model::Field::dof_parent, a.dof_parent), fill_in(Model::Field::dof_depth, a.dof_depth),
      fill_in(Model::Field::dof_run, a.dof_run);
  fill_in(Model::Field::dof_descendants_end, a.dof_descendants_end), fill_in(Model::Field::dof_forks, a.dof_forks);
  for (std::size_t k = 0; k < std::size_t(n.nv); ++k)
    model->n.carriers = std::max(model->n.carriers, std::min(n.nv, 2 * (a.dof_depth[k] + 1)));
}

}  // namespace dyn
