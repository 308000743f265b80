// Joint types, shapes, constraints, effects, integrators and contact solvers describe themselves to programs.
#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <string>

#include "capi/each_value.hpp"

namespace dyn_test {
namespace {

TEST(Reflection, JointTypesHaveTheSizesThatModelsHave) {
  each_value("dynJointType", [](const dynEnumValueInfo& value) {
    dynJointTypeInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_joint_type_info(dynJointType(value.value), &info), DYN_OK);
    EXPECT_STRNE(info.name, "");
    if (value.value == DYN_JOINT_TYPE_FIXED || value.value == DYN_JOINT_TYPE_COMPOSITE) {
      EXPECT_EQ(info.nq, 0);
      return;
    }
    dynBuilder* builder = nullptr;
    dynModel* model = nullptr;
    ASSERT_EQ(dyn_builder_new("one", &builder), DYN_OK);
    dynJointSpec spec;
    dyn_joint_spec_init(&spec);
    spec.name = "joint", spec.type = dynJointType(value.value), spec.pitch = 0.1;
    const double com[3] = {}, inertia[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    ASSERT_EQ(dyn_builder_add_joint(builder, &spec), DYN_OK) << dyn_last_error();
    ASSERT_EQ(dyn_builder_add_body(builder, "body", "joint", nullptr, 1, com, inertia), DYN_OK);
    ASSERT_EQ(dyn_builder_finish(builder, &model), DYN_OK) << dyn_last_error();
    EXPECT_EQ(info.nq, dyn_model_nq(model));
    EXPECT_EQ(info.nv, dyn_model_nv(model));
    EXPECT_STRNE(info.chain, "");
    dyn_model_free(model);
    dyn_builder_free(builder);
  });
  dynJointTypeInfo planar = {};
  planar.struct_size = sizeof planar;
  ASSERT_EQ(dyn_joint_type_info(DYN_JOINT_TYPE_PLANAR, &planar), DYN_OK);
  EXPECT_STREQ(planar.chain, "prismatic axis_x, prismatic axis_y, revolute axis");
  EXPECT_EQ(planar.axis, 1);
  EXPECT_EQ(planar.axis2, 0);
  EXPECT_EQ(dyn_joint_type_info(dynJointType(1000), &planar), DYN_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(dyn_last_error(), "_FREE_FLYER"), nullptr);
}

TEST(Reflection, ShapeTypesNameTheirSizes) {
  each_value("dynShapeType", [](const dynEnumValueInfo& value) {
    dynShapeTypeInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_shape_type_info(dynShapeType(value.value), &info), DYN_OK);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(std::strlen(info.size[k]) > 0, k < info.sizes);
    // a positive length is asked for where there is a size, and nothing else
    if (info.surface || value.value == DYN_SHAPE_TYPE_MESH) return;
    dynGeometry geometry;
    dyn_geometry_init(&geometry);
    geometry.type = dynShapeType(value.value);
    const double identity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, point[3] = {5, 0, 0};
    dynClosestPoint closest = {};
    closest.struct_size = sizeof closest;
    for (int k = 0; k < 3; ++k) geometry.size[k] = k < info.sizes ? 1 : -1;
    EXPECT_EQ(dyn_geometry_closest_point(&geometry, identity, point, &closest), DYN_OK) << dyn_last_error();
    if (info.sizes) geometry.size[info.sizes - 1] = -1;
    EXPECT_EQ(dyn_geometry_closest_point(&geometry, identity, point, &closest) == DYN_OK, info.sizes == 0);
  });
}

TEST(Reflection, ConstraintTypesAndIntegratorsHaveInfos) {
  each_value("dynConstraintType", [](const dynEnumValueInfo& value) {
    dynConstraintTypeInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_constraint_type_info(dynConstraintType(value.value), &info), DYN_OK);
    EXPECT_EQ(info.rows == 0, value.value == DYN_CONSTRAINT_TYPE_NONE || value.value == DYN_CONSTRAINT_TYPE_LOOP);
  });
  dynConstraintTypeInfo weld = {};
  weld.struct_size = sizeof weld;
  ASSERT_EQ(dyn_constraint_type_info(DYN_CONSTRAINT_TYPE_WELD, &weld), DYN_OK);
  EXPECT_EQ(weld.rows, 6);
  EXPECT_STREQ(weld.name, "weld");
  each_value("dynIntegrator", [](const dynEnumValueInfo& value) {
    dynIntegratorInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_integrator_info(dynIntegrator(value.value), &info), DYN_OK);
    EXPECT_GT(info.order, 0);
  });
}

