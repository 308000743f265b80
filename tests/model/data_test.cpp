// Data: parts, sizes, alignment, the state of new data, freshness; and the arm's budget of memory.
#include "common/random_tree.hpp"
#include "common/work.hpp"
#include "dyn.h"

namespace dyn_test {
namespace {

// every buffer of data with its count, as the table says
template <class F>
void for_buffers(const Model& m, dynParts parts, Data<double>& d, F&& f) {
  const std::ptrdiff_t nq = m.n.nq, nv = m.n.nv, nframes = m.n.frames, nparameters = parameter_count(m), npairs = m.n.pairs,
                       nrows = m.n.constraint_rows, nu = m.n.nu, na = m.n.na, nactuators = m.n.actuators, ntendons = m.n.tendons,
                       nmocaps = m.n.mocaps,
                       nsensordata = m.n.sensor_values;
  (void)nu, (void)na, (void)nactuators, (void)ntendons, (void)nmocaps, (void)nsensordata;
  (void)nq, (void)nv, (void)nframes, (void)nparameters, (void)npairs, (void)nrows;
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) \
  f(#name, (const char*)d.name, ((part) == 0 || (parts & (part))) ? std::size_t((rows) * (cols)) * sizeof(*d.name) : 0);
#define BUFFER(type, name, count, part, sentence) \
  f(#name, (const char*)d.name, ((part) == 0 || (parts & (part))) ? std::size_t(count) * sizeof(*d.name) : 0);
#include "model/data_fields.def"
}

TEST(Data, BuffersAreAlignedDisjointAndOnlyWhatWasAskedFor) {
  for (std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const ModelPtr m = random_tree(seed).build();
    for (dynParts parts = 0; parts <= DYN_PART_ALL; parts = parts == 0 ? 1 : parts * 2) {
      Work<double> w(*m, parts);
      const dynParts complete = complete_parts(*m, parts);
      EXPECT_EQ(complete, w.d.parts);
      const char* end = nullptr;
      std::size_t used = 0;
      for_buffers(*m, complete, w.d, [&](const char* name, const char* at, std::size_t bytes) {
        EXPECT_EQ(bytes == 0, at == nullptr) << name << " of parts " << parts;
        if (!at) return;
        EXPECT_EQ(0u, reinterpret_cast<std::uintptr_t>(at) % 64) << name;
        EXPECT_GE(at, end) << name << " overlaps what is before it";
        end = at + bytes;
        used += (bytes + 63) / 64 * 64;
      });
      EXPECT_EQ(used, data_bytes<double>(*m, parts));
    }
  }
}

TEST(Data, PartsBringWhatTheyNeed) {
  EXPECT_EQ(dynParts(DYN_PART_ALL), complete_parts(0));
  EXPECT_EQ(dynParts(DYN_PART_MINV | DYN_PART_CHOLESKY | DYN_PART_FORWARD | DYN_PART_MASS), complete_parts(DYN_PART_MINV));
  EXPECT_EQ(dynParts(DYN_PART_CHOLESKY | DYN_PART_MASS), complete_parts(DYN_PART_CHOLESKY));
  for (dynParts p : {DYN_PART_JACOBIANS, DYN_PART_COM, DYN_PART_CORIOLIS, DYN_PART_ENERGY, DYN_PART_FRAMES, DYN_PART_CENTROIDAL,
                     DYN_PART_REGRESSOR})
    EXPECT_EQ(p | DYN_PART_KINEMATICS, complete_parts(p));
  EXPECT_EQ(dynParts(DYN_PART_IK | DYN_PART_COM | DYN_PART_KINEMATICS), complete_parts(DYN_PART_IK));
  const ModelPtr m = random_tree(6).build();
  EXPECT_LT(data_bytes<double>(*m, DYN_PART_INVERSE), data_bytes<double>(*m, DYN_PART_INVERSE | DYN_PART_FORWARD));
  EXPECT_LT(data_bytes<double>(*m, DYN_PART_INVERSE | DYN_PART_MINV), data_bytes<double>(*m, 0));
}

TEST(Data, NothingOfSizeNvSquaredUnlessAskedFor) {
  TreeOptions free_bodies;
  free_bodies.joints = 1000, free_bodies.types = {DYN_JOINT_TYPE_FREE_FLYER}, free_bodies.branch = 1, free_bodies.armature = 0;
  const ModelPtr m = random_tree(1, free_bodies).build();
  ASSERT_EQ(6000, m->n.nv);
  for (dynParts parts : {DYN_PART_INVERSE, DYN_PART_FORWARD, DYN_PART_KINEMATICS, DYN_PART_ENERGY, DYN_PART_COM,
                         DYN_PART_JACOBIANS, DYN_PART_CENTROIDAL})
    EXPECT_LT(data_bytes<double>(*m, parts), 5000000u) << parts;  // M alone would be 288 MB
}

TEST(Data, StartsAtNeutralAndRestWithNothingComputed) {
  const ModelPtr m = random_tree(7).build();
  Work<double> w(*m);
  EXPECT_EQ(0, gap(matrix(w.d.q, m->n.nq), matrix(m->neutral(), m->n.nq)));
  EXPECT_EQ(0, largest(matrix(w.d.v, m->n.nv)));
  EXPECT_EQ(0, largest(matrix(w.d.a, m->n.nv)));
  EXPECT_EQ(0, largest(matrix(w.d.tau_applied, m->n.nv)));
  EXPECT_EQ(0, w.d.time[0]);
  EXPECT_TRUE(w.d.fresh(Stage::State));
  for (Index s = 1; s < Index(Stage::count_); ++s) EXPECT_FALSE(w.d.fresh(Stage(s))) << s;
}

TEST(Data, EachStageIsFreshForItsInputsOnly) {
  const ModelPtr m = random_tree(8).build();
  struct Row {
    Stage stage;
    bool q, v, a, tau;
  };
  for (const Row& row : {Row{Stage::Position, 1, 0, 0, 0}, Row{Stage::Velocity, 1, 1, 0, 0}, Row{Stage::Acceleration, 1, 1, 1, 0},
                         Row{Stage::Mass, 1, 0, 0, 0}, Row{Stage::Tau, 1, 1, 1, 0}, Row{Stage::Ddq, 1, 1, 0, 1},
                         Row{Stage::Gravity, 1, 0, 0, 0}, Row{Stage::Coriolis, 1, 1, 0, 0}, Row{Stage::Jcom, 1, 0, 0, 0},
                         Row{Stage::Acom, 1, 1, 1, 0}, Row{Stage::Kinetic, 1, 1, 0, 0}, Row{Stage::Potential, 1, 0, 0, 0},
                         Row{Stage::Minv, 1, 0, 0, 0}, Row{Stage::DJacobians, 1, 1, 0, 0}, Row{Stage::CentroidalMap, 1, 0, 0, 0},
                         Row{Stage::CentroidalMomentumRate, 1, 1, 1, 0}, Row{Stage::TorqueRegressor, 1, 1, 1, 0}}) {
    const bool depends[] = {row.q, row.v, row.a, row.tau};
    for (int input = 0; input < input_count; ++input) {
      Work<double> w(*m);
      w.d.mark_fresh(row.stage);
      EXPECT_TRUE(w.d.fresh(row.stage));
      w.d.changed(Input(input));
      EXPECT_EQ(!depends[input], w.d.fresh(row.stage)) << "stage " << int(row.stage) << " input " << input;
    }
  }
}

TEST(Data, TheArmsModelAndDataForInverseDynamicsFitIn33KiB) {
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  dynModel* m = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load(DYN_MODELS_DIR "/robots/panda.urdf", &options, &m)) << dyn_last_error();
  const std::size_t model = dyn_model_size(m), data = dyn_data_size(m, DYN_PART_INVERSE);
  EXPECT_GT(model, 0u);
  EXPECT_GT(data, 0u);
  EXPECT_LT(model + data, 33u * 1024) << "model " << model << " data " << data;
  RecordProperty("model_bytes", std::to_string(model));
  RecordProperty("data_bytes", std::to_string(data));
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(m, DYN_PART_INVERSE, &d));
  EXPECT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, nullptr, nullptr, nullptr, nullptr)) << dyn_last_error();
  dyn_data_free(d);
  dyn_model_free(m);
}

}  // namespace
}  // namespace dyn_test
