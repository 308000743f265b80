// Cylinders with curved shapes and hulls.
#include "convex_methods.hpp"

namespace dyn::collision {

DYN_CONVEX_CYLINDER(DYN_CONVEX_INSTANCE)

}  // namespace dyn::collision
