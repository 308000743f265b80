// Capsules and boxes with curved shapes and hulls.
#include "convex_methods.hpp"

namespace dyn::collision {

DYN_CONVEX_STRAIGHT(DYN_CONVEX_INSTANCE)

}  // namespace dyn::collision
