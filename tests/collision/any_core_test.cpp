// Shapes known at run time, which boards compile the narrow phase over, against shapes known at compile time.
#include "collision/convex_methods.hpp"
#include "collision/every_pair.hpp"

namespace dyn_test {
namespace {

struct AnyTally {
  int poses = 0, other_flags = 0;
};

template <class A, class B>
void compare(Case kind, int count, AnyTally& tally) {
  const auto scratch = std::make_unique<collision::Workspace>();
  for (int i = 0; i < count; ++i) {
    const Scene s = scene(A::type, B::type, kind, std::uint64_t(i));
    SCOPED_TRACE(std::string(name_of(A::type)) + " " + name_of(B::type) + " " + name_of(kind) + " " + std::to_string(i));
    const A a(s.a.shape);
    const B b(s.b.shape);
    const collision::Difference<A, B> own(a, b, collision::relative(s.A, s.B));
    using Core = collision::AnyCore<A::curved || B::curved>;
    const Core any_a(s.a.shape), any_b(s.b.shape);
    const collision::Difference<Core, Core> any(any_a, any_b, own.X);
    EXPECT_EQ(own.small, any.small);
    EXPECT_EQ(own.large, any.large);
    const collision::Options options;
    const collision::Cores c = collision::convex_pair(own, *scratch, options), d = collision::convex_pair(any, *scratch, options);
    const double size = own.large;
    EXPECT_NEAR(c.distance, d.distance, 1e-10 * size + c.residual + d.residual) << c.residual << " " << d.residual;
    EXPECT_EQ(own.parallel(c.normal), any.parallel(c.normal));
    ++tally.poses, tally.other_flags += c.unique != d.unique;
    if (c.unique && d.unique && std::abs(c.distance) > 1e-6 * size) {
      EXPECT_NEAR(1, dot(c.normal, d.normal), 1e-9);
      EXPECT_LE(shape::norm(c.a - d.a) + shape::norm(c.b - d.b), 1e-6 * size);
    }
  }
}

TEST(AnyCore, AnswersAsTheShapesThemselves) {
  AnyTally tally;
  for (Case kind : {Case::Random, Case::Touching, Case::NearlyTouching, Case::Deep}) {
#define DYN_COMPARE(A, B) compare<shape::A, shape::B>(kind, samples(100), tally);
    DYN_CONVEX_STRAIGHT(DYN_COMPARE) DYN_CONVEX_CYLINDER(DYN_COMPARE) DYN_CONVEX_OTHER(DYN_COMPARE)
#undef DYN_COMPARE
  }
  EXPECT_LE(tally.other_flags, tally.poses / 1000);  // where rounding decides
}

}  // namespace
}  // namespace dyn_test
