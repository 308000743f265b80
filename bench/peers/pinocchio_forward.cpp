// Part of pinocchio_bench: forward dynamics and the inverse of M.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/aba.hpp>

void addForwardRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("aba_local", b.noMimic, [&](S s, S) {
    pin::aba(model, data, s.q, s.v, s.tau, Convention::LOCAL);
    keep(data);
  });
  b.add("aba_world", b.noMimic, [&](S s, S) {
    pin::aba(model, data, s.q, s.v, s.tau, Convention::WORLD);
    keep(data);
  });
  b.add("minv", b.noMimic, [&](S s, S) { pin::computeMinverse(model, data, s.q); keep(data); });
}
