// .dynb files of libraries with fewer or more effects, and so with another number of coefficients for each degree of freedom.
#include <algorithm>
#include <cstring>

#include "effect/list.hpp"
#include "load/dynb.hpp"
#include "save/same.hpp"

namespace dyn_test {
namespace {

constexpr int own_count = int(coefficient_count);

// Where an unknown coefficient is 1: of the first joint alone (as that of a follower), or of the first degree of freedom alone.
enum class Unknown { Zero, OfJoint, OfDof };

// Writes an array behind the others.
struct Block {
  std::string bytes, offsets;
  void begin(std::size_t boundary) {
    bytes.resize((bytes.size() + boundary - 1) / boundary * boundary);
    const std::uint32_t at = std::uint32_t(bytes.size() / 8);
    offsets.append(reinterpret_cast<const char*>(&at), sizeof at);
  }
  template <class T>
  void add(const T* from, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(from), count * sizeof(T));
  }
};

// A joint begins with what is of no effect, then come its coefficients and where its spring rests.
void add_joint(Block& block, const JointRecord& r, int count, bool unknown) {
  const std::size_t begin = block.bytes.size();
  block.add(reinterpret_cast<const char*>(&r), offsetof(JointRecord, armature));
  block.add(&r.armature, std::size_t(std::min(count, own_count)));
  for (int k = own_count; k < count; ++k) {
    const double x = unknown;
    block.add(&x, 1);
  }
  block.add(&r.spring_reference, 1);
  constexpr std::size_t boundary = alignof(JointRecord);
  block.bytes.resize(begin + (block.bytes.size() - begin + boundary - 1) / boundary * boundary);
}

// The file of a library that knows the first `count` coefficients, some of which may be unknown here.
std::string file_with(int count, const Model& m, Unknown unknown = Unknown::Zero, std::uint32_t effects = 0) {
  Block block;
  const std::size_t fields = std::size_t(Model::Field::count_) - coefficient_count + std::size_t(count);
  const std::size_t head = (offsetof(Model, offset) + fields * 4 + alignof(Model) - 1) / alignof(Model) * alignof(Model);
  block.bytes.resize(head);
  const ModelSizes& n = m.n;
  int coefficient = 0;
  const auto add_field = [&]<class T>(const T* from, std::int64_t size, Model::Field field) {
    const bool is_coefficient = field >= Model::Field::armature && field < Model::Field::spring_reference;
    if (is_coefficient && coefficient++ >= count) return;
    block.begin(alignof(T) > 8 ? 64 : 8);
    if constexpr (std::is_same_v<T, JointRecord>) {
      for (Index k = 0; k < m.n.joints; ++k) add_joint(block, from[k], count, k == 1 && unknown == Unknown::OfJoint);
    } else {
      block.add(from, std::size_t(size));
    }
    if (field == Model::Field::simulation && effects)
      std::memcpy(block.bytes.data() + block.bytes.size() - sizeof(SimulationRecord) + offsetof(SimulationRecord, effects),
                  &effects, sizeof effects);
    for (int k = own_count; k < count && is_coefficient && coefficient == own_count; ++k) {
      block.begin(8);
      for (Index i = 0; i < m.n.nv; ++i) {
        const double x = unknown == Unknown::OfDof && i == 0;
        block.add(&x, 1);
      }
    }
  };
#define FIELD(type, name, count, sentence) add_field(m.name(), std::int64_t(count), Model::Field::name);
#include "model/model_fields.def"
#undef FIELD
  block.bytes.resize((block.bytes.size() + 63) / 64 * 64);
  std::memcpy(block.bytes.data(), &m, offsetof(Model, offset));
  const std::uint64_t size = block.bytes.size();
  std::memcpy(block.bytes.data() + offsetof(Model, bytes), &size, sizeof size);
  std::memcpy(block.bytes.data() + offsetof(Model, offset), block.offsets.data(), block.offsets.size());
  std::string file = std::string(sizeof(DynbHeader), '\0') + block.bytes;
  load::seal_dynb(file, dynb_layout() | std::uint64_t(count));
  return file;
}

// Random joints whose coefficients from the given number on are zero.
ModelPtr model_with(int count, std::uint64_t seed) {
  TreeOptions options;
  options.joints = 6, options.resistance = 0.6;
  Tree tree = random_tree(seed, options);
  for (JointSpec& s : tree.joints) {
    std::vector<double>* const all[] = {
#define COEFFICIENT(name, has, sentence) &s.name,
#include "effect/coefficients.def"
    };
    for (int k = count; k < own_count; ++k) all[k]->clear();
    if (s.stiffness.empty()) s.spring_reference.clear();
  }
  return tree.build();
}

void expect_refused(const std::string& file, dynStatus status, const char* why) {
  try {
    load_string(file, {});
    ADD_FAILURE() << why;
  } catch (const Error& e) {
    EXPECT_EQ(status, e.status) << e.what();
    EXPECT_NE(std::string::npos, std::string(e.what()).find(why)) << e.what();
  }
}

// In the order of coefficients.def.
struct Listed {
  std::vector<int> arrays = std::vector<int>(coefficient_count);
  std::vector<std::uint32_t> bits = std::vector<std::uint32_t>(coefficient_count);
  Listed() {
    struct {
#define COEFFICIENT(name, has, sentence) std::size_t name = std::size_t(Model::Field::name) - first_coefficient;
#include "effect/coefficients.def"
    } const number;
    for_each_coefficient([&]<class E>() { arrays[E::of(number)] = E::array, bits[E::of(number)] = E::bit; });
  }
};

// A file has the first ones.
TEST(DynbCoefficients, NewOnesStandAtTheEndOfTheirList) {
  const std::vector<int> arrays = Listed().arrays;
  EXPECT_TRUE(std::is_sorted(arrays.begin(), arrays.end())) << "coefficients.def has not the order of dynModelArray";
}

TEST(DynbCoefficients, ThoseThatAFileLacksAreZero) {
  for (int count = 0; count < own_count; ++count)
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const ModelPtr m = model_with(count, seed);
      EXPECT_TRUE(save_dynb(*m) == save_dynb(*load_string(file_with(count, *m), {}))) << count << " of " << seed;
    }
}

