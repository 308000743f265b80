// Every entry point on robots of all kinds, as calls that can be made any number of times: results and errors alike.
#pragma once

#include <array>
#include <functional>

#include "capi/calls.hpp"
#include "capi/surfaces.hpp"

namespace dyn_test {

struct Robot {
  const char* name;
  Model m;
};
// Two pyramids and a ball over a height field.
inline Model surfaces() {
  const Surfaces made;
  Builder b("surfaces");
  b.body("ground", nullptr, 0, {0, 0, 0}, no_inertia);
  const auto shape = [&](const char* body, dynShapeType type, const dynMesh* surface) {
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = body, s.type = type, s.surface = surface, s.size[0] = 0.2;
    EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
  };
  shape("ground", DYN_SHAPE_TYPE_HEIGHT_FIELD, made.field);
  for (const char* name : {"one", "two", "ball"}) {
    b.joint(Spec((std::string(name) + "_joint").c_str(), DYN_JOINT_TYPE_FREE_FLYER))
        .body(name, (std::string(name) + "_joint").c_str());
    const bool ball = std::string(name) == "ball";
    shape(name, ball ? DYN_SHAPE_TYPE_SPHERE : DYN_SHAPE_TYPE_TRIANGLES, ball ? nullptr : made.pyramid);
  }
  return b.finish();
}

inline std::vector<Robot> robots() {
  std::vector<Robot> all;
  all.push_back({"panda", robot("panda")});
  all.push_back({"go2", robot("go2", DYN_BASE_FLOATING)});
  all.push_back({"humanoid", robot("humanoid", DYN_BASE_FLOATING)});
  all.push_back({"gripper", robot("gripper")});
  all.push_back({"all types", all_types()});
  all.push_back({"all types without mimic", all_types(false)});
  all.push_back({"singular", singular_at_zero()});
  all.push_back({"singular with mimic", singular_at_zero(true)});
  all.push_back({"surfaces", surfaces()});
  return all;
}

// A call with its name, ready to be made any number of times.
struct Ready {
  std::string name;
  std::function<void()> call;
};

// All that may be asked of a model and a data once they exist. Everything that the calls point to lives in Work.
struct Work {
  const Model& m;
  Data d, foreign_data;
  State s, odd;
  std::vector<std::unique_ptr<Prepared>> prepared;
  std::vector<unsigned char> memory;
  std::unique_ptr<unsigned char, void (*)(void*)> image{nullptr, std::free};
  std::size_t image_bytes = 0;
  Numbers x, y, J1, J2, parameters, peer = Numbers(1000);
  std::vector<const char*> names;
  std::vector<std::int32_t> ids;
  std::string long_name = std::string(3000, 'n');
  std::vector<Ready> calls;

  explicit Work(const Model& model)
      : m(model),
        d(m),
        foreign_data(m),
        s(random_state(m, 1)),
        odd(random_state(m, 2)),
        memory(dyn_data_size(m, 0)),
        x(s.q),
        y(random_state(m, 3).q),
        J1(std::size_t(m.nv() * m.nv()) + 100),
        J2(J1),
        parameters(10 * std::size_t(m.njoints())) {
    for (int j = 1; j < m.njoints(); ++j) names.push_back(dyn_model_joint_name(m, j));
    names.push_back(dyn_model_joint_name(m, 1));
    ids.resize(names.size());
    for (double& e : odd.v) e = 1e200;
    functions_of_data();
    functions_of_a_model();
  }

  void add(std::string name, std::function<void()> f) { calls.push_back({std::move(name), std::move(f)}); }
  Prepared& prepare(const CallRow& row, const State& state) {
    prepared.push_back(std::make_unique<Prepared>(row, m, state));
    return *prepared.back();
  }
  void call(const std::string& what, Prepared& p) {
    add(std::string(p.row.name) + what, [this, &p] { p(m, d); });
  }

