// Whether a block that came from a file can be read: sizes and offsets first, then whatever is an index.
#include <cstring>

#include "dyn/constraint/list.hpp"
#include "dynb.hpp"
#include "model/builder_impl.hpp"

namespace dyn::load {

namespace {

void require(bool good, const char* what) {
  if (!good) damaged(what);
}

// The layout is a function of the sizes (builder_finish.cpp).
bool laid_out(const Model& m, const ModelSizes& n, std::size_t bytes) {
  const auto round_up = [](std::uint64_t x, std::uint64_t boundary) { return (x + boundary - 1) / boundary * boundary; };
  std::uint64_t end = sizeof(Model);
#define FIELD(type, field, count, sentence)                                    \
  end = round_up(end, alignof(type) > alignof(double) ? 64 : alignof(double)); \
  if (8 * std::uint64_t(m.offset[std::size_t(Model::Field::field)]) != end) return false;         \
  end += std::uint64_t(count) * sizeof(type);                                  \
  if (end > bytes) return false;
#include "dyn/model/model_fields.def"
#undef FIELD
  return round_up(end, 64) == bytes;
}

void check_layout(const Model& m, std::size_t bytes) {
  require(m.magic == Model::magic_value && m.bytes == bytes, "the block's own header is wrong");
  Index sizes[sizeof(ModelSizes) / sizeof(Index)];
  static_assert(sizeof sizes == sizeof(ModelSizes));
  std::memcpy(sizes, &m.n, sizeof sizes);
  for (const Index n : sizes) require(n >= 0 && n <= Index(1) << 30, "a size is out of range");
  const ModelSizes& n = m.n;
  require(n.joints >= 1 && n.frames >= 1 && n.configurations >= 1 && n.text >= 1, "it has no universe");
  require(std::uint64_t(n.configurations) * std::uint64_t(n.nq) <= bytes, "its configurations are larger than the file");
  require((n.mimic_v == 0 || (n.mimic_v == n.nvx && n.nvx >= n.nv)) && n.slots >= n.constraints && n.slots - n.constraints <= 1000, "sizes contradict each other");
  // room for a line of the load report that came and went
  const bool as_it_is = laid_out(m, n, bytes);
  ModelSizes with_room = n;
  ++with_room.reports;
  require(as_it_is || laid_out(m, with_room, bytes), "its arrays are not where their sizes put them, or larger than the file");
}

class Checker {
 public:
  explicit Checker(const Model& model) : m(model), n(model.n) {}

  void run() const {
    require(m.text()[n.text - 1] == '\0', "the text has no end");
    text(m.model_name);
    joints(), frames(), shapes();
    check_dynb_surfaces(m);
    for (Index k = 0; k < n.geoms; ++k) index(m.geoms()[k].shape, n.shapes, "shape of a collision shape");
    for (Index k = 0; k < n.pairs; ++k) {
      const PairRecord& p = m.pairs()[k];
      index(p.a, n.geoms, "shape of a pair"), index(p.b, n.geoms, "shape of a pair"), index(p.material(), n.materials + 1, "material of a pair");
    }
    for (Index k = 0; k < n.reports; ++k) {
      text(m.reports()[k].message);
      require(m.reports()[k].level == DYN_REPORT_INFO || m.reports()[k].level == DYN_REPORT_WARNING, "level of a line of the load report");
    }
    for (Index k = 0; k < n.disabled; ++k) {
      const DisabledRecord& d = m.disabled_pairs()[k];
      text(d.reason);
      for (const Index f : {d.frame1, d.frame2}) index(f, n.frames, "frame of a disabled pair"), require(f == 0 || m.frames()[f].type == DYN_FRAME_BODY, "a disabled pair is of no links");
    }
    for (Index k = 0; k < n.constraints; ++k) {
      const ConstraintRecord& c = m.constraints()[k];
      text(c.name);
      require(int(c.spec.type) > DYN_CONSTRAINT_NONE && int(c.spec.type) <= DYN_CONSTRAINT_FRICTION, "type of a constraint");
      const Index most = between_joints(c.spec.type) ? n.joints : n.frames;
      index(c.spec.first, most, "end of a constraint"), index(c.spec.second, most, "end of a constraint");
    }
    for (Index k = 0; k < n.actuators; ++k) {
      text(m.actuators()[k].name);
      index(m.actuators()[k].spec.joint, n.joints, "joint of an actuator");
    }
    for (Index k = 0; k < n.configurations; ++k) text(m.configuration_names()[k]);
  }