TEST(DynbCoefficients, UnknownOnesMayBeZero) {
  for (int count : {own_count + 1, own_count + 4})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const ModelPtr m = model_with(own_count, seed);
      EXPECT_TRUE(save_dynb(*m) == save_dynb(*load_string(file_with(count, *m), {}))) << count << " of " << seed;
    }
}

TEST(DynbCoefficients, UnknownOnesAreRefusedWhereTheyAct) {
  const ModelPtr m = model_with(own_count, 3);
  for (int count : {own_count + 1, own_count + 4})
    for (Unknown unknown : {Unknown::OfJoint, Unknown::OfDof})
      expect_refused(file_with(count, *m, unknown), DYN_ERROR_UNSUPPORTED, "newer library");
}

TEST(DynbCoefficients, StepsApplyEffectsThatTheFileDidNotKnow) {
  const ModelPtr m = model_with(own_count - 1, 3);
  const std::uint32_t last = Listed().bits.back(), unknown = 1u << 30;
  const std::uint32_t known = DYN_EFFECT_ALL & ~std::uint32_t(DYN_EFFECT_DAMPING | DYN_EFFECT_SLEEPING);
  EXPECT_EQ(known, load_string(file_with(own_count - 1, *m, Unknown::Zero, known & ~last), {})->simulation()->effects);
  EXPECT_EQ(known, load_string(file_with(own_count + 1, *m, Unknown::Zero, known | unknown), {})->simulation()->effects);
}

TEST(DynbCoefficients, InPlaceTheirNumberIsTheLibrarys) {
  const ModelPtr m = model_with(0, 3);
  for (int count : {own_count - 1, own_count + 1}) {
    const std::string file = file_with(count, *m);
    const Damage d = check_dynb(file.data(), file.size());
    EXPECT_EQ(DYN_ERROR_UNSUPPORTED, d.status);
    EXPECT_EQ(count, d.value);
    EXPECT_EQ(own_count, d.count);
  }
}

TEST(DynbCoefficients, DamageIsAnErrorWhereverItIs) {
  for (int count : {own_count - 1, own_count + 1}) {
    const std::string good = file_with(count, *model_with(own_count - 1, 3));
    for (std::size_t k = 0; k < good.size(); ++k) {
      std::string bad = good;
      bad[k] = char(bad[k] ^ 0x5a);
      EXPECT_THROW(load_string(bad, {}), Error) << k;
    }
    expect_refused(good.substr(0, good.size() - 8), DYN_ERROR_PARSE, "bytes after its header");
    expect_refused(good.substr(0, 20), DYN_ERROR_PARSE, "within its header");
    std::string bad = good;
    bad[bad.size() / 2] = char(bad[bad.size() / 2] ^ 1);
    expect_refused(bad, DYN_ERROR_PARSE, "checksum");
  }
}

// Sizes and offsets out of range behind a right checksum are refused before anything is read by them.
TEST(DynbCoefficients, DamageBehindARightChecksumIsAnErrorOrHarmless) {
  for (int count : {own_count - 1, own_count + 1}) {
    const std::string good = file_with(count, *model_with(own_count - 1, 3));
    const std::uint64_t tag = dynb_layout() | std::uint64_t(count);
    int refused = 0, loaded = 0;
    for (std::size_t at = sizeof(DynbHeader); at < good.size(); at += 4)
      for (const std::int32_t x : {-1, 1 << 30, INT32_MIN, 1000}) {
        std::string bad = good;
        std::memcpy(bad.data() + at, &x, sizeof x);
        load::seal_dynb(bad, tag);
        try {
          load_string(bad, {});
          ++loaded;
        } catch (const Error&) {
          ++refused;
        }
      }
    EXPECT_GT(refused, 1000);
    EXPECT_GT(loaded, 100);
  }
}

}  // namespace
}  // namespace dyn_test