  void functions_of_data() {
    for (const CallRow& row : call_rows) {
      call("", prepare(row, s));
      for (dynReference r : {DYN_REFERENCE_WORLD, DYN_REFERENCE_LOCAL_WORLD_ALIGNED})
        if (row.uses & uses_reference) prepare(row, s).x.reference = r, call(" in another reference", *prepared.back());
    }
    prepare(call_row("dyn_step"), s).x.integrator = DYN_INTEGRATOR_RK4, call(" RK4", *prepared.back());
    // inverse kinematics that has to search: J kept as it is, and its normal equations, with limits, restarts and a posture
    for (int count : {1, 3})
      add("dyn_ik of " + std::to_string(count) + " tasks", [this, count] {
        dynIkTask tasks[3];
        for (dynIkTask& t : tasks) dyn_ik_task_init(&t);
        tasks[0].type = DYN_IK_TASK_TYPE_POSITION, tasks[0].frame = m.nframes() - 1, tasks[0].target[9] = 9;
        tasks[1].type = DYN_IK_TASK_TYPE_COM;
        tasks[2].type = DYN_IK_TASK_TYPE_POSTURE, tasks[2].posture = s.q.data(), tasks[2].priority = 1;
        dynIkResult result{};
        result.struct_size = sizeof result;
        dyn_ik(m, d, s.q.data(), tasks, count, nullptr, with<dynIkOutput>({0, nullptr, nullptr, &result}));
      });
    // errors
    for (const CallRow& row : call_rows) {
      Prepared& p = prepare(row, s);
      add(std::string(row.name) + " without data", [this, &p] { p(m, nullptr); });
      add(std::string(row.name) + " without model", [this, &p] { p(nullptr, d); });
      if (row.uses & uses_q) prepare(row, s).s.q[0] = nan, call(" NaN", *prepared.back());
      if (row.uses & uses_v) call(" overflow", prepare(row, odd));
      if (row.uses & uses_q) {
        Prepared& zero = prepare(row, s);
        std::fill(zero.s.q.begin(), zero.s.q.end(), 0.0);
        call(" zero", zero);  // a zero quaternion, or a singular configuration
      }
      if (row.uses & uses_frame) prepare(row, s).x.frame = -1, call(" no frame", *prepared.back());
      if (row.uses & uses_joint) prepare(row, s).x.joint = 1 << 20, call(" no joint", *prepared.back());
    }
    prepare(call_row("dyn_step"), s).x.dt = 1e300, call(" too far", *prepared.back());
    prepare(call_row("dyn_all_terms"), s).x.mask = ~0u, call(" mask", *prepared.back());
  }

