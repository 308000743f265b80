#include "dyn/solver/newton.hpp"

namespace dyn::solver {

void newton(Workspace& w, Budget& b) {
  if (start(w, b)) return;
  Multipliers m(w, b);
  while (!b.spent()) {
    if (!m.jointly(20)) return;
    m.velocity();
    if (keep_best(w, b, m.y, w.newton_c)) return;
    if (b.newton && alart_curnier(w, b, m.y, w.newton_c)) return;
    for (int k = 0; b.newton && k < 10 && !b.spent(); ++k)  // which follow the correction more closely
      if (!m.alternate()) return;
  }
}

}  // namespace dyn::solver
