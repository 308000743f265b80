// Convex hulls by qhull (Barber, Dobkin, Huhdanpaa 1996), which merges facets that are coplanar within rounding.
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <limits>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include "parts.hpp"

namespace dyn::mesh {

namespace {

// qhull and its output, freed together.
struct Qhull {
  qhT qh;
  char* said = nullptr;
  std::size_t said_size = 0;
#ifdef _WIN32  // no streams in memory: what qhull says is lost, its status remains
  std::FILE* log = std::fopen("NUL", "w");
#else
  std::FILE* log = open_memstream(&said, &said_size);
#endif

  Qhull() {
    if (!log) throw std::bad_alloc();
    qh_zero(&qh, log);
  }
  ~Qhull() {
    int open, total;
    qh_freeqhull(&qh, !qh_ALL);
    qh_memfreeshort(&qh, &open, &total);
    std::fclose(log);
    std::free(said);
  }
  std::string message() {
    std::fflush(log);
    std::string first(said ? said : "", said_size);
    first = first.substr(0, first.find('\n'));
    return first;
  }
};

// Corners of all faces in qhull's order. Plain C inside, because qhull reports errors by longjmp.
bool collect(qhT* qh, std::int32_t* of_face, std::int32_t* start, std::int32_t faces, std::int32_t room) {
  if (setjmp(qh->errexit)) return false;
  qh->NOerrexit = False;
  std::int32_t at = 0, k = 0;
  facetT* facet;
  FORALLfacets {
    setT* corners = qh_facet3vertex(qh, facet);
    vertexT *vertex, **vertexp;
    FOREACHvertex_(corners) {
      if (at == room) return false;
      of_face[at++] = qh_pointid(qh, vertex->point);
    }
    qh_settempfree(qh, &corners);
    if (k == faces) return false;
    start[++k] = at;
  }
  qh->NOerrexit = True;
  return true;
}

// Twice the polygon's area times its normal (Newell).
void area_vector(const double* points, const std::int32_t* corners, std::int32_t n, double out[3]) {
  out[0] = out[1] = out[2] = 0;
  const double* o = points + 3 * std::ptrdiff_t(corners[0]);
  for (std::int32_t i = 1; i + 1 < n; ++i) {
    const double *p = points + 3 * std::ptrdiff_t(corners[i]), *q = points + 3 * std::ptrdiff_t(corners[i + 1]);
    const double a[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]}, b[3] = {q[0] - o[0], q[1] - o[1], q[2] - o[2]};
    for (int k = 0; k < 3; ++k) out[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
  }
}

// Checks that each edge is passed once each way, and Euler's formula.
void check_polytope(const Faces& f) {
  std::vector<std::uint64_t> there, back;
  for (std::size_t k = 0; k + 1 < f.start.size(); ++k)
    for (std::int32_t i = f.start[k]; i < f.start[k + 1]; ++i) {
      const std::uint64_t a = std::uint32_t(f.of_face[std::size_t(i)]),
                          b = std::uint32_t(f.of_face[std::size_t(i + 1 < f.start[k + 1] ? i + 1 : f.start[k])]);
      there.push_back(a << 32 | b), back.push_back(b << 32 | a);
    }
  std::sort(there.begin(), there.end()), std::sort(back.begin(), back.end());
  const bool once = std::adjacent_find(there.begin(), there.end()) == there.end();
  const std::int64_t vertices = std::int64_t(f.corners.size()), edges = std::int64_t(there.size() / 2),
                     faces = std::int64_t(f.start.size()) - 1;
  if (!once || there != back || vertices - edges + faces != 2)
    throw Refusal(DYN_ERROR_NUMERIC,
                  "the points are so close to degenerate that their hull has no consistent faces: remove points that lie closer "
                  "than 1e-12 of the extent");
}

}  // namespace

Faces hull_qhull(const double* points, std::int32_t count) {
  // centred and scaled to size 1, so tolerances hold for any unit
  double low[3], high[3], extent = 0;
  for (int k = 0; k < 3; ++k) {
    low[k] = std::numeric_limits<double>::infinity(), high[k] = -low[k];
    for (std::int32_t i = 0; i < count; ++i)
      low[k] = std::min(low[k], points[3 * std::ptrdiff_t(i) + k]),
      high[k] = std::max(high[k], points[3 * std::ptrdiff_t(i) + k]);
    extent = std::max(extent, high[k] - low[k]);
  }
  if (count < 4 || !(extent > 0))
    throw Refusal(DYN_ERROR_INVALID, "a hull needs four points that do not lie in a plane, and there are " +
                                         std::to_string(extent > 0 ? count : std::min(count, 1)));
  std::vector<double> scaled(3 * std::size_t(count));
  for (std::size_t i = 0; i < scaled.size(); ++i) scaled[i] = (points[i] - (low[i % 3] + high[i % 3]) / 2) / extent;

  Qhull q;
  char command[] = "qhull Pp";  // Pp: no precision messages
  const int status = qh_new_qhull(&q.qh, 3, count, scaled.data(), False, command, nullptr, q.log);
  if (status == qh_ERRsingular)
    throw Refusal(DYN_ERROR_INVALID, "the points lie in a plane, within rounding: a hull needs volume");
  if (status == qh_ERRmem) throw std::bad_alloc();
  if (status) throw Refusal(DYN_ERROR_NUMERIC, "qhull failed: " + q.message());

  const std::int32_t faces = q.qh.num_facets;
  std::size_t room = 0;
  {
    qhT* qh = &q.qh;
    facetT* facet;
    FORALLfacets room += std::size_t(qh_setsize(qh, facet->vertices)) + 1;
  }
  Faces f;
  f.start.assign(std::size_t(faces) + 1, 0);
  f.of_face.assign(room, 0);
  if (!collect(&q.qh, f.of_face.data(), f.start.data(), faces, std::int32_t(room)))
    throw Refusal(DYN_ERROR_NUMERIC, "qhull failed: " + q.message());
  f.of_face.resize(std::size_t(f.start.back()));

  // counter-clockwise from outside: away from the mean of the corners
  f.corners = f.of_face;
  std::sort(f.corners.begin(), f.corners.end());
  f.corners.erase(std::unique(f.corners.begin(), f.corners.end()), f.corners.end());
  double middle[3] = {0, 0, 0};
  for (std::int32_t c : f.corners)
    for (int k = 0; k < 3; ++k) middle[k] += scaled[3 * std::size_t(c) + std::size_t(k)] / double(f.corners.size());
  for (std::size_t k = 0; k + 1 < f.start.size(); ++k) {
    std::int32_t* corners = f.of_face.data() + f.start[k];
    const std::int32_t n = f.start[k + 1] - f.start[k];
    double normal[3], out = 0;
    area_vector(scaled.data(), corners, n, normal);
    for (int i = 0; i < 3; ++i) out += normal[i] * (scaled[3 * std::size_t(corners[0]) + std::size_t(i)] - middle[i]);
    if (out < 0) std::reverse(corners, corners + n);
  }
  for (std::int32_t& c : f.of_face) c = std::int32_t(std::lower_bound(f.corners.begin(), f.corners.end(), c) - f.corners.begin());
  check_polytope(f);
  return f;
}

}  // namespace dyn::mesh