  void functions_of_a_model() {
    add("sizes", [this] {
      dyn_model_nq(m), dyn_model_nv(m), dyn_model_njoints(m), dyn_model_nframes(m), dyn_model_nbodies(m), dyn_model_size(m),
          dyn_model_total_mass(m), dyn_model_report_count(m), dyn_model_nshapes(m);
      dyn_model_nconfigurations(m), dyn_field_count(), dyn_data_size(m, 0), dyn_model_name(m), dyn_version(), dyn_build_info(),
          dyn_last_error();
      dyn_status_name(DYN_OK), dyn_data_size(m, ~0u), dyn_model_nq(nullptr);
    });
    add("infos", [this] {
      dynJointInfo joint{};
      dynFrameInfo frame{};
      dynShapeInfo shape{};
      dynReportEntry entry{};
      dynFieldInfo field{};
      joint.struct_size = sizeof joint, frame.struct_size = sizeof frame, shape.struct_size = sizeof shape;
      entry.struct_size = sizeof entry, field.struct_size = sizeof field;
      for (int k = -1; k <= m.nframes(); ++k) {
        dyn_model_joint_info(m, k, &joint), dyn_model_frame_info(m, k, &frame), dyn_model_shape_info(m, k, &shape),
            dyn_model_report_entry(m, k, &entry);
        dyn_field_info(k, &field), dyn_model_joint_name(m, k), dyn_model_frame_name(m, k), dyn_model_configuration_name(m, k);
      }
      for (int which = -1; which <= 8; ++which) dyn_model_array(m, dynModelArray(which < 0 ? 8 : which));
    });
    add("inertial parameters", [this] {
      Numbers& pi = J1;
      int answer;
      for (double mass : {2.0, -1.0, nan}) {
        const double body[10] = {mass, 0.1, 0.2, 0, 1, 0, 1, 0, 0, 1};
        dyn_pseudo_inertia_from_parameters(body, J2.data()), dyn_parameters_from_pseudo_inertia(J2.data(), pi.data());
        dyn_log_cholesky_from_parameters(body, J2.data()), dyn_is_physically_consistent(body, &answer),
            dyn_body_regressor(body, body, J2.data());
        dyn_parameters_from_log_cholesky(body, J2.data()), dyn_log_cholesky_jacobian(body, J2.data());
      }
      dyn_model_inertial_parameters(m, parameters.data()), dyn_model_inertial_parameters(nullptr, pi.data());
    });
    add("names", [this] {
      for (const char* name : names)
        dyn_model_joint_id(m, name), dyn_model_frame_id(m, name), dyn_model_frame_id_of_type(m, name, DYN_FRAME_TYPE_JOINT);
      dyn_field_id("M");
    });
    add("unknown names", [this] {
      for (const char* name : {"Joint", "free_", "panda_link", "", long_name.c_str()}) {
        dyn_model_joint_id(m, name), dyn_model_frame_id(m, name), dyn_field_id(name), dyn_model_configuration(m, name, x.data());
        dyn_model_frame_id_of_type(m, name, DYN_FRAME_TYPE_BODY);
      }
    });
    add("permutation", [this] {
      dyn_model_q_permutation(m, names.data(), names.size() - 1, ids.data(), ids.data());
      dyn_model_q_permutation(m, names.data(), names.size(), ids.data(), ids.data());
    });
    add("data in memory", [this] {
      dynData* placed = nullptr;
      dyn_data_init(m, 0, memory.data(), memory.size(), &placed);
      dyn_crba(m, placed, nullptr, nullptr);
      dyn_data_free(placed), dyn_data_free(placed);
      dyn_data_init(m, 0, memory.data(), 3, &placed);
    });
    dyn_model_image(m, 0, nullptr, 0, &image_bytes);
    image.reset(static_cast<unsigned char*>(std::aligned_alloc(64, (image_bytes + 63) / 64 * 64)));
    dyn_model_image(m, 0, image.get(), image_bytes, &image_bytes);
    add("a model in place", [this] {
      const dynModel* placed = nullptr;
      EXPECT_EQ(DYN_OK, dyn_model_from_buffer(image.get(), image_bytes, &placed)) << dyn_last_error();
      dyn_model_from_buffer(image.get(), image_bytes - 1, &placed), dyn_model_from_buffer(image.get() + 1, image_bytes, &placed);
    });
    add("other libraries' states", [this] {
      dynStateLayout layout;
      dyn_state_layout_init(&layout);
      for (const dynConvention c : {DYN_CONVENTION_PINOCCHIO, DYN_CONVENTION_MUJOCO, DYN_CONVENTION_DRAKE, DYN_CONVENTION_ROS}) {
        layout.convention = c;
        int nq = 0, nv = 0;
        if (dyn_state_layout_sizes(m, &layout, &nq, &nv) != DYN_OK || std::size_t(nq + nv) > peer.size())
          continue;  // ROS: joints of one coordinate
        dyn_state_layout_convert(m, &layout, DYN_DIRECTION_TO_PEER,
                                 with<dynStateInput>({0, s.q.data(), s.v.data(), nullptr, nullptr}),
                                 with<dynStateOutput>({0, peer.data(), peer.data() + nq, nullptr, nullptr}));
        dyn_state_layout_convert(m, &layout, DYN_DIRECTION_FROM_PEER,
                                 with<dynStateInput>({0, peer.data(), peer.data() + nq, nullptr, nullptr}),
                                 with<dynStateOutput>({0, J1.data(), J2.data(), nullptr, nullptr}));
      }
      layout.joints = names.data(), layout.joints_count = names.size();
      dyn_state_layout_convert(m, &layout, DYN_DIRECTION_TO_PEER, with<dynStateInput>({0, s.q.data(), nullptr, nullptr, nullptr}),
                               with<dynStateOutput>({0, peer.data(), nullptr, nullptr, nullptr}));
      dyn_state_layout_convert(m, nullptr, DYN_DIRECTION_TO_PEER, nullptr, nullptr);
    });
    add("configurations", [this] {
      double* out = J1.data();
      int answer;
      dyn_configuration_neutral(m, out), dyn_configuration_random(m, 7, nullptr, nullptr, out),
          dyn_model_configuration(m, "neutral", out);
      dyn_integrate(m, x.data(), s.v.data(), out), dyn_difference(m, x.data(), y.data(), out),
          dyn_interpolate(m, x.data(), y.data(), 0.3, out);
      dyn_configuration_distance(m, x.data(), y.data(), out), dyn_configuration_is_normalized(m, x.data(), 1e-9, &answer),
          dyn_configuration_normalize(m, x.data());
      dyn_integrate_jacobians(m, x.data(), s.v.data(), J1.data(), J2.data()),
          dyn_difference_jacobians(m, x.data(), y.data(), J1.data(), J2.data());
      dyn_integrate(m, x.data(), odd.v.data(), out), dyn_configuration_random(nullptr, 1, nullptr, nullptr, out),
          dyn_configuration_distance(m, nullptr, nullptr, out);
    });
  }
};

}  // namespace dyn_test
