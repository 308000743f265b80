// Declarations of the constrained algorithms. constrained_dynamics.cpp, project.cpp and derivatives.cpp instantiate them for
// double.
#pragma once

#include "algorithm/constrained/proximal.hpp"
#include "algorithm/constrained/rows.hpp"

namespace dyn {

// constrained_dynamics.hpp
template <class T> Index constraint_factor(const Model&, Data<T>&);
template <class T>
Index constrained_dynamics(const Model&, Data<T>&, const T* v, const T* tau, const T* fext, const ProximalOptions&, T* ddq,
                           dynConstraintResult&);
template <class T>
Index constraint_impulse(const Model&, Data<T>&, const T* v, const ProximalOptions&, T* v_plus, dynConstraintResult&);
template <class T> void constraint_jacobian(const Model&, Data<T>&, T* J, std::ptrdiff_t ld);
// delassus.hpp
template <class T> void propagate_rows(const Model&, Data<T>&);
template <class T> void delassus(const Model&, Data<T>&, Index rows, T* G);
template <class T> void delassus_times(const Model&, Data<T>&, const T* x, T* by_dof, T* out);
// project.hpp, inverse.hpp
template <class T> void project_velocity(const Model&, Data<T>&, const T* v, T* out, dynConstraintResult&);
template <class T>
Index project(const Model&, Data<T>&, int max_iterations, bool weigh, T tolerance, T* v, dynConstraintResult&,
              double misalignment, T min_damping = T(1e-14));
template <class T>
Index constrained_inverse_dynamics(const Model&, Data<T>&, const T* v, const T* a, const T* fext, const std::int32_t* actuated,
                                   T* tau, dynConstraintResult&);
// derivatives.hpp
template <class T>
Index constrained_dynamics_derivatives(const Model&, Data<T>&, const T* v, const T* tau, const T* fext, const ProximalOptions&,
                                       dynConstraintResult&);
template <class T>
Index constraint_impulse_derivatives(const Model&, Data<T>&, const T* v, const ProximalOptions&, dynConstraintResult&);

}  // namespace dyn