 private:
  const Model& m;
  const ModelSizes& n;

  void text(Index at) const { index(at, n.text, "place of a name"); }
  static void index(Index i, Index count, const char* what) {
    if (i < 0 || i >= count) damaged(std::string(what) + " is " + std::to_string(i) + " of " + std::to_string(count));
  }
  static void simple(dynJointType type) { require(int(type) > DYN_JOINT_FIXED && int(type) <= DYN_JOINT_REVOLUTE_UNBOUNDED && type != DYN_JOINT_COMPOSITE, "type of a joint"); }

  void joints() const {
    std::int64_t nq = 0, nv = 0;
    for (Index j = 0; j < n.joints; ++j) {
      const JointRecord& r = m.joints()[j];
      text(r.name);
      if (j == 0) continue;
      index(r.parent, j, "parent of a joint");
      int own_nq = 0, own_nv = 0;
      if (r.type == DYN_JOINT_COMPOSITE) {
        require(r.parts > 0 && r.first_part >= 0 && r.first_part <= n.parts - r.parts, "parts of a joint");
        for (const PartRecord *p = m.parts() + r.first_part, *end = p + r.parts; p != end; ++p) simple(p->type), own_nq += joint_nq(p->type), own_nv += joint_nv(p->type);
      } else {
        simple(r.type);
        require(r.parts == 0 && r.first_part >= 0 && r.first_part <= n.parts, "parts of a joint");
        own_nq = joint_nq(r.type), own_nv = joint_nv(r.type);
      }
      require(r.leader >= -1 && r.leader != 0 && r.leader < n.joints && r.leader != j, "leader of a joint");
      const bool follows = r.leader >= 0;
      require(!follows || (own_nq == 1 && own_nv == 1), "a joint that follows has several coordinates");
      require(r.nq == (follows ? 0 : own_nq) && r.nv == (follows ? 0 : own_nv), "coordinates of a joint");
      require(r.idx_q >= 0 && r.idx_q <= n.nq - own_nq && r.idx_v >= 0 && r.idx_v <= n.nv - own_nv, "coordinates of a joint");
      nq += r.nq, nv += r.nv;
    }
    require(nq == n.nq && nv == n.nv, "coordinates of the joints");
  }

  void frames() const {
    for (Index f = 0; f < n.frames; ++f) {
      const FrameRecord& r = m.frames()[f];
      text(r.name), index(r.joint, n.joints, "joint of a frame");
      require(r.type == DYN_FRAME_OP_FRAME || r.type == DYN_FRAME_JOINT || r.type == DYN_FRAME_FIXED_JOINT || r.type == DYN_FRAME_BODY || r.type == DYN_FRAME_SENSOR, "type of a frame");
      require(r.type == DYN_FRAME_BODY ? r.link >= 0 && r.link < n.links : r.link == -1, "link of a frame");
      require(r.type != DYN_FRAME_JOINT || r.joint > 0, "joint of a frame");
    }
  }

  void shapes() const {
    for (Index k = 0; k < n.shapes; ++k) {
      const ShapeRecord& r = m.shapes()[k];
      text(r.name), text(r.mesh);
      index(r.frame, n.frames, "frame of a shape"), index(r.material, n.materials, "material of a shape");
      require(r.frame == 0 || m.frames()[r.frame].type == DYN_FRAME_BODY, "a shape is on no link");
      require(int(r.type) >= DYN_SHAPE_BOX && int(r.type) <= DYN_SHAPE_HEIGHT_FIELD, "type of a shape");
      require(r.role == DYN_ROLE_COLLISION || r.role == DYN_ROLE_VISUAL, "role of a shape");
      const Index surfaces = r.type == DYN_SHAPE_CONVEX ? n.hulls : r.type == DYN_SHAPE_TRIANGLES ? n.trees : r.type == DYN_SHAPE_HEIGHT_FIELD ? n.grids : 0;
      if (surfaces || r.surface >= 0) index(r.surface, surfaces, "surface of a shape");
    }
  }
};

}  // namespace

void check_dynb_block(const Model& m, std::size_t bytes) {
  check_layout(m, bytes);
  Checker(m).run();
}

}  // namespace dyn::load
