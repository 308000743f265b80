// Shapes on which a medium acts as on an ellipsoid, and the potential flow around it (Lamb 1932, 114-115): with
//   kappa_i = d_1 d_2 d_3 int_0^inf dl / ((d_i^2 + l) sqrt((d_1^2 + l) (d_2^2 + l) (d_3^2 + l)))
//   m_i = rho V kappa_i / (2 - kappa_i)
//   J_i = rho V / 5 (d_j^2 - d_k^2)^2 (kappa_k - kappa_j) / (2 (d_j^2 - d_k^2) + (d_j^2 + d_k^2) (kappa_j - kappa_k))
#include <algorithm>
#include <cmath>

#include "builder_impl.hpp"

namespace dyn {

namespace {

// Kronrod's 15 points, in l = s x^3 / (1 - x)^2, 0 < x < 1. Points and weights have eight decimals, as MuJoCo's, so that forces
// are equal. kappa is then right to 6e-7 for a sphere, and to 2e-4 for a disc of 1 : 100.
double kappa(double a, double b, double c) {
  constexpr double points[] = {0.00427231, 0.02544604, 0.06756779, 0.12923441, 0.20695638, 0.29707742, 0.39610752, 0.5},
                   weights[] = {0.01146766, 0.03154605, 0.05239501, 0.07032663, 0.08450236, 0.09517529, 0.10221647, 0.10474107};
  const double s = std::pow(b / a * c / a, 0.4);  // lengths in a
  double sum = 0;
  const auto add = [&](double x, double weight) {
    const double l = s * x * x * x / ((1 - x) * (1 - x)), slope = s * x * x * (3 - x) / ((1 - x) * (1 - x) * (1 - x));
    sum += weight * slope / ((1 + l) * std::sqrt((1 + l) * (1 + l * (a / b) * (a / b)) * (1 + l * (a / c) * (a / c))));
  };
  for (int k = 0; k < 7; ++k) add(points[k], weights[k]), add(1 - points[k], weights[k]);
  add(points[7], weights[7]);
  return sum;
}

}  // namespace

std::array<double, 3> fluid_semiaxes(dynShapeType type, const double* size) {
  const double r = size[0];
  switch (type) {
    case DYN_SHAPE_TYPE_SPHERE: return {r, r, r};
    case DYN_SHAPE_TYPE_BOX: return {r / 2, size[1] / 2, size[2] / 2};
    case DYN_SHAPE_TYPE_CYLINDER: return {r, r, size[1] / 2};
    case DYN_SHAPE_TYPE_CAPSULE: return {r, r, r + size[1] / 2};
    case DYN_SHAPE_TYPE_ELLIPSOID: return {r, size[1], size[2]};
    default: return {0, 0, 0};
  }
}

void Builder::fluid(FluidShape x, const std::optional<Placement>& placement) {
  if (impl->shapes.empty()) refuse(DYN_ERROR_INVALID, "there is no shape for fluid forces to act on: add it first");
  Shape& shape = impl->shapes.back().shape;
  const std::string who = "fluid forces on a shape of body '" + shape.body + "'";
  check_finite(who, x.coefficients.data(), 5), check_finite(who, x.semiaxes.data(), 3);
  for (const double c : x.coefficients)
    if (c < 0) refuse(DYN_ERROR_INVALID, who + ": coefficient " + number(c) + ": give 0 or more");
  if (x.semiaxes == std::array<double, 3>{0, 0, 0}) {
    x.semiaxes = fluid_semiaxes(shape.type, shape.size.data());
    if (x.semiaxes[0] == 0) refuse(DYN_ERROR_INVALID, who + ": its type has no ellipsoid: give semiaxes");
  }
  check_placement(who, x.placement = placement.value_or(shape.placement));
  for (const double d : x.semiaxes)
    if (!(d >= 1e-6 && d <= 1e6)) refuse(DYN_ERROR_INVALID, who + ": semiaxis " + number(d) + ": give metres from 1e-6 to 1e6");
  shape.fluid = x;
}

FluidEllipsoid fluid_ellipsoid(const FluidShape& shape, const SE3<double>& X) {
  FluidEllipsoid out{};
  out.X = X * load_se3(shape.placement.data());
  std::copy(shape.semiaxes.begin(), shape.semiaxes.end(), out.half);
  std::copy(shape.placement.begin(), shape.placement.end(), out.placement);
  std::copy(shape.coefficients.begin(), shape.coefficients.end(), out.coefficients);
  const double* const d = out.half;
  const double volume = 4.0 / 3 * 3.14159265358979323846 * d[0] * d[1] * d[2];
  double k[3];
  for (int i = 0; i < 3; ++i) k[i] = kappa(d[i], d[(i + 1) % 3], d[(i + 2) % 3]);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, l = (i + 2) % 3;
    const double a = d[j] * d[j], b = d[l] * d[l], between = k[l] - k[j], below = 2 * (a - b) - (a + b) * between;
    out.added_mass[i] = volume * k[i] / (2 - k[i]);
    out.added_inertia[i] = below != 0 ? volume / 5 * (a - b) * (a - b) * std::abs(between / below) : 0;
  }
  return out;
}

}  // namespace dyn
