#include "dyn/solver/admm.hpp"

namespace dyn::solver {

constexpr Index patience = 30;

void admm(Workspace& w, Budget& b) {
  if (start(w, b)) return;
  Multipliers m(w, b);
  double tried = HUGE_VAL;  // error at which Newton's method was last tried
  while (!b.spent()) {
    const bool slow = b.newton && b.iterations % patience == patience - 1;
    if (!(slow ? m.jointly(5) : m.alternate())) return;
    if (!(m.error <= b.tolerance || slow || (b.newton && m.error < 0.3 * tried) || b.iterations % 10 == 0)) continue;
    m.velocity();
    if (keep_best(w, b, m.y, w.newton_c)) return;
    tried = m.error;
    if (b.newton && alart_curnier(w, b, m.y, w.newton_c)) return;
  }
}

}  // namespace dyn::solver