// The array that an effect names is the one that brings it into a model.
// "damping" of DYN_MODEL_ARRAY_DAMPING
std::string name_of_array(int array) {
  std::string name;
  each_value("dynModelArray", [&](const dynEnumValueInfo& value) {
    if (value.value == array) name = value.name;
  });
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return name;
}

TEST(Reflection, EffectsNameTheirArrays) {
  int arrays = 0;
  each_value("dynEffects", [&](const dynEnumValueInfo& value) {
    dynEffectTypeInfo info = {};
    info.struct_size = sizeof info;
    if (!std::has_single_bit(unsigned(value.value)) || !(value.value & DYN_EFFECT_ALL)) {  // a set of effects, or AS_STATED
      EXPECT_EQ(dyn_effect_type_info(unsigned(value.value), &info), DYN_ERROR_ARGUMENT);
      return;
    }
    ASSERT_EQ(dyn_effect_type_info(unsigned(value.value), &info), DYN_OK) << dyn_last_error();
    EXPECT_EQ(info.bit, unsigned(value.value));
    EXPECT_STRNE(info.absent, "");
    EXPECT_EQ(std::strlen(info.quantity) > 0, info.array >= 0);
    if (info.array < 0) return;
    ++arrays;
    dynBuilder* builder = nullptr;
    dynModel* model = nullptr;
    dynData* data = nullptr;
    ASSERT_EQ(dyn_builder_new("one", &builder), DYN_OK);
    dynJointSpec spec;
    dyn_joint_spec_init(&spec);
    const double one = 1, com[3] = {}, inertia[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    spec.name = "joint", spec.type = DYN_JOINT_TYPE_REVOLUTE;
#define COEFFICIENT(member, has, sentence) \
  if (std::string(#member) == name_of_array(info.array)) spec.member = &one;
#include "../../src/effect/coefficients.def"
    ASSERT_EQ(dyn_builder_add_joint(builder, &spec), DYN_OK) << dyn_last_error();
    ASSERT_EQ(dyn_builder_add_body(builder, "body", "joint", nullptr, 1, com, inertia), DYN_OK);
    ASSERT_EQ(dyn_builder_finish(builder, &model), DYN_OK) << dyn_last_error();
    EXPECT_EQ(*dyn_model_array(model, dynModelArray(info.array)), 1);
    ASSERT_EQ(dyn_data_new(model, 0, &data), DYN_OK);
    ASSERT_EQ(dyn_data_set_effects(model, data, 0, DYN_EFFECT_ALL), DYN_OK);
    std::uint32_t acting = 0;
    ASSERT_EQ(dyn_data_effects(model, data, 0, &acting), DYN_OK);
    EXPECT_EQ(acting & ~std::uint32_t(DYN_EFFECT_SLEEPING), info.bit);
    dyn_data_free(data), dyn_model_free(model), dyn_builder_free(builder);
  });
  EXPECT_GE(arrays, 4);
  dynEffectTypeInfo info = {};
  info.struct_size = sizeof info;
  for (const std::uint32_t bit : {0u, 3u, 1u << 30, 1u << 31})
    EXPECT_EQ(dyn_effect_type_info(bit, &info), DYN_ERROR_ARGUMENT) << bit;
}

TEST(Reflection, ContactSolversHaveInfos) {
  each_value("dynContactSolverType", [](const dynEnumValueInfo& value) {
    dynContactSolverTypeInfo info = {};
    info.struct_size = sizeof info;
    ASSERT_EQ(dyn_contact_solver_type_info(dynContactSolverType(value.value), &info), DYN_OK);
    EXPECT_EQ(info.refined, value.value != DYN_CONTACT_SOLVER_TYPE_PGS);
    EXPECT_EQ(std::strlen(info.sentence) > 0, true);
  });
}

}  // namespace
}  // namespace dyn_test
