// Cones, ellipsoids and hulls.
#include "convex_methods.hpp"

namespace dyn::collision {

DYN_CONVEX_OTHER(DYN_CONVEX_INSTANCE)

}  // namespace dyn::collision
