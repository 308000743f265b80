// .dynb files: a round trip is bit for bit exact, and no file crashes the reader.
#include "collision/pairs.hpp"
#include "load/dynb.hpp"
#include "model/builder_surface.hpp"
#include "save/same.hpp"

namespace dyn_test {
namespace {

std::string bytes_of(const Model& m) { return save_dynb(m); }

void expect_identical(const Model& m) {
  const std::string saved = bytes_of(m);
  const ModelPtr back = load_string(saved, {});
  const std::string again = bytes_of(*back);
  ASSERT_EQ(saved.size(), again.size());
  EXPECT_TRUE(saved == again);
  EXPECT_NE(m.id, back->id);
}

SurfacePtr tetrahedron() {
  const double x[8] = {0, 1, 0, 0}, y[8] = {0, 0, 1, 0}, z[8] = {0, 0, 0, 1, 1, 1, 1, 1},
               s = std::sqrt(1 / 3.0);  // the last vertex repeated
  const double planes[16] = {0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, 0, s, s, s, s};
  const Index start[5] = {0, 3, 6, 9, 12}, faces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3},
              neighbours[12] = {1, 2, 3, 0, 2, 3, 0, 1, 3, 0, 1, 2};
  const shape::Hull h{Vec3<double>::make(0.25, 0.25, 0.25), 4, 4, 12, x, y, z, planes, start, faces, start, neighbours, 1};
  return std::make_shared<SurfaceData>(SurfaceData{Held<shape::Hull>(h)});
}

// A model with everything that a block may hold: shapes with arrays, an actuator, a constraint, a pair, a configuration.
ModelPtr furnished() {
  Tree t = random_tree(4, {5, 0.3, 0.3, 0.1, 0.35, 0.5, {}});
  Builder b("furnished");
  for (const JointSpec& s : t.joints) b.joint(s);
  for (const BodySpec& s : t.bodies)
    b.body(s.name, {s.parent, 0}, placement(s.placement), s.mass, array3(s.com), array9(s.inertia));
  Dice dice(8);
  std::vector<double> corners;
  std::vector<Index> faces;
  for (int k = 0; k < 20; ++k) {
    for (int i = 0; i < 9; ++i) corners.push_back(dice.in(-1, 1));
    faces.insert(faces.end(), {3 * k, 3 * k + 1, 3 * k + 2});
  }
  Shape soup{"soup", DYN_SHAPE_TYPE_TRIANGLES, DYN_SHAPE_ROLE_COLLISION, t.bodies[0].name, placement(dice.pose(5)), {1, 1, 1},
             ""};
  soup.surface = triangle_tree(corners, faces, false);
  b.shape(soup);
  const std::vector<double> heights = {0, 0.1, 0.2, 0, 0.3, 0.1, 0.2, 0.1, 0};
  Shape ground{"ground", DYN_SHAPE_TYPE_HEIGHT_FIELD, DYN_SHAPE_ROLE_COLLISION, "universe", placement(dice.pose(5)), {1, 1, 1},
               ""};
  ground.surface = height_grid(heights.data(), 3, 3, 1, 1, -1);
  b.shape(ground);
  Shape hull{"hull", DYN_SHAPE_TYPE_CONVEX, DYN_SHAPE_ROLE_COLLISION, t.bodies[2].name, placement(dice.pose(5)), {1, 1, 1}, ""};
  hull.surface = tetrahedron();
  b.shape(hull);
  b.shape({"box", DYN_SHAPE_TYPE_BOX, DYN_SHAPE_ROLE_COLLISION, t.bodies[1].name, placement(dice.pose(5)), {1, 2, 3}, ""});
  b.pair("box", "ground", nullptr);
  for (const JointSpec& s : t.joints)
    if (s.type != DYN_JOINT_TYPE_FIXED && s.mimic.empty()) {
      dynActuator a{};
      a.struct_size = sizeof a, a.gear = 1, a.control_range[0] = a.force_range[0] = -1, a.control_range[1] = a.force_range[1] = 1;
      b.actuator("motor", a, s.name);
      break;
    }
  dynConstraint c{};
  c.struct_size = sizeof c, c.type = DYN_CONSTRAINT_TYPE_WELD, c.enabled = 1;
  std::copy(identity_placement.begin(), identity_placement.end(), c.placement1),
      std::copy(identity_placement.begin(), identity_placement.end(), c.placement2);
  b.constraint("weld", c, {t.bodies[0].name, DYN_FRAME_TYPE_BODY}, {"", 0});
  b.disabled_pair(t.bodies[0].name, t.bodies[1].name, "because");
  b.report(DYN_REPORT_LEVEL_INFO, 3, "a remark");
  b.medium(1, 0.1, {1, 2, 3});
  b.contact_capacity(5);
  const ModelPtr m = b.finish();
  const State x(*m, 2);
  b.configuration("home", {x.q.begin(), x.q.end()});
  return b.finish();
}

TEST(Dynb, ModelsComeBackBitForBit) {
  for (const auto& [path, base] : robots()) {
    SCOPED_TRACE(path);
    expect_identical(*robot(path, base));
  }
  for (std::uint64_t seed = 1; seed <= tree_count; ++seed) {
    SCOPED_TRACE(seed);
    expect_identical(*random_tree(seed).build());
  }
  expect_identical(*furnished());
}

TEST(Dynb, OtherFilesAreRefused) {
  const std::string good = bytes_of(*furnished());
  const auto refused = [&](std::string bytes, dynStatus status, const char* why) {
    try {
      load_string(bytes, {});
      ADD_FAILURE() << why;
    } catch (const Error& e) {
      EXPECT_EQ(status, e.status) << e.what();
      EXPECT_NE(std::string::npos, std::string(e.what()).find(why)) << e.what();
    }
  };
  const auto changed = [&](std::size_t at) {
    std::string out = good;
    out[at] = char(out[at] ^ 0x10);
    return out;
  };
  refused(changed(5), DYN_ERROR_PARSE, "first eight bytes");
  refused(changed(offsetof(DynbHeader, version)), DYN_ERROR_UNSUPPORTED, "version");
  refused(changed(offsetof(DynbHeader, byte_order)), DYN_ERROR_UNSUPPORTED, "order of bytes");
  refused(changed(offsetof(DynbHeader, tag) + 1), DYN_ERROR_UNSUPPORTED, "build");
  refused(changed(offsetof(DynbHeader, tag)), DYN_ERROR_PARSE, "checksum");  // the number of coefficients
  refused(changed(offsetof(DynbHeader, bytes)), DYN_ERROR_PARSE, "bytes after its header");
  refused(changed(offsetof(DynbHeader, handle)), DYN_ERROR_PARSE, "checksum");
  refused(changed(good.size() / 2), DYN_ERROR_PARSE, "checksum");
  refused(good.substr(0, good.size() - 8), DYN_ERROR_PARSE, "bytes after its header");
  refused(good.substr(0, 20), DYN_ERROR_PARSE, "within its header");
  LoadOptions options;
  options.base = DYN_BASE_FIXED;
  EXPECT_THROW(load_string(good, options), Error);
}

// Every modified file is refused, or gives a model on which all algorithms run.
void fuzz(bool sealed) {
  const ModelPtr m = furnished();
  const std::string good = bytes_of(*m);
  Dice dice(sealed ? 3 : 4);
  int loaded = 0, refused = 0;
  for (int k = 0; k < 20000; ++k) {
    std::string bad = good;
    const int kind = dice.below(4);
    if (kind == 0) bad.resize(std::size_t(dice.below(int(bad.size()))));
    for (int flips = kind == 0 ? dice.below(2) : 1 + dice.below(4); flips > 0; --flips) {
      if (bad.empty()) break;
      const std::size_t at = std::size_t(dice.below(int(bad.size())));
      if (kind == 3) {  // a whole index: negative, large, off by one
        const std::int32_t values[] = {-1, 1 << 30, INT32_MAX, INT32_MIN, 1000, 0}, x = values[dice.below(6)];
        if (bad.size() >= 8) std::memcpy(bad.data() + at / 4 * 4 % (bad.size() - 4) / 4 * 4, &x, 4);
      } else {
        bad[at] = char(bad[at] ^ (1 << dice.below(8)));
      }
    }
    if (bad == good) continue;
    if (sealed && bad.size() >= sizeof(DynbHeader)) load::seal_dynb(bad);
    try {
      const ModelPtr back = load_string(bad, {});
      EXPECT_TRUE(sealed) << "a file with a wrong checksum was read";
      ++loaded;
      if (loaded % 16 == 0 && back->n.nv == m->n.nv) Results(*back, State(*m, 1).q, VectorXd::Zero(m->n.nv));
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_EQ(sealed, loaded > 100);
}

// A block used in place is not rebuilt. Modifies every byte and sets every index out of range, with a valid checksum. A block
// that is still accepted must be safe: its algorithms stay within their own memory (checked by sanitizers).
void fuzz_in_place(const Model& m, int every) {
  std::string file = bytes_of(m);
  const std::size_t header = sizeof(DynbHeader);
  const std::unique_ptr<void, void (*)(void*)> memory(std::aligned_alloc(64, file.size()), std::free);
  ASSERT_EQ(0u, file.size() % 64);
  int taken = 0, refused = 0;
  const auto use = [&] {
    load::seal_dynb(file);
    std::memcpy(memory.get(), file.data(), file.size());
    if (check_dynb(memory.get(), file.size())) {
      ++refused;
      return;
    }
    if (++taken % every) return;
    const Model& bad = *reinterpret_cast<const Model*>(static_cast<const char*>(memory.get()) + header);
    Work<double> w(bad);
    w.v(VectorXd::Ones(bad.n.nv)).a(VectorXd::Ones(bad.n.nv));
    VectorXd x(bad.n.nv);
    inverse_dynamics<double>(w.m, w.d, w.d.v, w.d.a, nullptr, x.data());
    forward_dynamics<double>(w.m, w.d, w.d.v, w.d.a, nullptr, x.data());
    crba(w.m, w.d);
    factorize(w.m, w.d);
    if (w.d.geoms) collision::distances(w.m, w.d);
  };
  for (std::size_t at = header; at < file.size(); ++at) {
    const char before = file[at];
    file[at] = char(before ^ (1 << (at * 5 % 8)));
    use();
    file[at] = before;
  }
  for (std::size_t at = header; at + 4 <= file.size(); at += 4) {
    std::int32_t before, x;
    std::memcpy(&before, file.data() + at, 4);
    const std::int32_t values[] = {-1, 1 << 30, INT32_MAX, INT32_MIN, before + 1, 0};
    x = values[at / 4 % 6];
    std::memcpy(file.data() + at, &x, 4), use(), std::memcpy(file.data() + at, &before, 4);
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(taken, 100);
  use();
  EXPECT_FALSE(check_dynb(memory.get(), file.size())) << check_dynb(memory.get(), file.size()).what;
}

TEST(Dynb, WhatIsUsedInPlaceIsCheckedWhole) { fuzz_in_place(*furnished(), 16); }
TEST(Dynb, WhatIsUsedInPlaceIsCheckedWholeWithMimic) {
  fuzz_in_place(*robot(std::string(DYN_MODELS_DIR) + "/robots/gripper.urdf", DYN_BASE_FIXED), 16);
}

// Found by fuzzing under sanitizers: a depth whose double overflows.
TEST(Dynb, DepthsOfTheEliminationTreeAreChecked) {
  const ModelPtr m = furnished();
  std::string file = bytes_of(*m);
  const std::size_t at =
      sizeof(DynbHeader) + std::size_t(reinterpret_cast<const char*>(m->dof_depth()) - reinterpret_cast<const char*>(m.get()));
  const std::unique_ptr<void, void (*)(void*)> memory(std::aligned_alloc(64, file.size()), std::free);
  for (Index k = 0; k < m->n.nv; ++k) {
    std::string bad = file;
    const std::int32_t depth = 1577058305;
    std::memcpy(bad.data() + at + 4 * std::size_t(k), &depth, 4);
    load::seal_dynb(bad);
    std::memcpy(memory.get(), bad.data(), bad.size());
    EXPECT_STREQ("depths of the elimination tree", check_dynb(memory.get(), bad.size()).what);
  }
}

// Other versions of the library have other rules for the room for contacts.
TEST(Dynb, FilesOfAnotherRuleForContactsAreRead) {
  const ModelPtr m = robot(std::string(DYN_MODELS_DIR) + "/robots/go2.urdf", DYN_BASE_FLOATING);
  const auto with_capacity = [&](Index contacts) {
    std::string file = bytes_of(*m);
    const auto at = reinterpret_cast<const char*>(&m->n.contacts) - reinterpret_cast<const char*>(m.get());
    std::memcpy(file.data() + sizeof(DynbHeader) + at, &contacts, sizeof contacts);
    load::seal_dynb(file);
    return file;
  };
  EXPECT_EQ(m->n.contacts, load_string(with_capacity(208), {})->n.contacts);  // loading builds the model anew
  EXPECT_THROW(load_string(with_capacity(50001), {}), Error);
  EXPECT_THROW(load_string(with_capacity(-1), {}), Error);
}

// Every block that a builder makes is accepted in place and gives the same model.
TEST(Dynb, EveryModelIsTakenInPlace) {
  const auto expect_taken = [](const Model& m) {
    const std::string file = bytes_of(m);
    const std::unique_ptr<void, void (*)(void*)> memory(std::aligned_alloc(64, file.size()), std::free);
    std::memcpy(memory.get(), file.data(), file.size());
    const Damage d = check_dynb(memory.get(), file.size());
    ASSERT_FALSE(d) << d.what << ": " << d.value << " of " << d.count;
    const dynModel& placed = static_cast<const DynbHeader*>(memory.get())->handle;
    EXPECT_EQ(bytes_of(m), bytes_of(*placed.m));
  };
  for (const auto& [path, base] : robots()) {
    SCOPED_TRACE(path);
    expect_taken(*robot(path, base));
  }
  for (std::uint64_t seed = 1; seed <= tree_count; ++seed) {
    SCOPED_TRACE(seed);
    expect_taken(*random_tree(seed).build());
  }
  expect_taken(*furnished());
}

TEST(Dynb, DamagedFilesAreRefused) { fuzz(false); }
TEST(Dynb, FilesThatAreSealedAgainDoNoHarm) { fuzz(true); }

}  // namespace
}  // namespace dyn_test
