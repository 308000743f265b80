// Data, contact solvers and planners in memory that is given: by the caller, or from the heap (heap.cpp).
#pragma once

#include "guard.hpp"

namespace dyn::capi {

inline constexpr std::size_t body_bytes = (sizeof(DataBody) + 63) / 64 * 64;

// DYN_ERROR_ARGUMENT for unknown bits, DYN_ERROR_UNSUPPORTED for parts that this build does not have.
dynStatus check_parts(const char* function, const Model& m, dynParts parts);
// In body_bytes + data_bytes of zeros.
void set_up(dynData* data, const Model& m, dynParts parts, void* memory);

dynStatus check_max_rows(const char* function, int max_rows);
dynStatus check_planner(const char* function, const dynModel* model, int knots, dynPlanInput input);

// Of handles that own their memory.
void free_heap(dynData* data);
void free_heap(dynContactSolver* solver);
void free_heap(dynPlanner* planner);

}  // namespace dyn::capi
