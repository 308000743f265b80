/* A function of dyn.h as CasADi's external functions: NAME, jac_NAME (Jacobian), adj1_NAME (products from the left) and
   jac_adj1_NAME (the Hessian of such a product). libdyn.doors.casadi writes a file for one function: DOOR_NAME, DOOR_KIND,
   DOOR_FRAME, DOOR_DT, DOOR_INTEGRATOR and door_image, the bytes of the model, stand in front of this text. C11.

   Derivatives are those of dyn.h on tangent spaces, taken to the numbers of q by the tangent map: dq = T v, v = T+ dq
   (libdyn/doors/tangent.py). Matrices are dense and column-major. */
#include <dyn.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { DOOR_ABA, DOOR_RNEA, DOOR_FRAME_PLACEMENT, DOOR_STEP };
enum { MOST_DATA = 64, MOST_INPUTS = 4, MOST_OUTPUTS = 2, MOST_BLOCKS = MOST_INPUTS * (MOST_INPUTS + 2 * MOST_OUTPUTS) };
/* The functions. Their inputs: those of NAME, its outputs, seeds, products. */
enum { VALUE, JACOBIAN, ADJOINT, ADJOINT_JACOBIAN, FUNCTIONS };

typedef struct {
  const char* name;
  int size, tangent;
} Variable;

typedef struct {
  dynData* data;
  double *J, *H, *X;            /* Jacobian, Hessian on tangent spaces; scratch */
  double *t, *u, *w, *y, *zeros; /* vectors; y: outputs one after another */
} Memory;

typedef struct {
  int iq, iv, nq, nv;
} Joint;

static const dynModel* model;
static Joint* joints;
static int n_joints;
static int nq, nv, nu, n_in, n_out, rows, columns; /* rows, columns: of J */
static Variable in[MOST_INPUTS], out[MOST_OUTPUTS];
/* Sparsities of inputs and outputs: {rows, columns, 1} is dense. */
static long long vectors[2 * MOST_INPUTS + 2 * MOST_OUTPUTS][3], *shapes[FUNCTIONS][MOST_BLOCKS];
static Memory memory[MOST_DATA];
static atomic_flag taken[MOST_DATA];
static atomic_flag opening = ATOMIC_FLAG_INIT;
static atomic_int opened;

static int count_in(int f) { return n_in + (f ? n_out : 0) + (f >= ADJOINT ? n_out : 0) + (f == ADJOINT_JACOBIAN ? n_in : 0); }
static int count_out(int f) {
  return f == VALUE ? n_out : f == JACOBIAN ? n_out * n_in : f == ADJOINT ? n_in : n_in * (n_in + 2 * n_out);
}
static int size_in(int k) {
  return k < n_in ? in[k].size : k < n_in + 2 * n_out ? out[(k - n_in) % n_out].size : in[k - n_in - 2 * n_out].size;
}

/* Joints that have coordinates: a follower has none. */
static int list_joints(void) {
  if (!(joints = calloc((size_t)dyn_model_njoints(model), sizeof *joints))) return 1;
  for (int j = 1; j < dyn_model_njoints(model); ++j) {
    dynJointInfo info;
    info.struct_size = sizeof info;
    if (dyn_model_joint_info(model, j, &info)) return 1;
    if (info.nv) joints[n_joints++] = (Joint){info.idx_q, info.idx_v, info.nq, info.nv};
  }
  return 0;
}

static int make_shapes(void) {
  const int by = n_in + 2 * n_out;
  for (int k = 0; k < by + n_in; ++k) vectors[k][0] = size_in(k), vectors[k][1] = vectors[k][2] = 1;
  for (int f = 0; f < FUNCTIONS; ++f)
    for (int k = 0; k < count_out(f); ++k) {
      const int jacobian = f == JACOBIAN || f == ADJOINT_JACOBIAN, inner = f == JACOBIAN ? n_in : by;
      const int above = jacobian ? k / inner : k, column = k % inner;
      const int n = f == VALUE || f == JACOBIAN ? out[above].size : in[above].size, c = jacobian ? size_in(column) : 1;
      /* nothing depends on the outputs that CasADi hands over: no entry */
      const int empty = f == ADJOINT_JACOBIAN && column >= n_in && column < n_in + n_out;
      if (!(shapes[f][k] = calloc((size_t)c + 3, sizeof **shapes[f]))) return 1;
      shapes[f][k][0] = n, shapes[f][k][1] = c, shapes[f][k][2] = !empty;
    }
  return 0;
}

/* Opens the model once. Returns 0 when it is open. */
static int open_model(void) {
  int failed = 0;
  while (atomic_flag_test_and_set(&opening)) {
  }
  if (!atomic_load(&opened)) {
    failed = dyn_model_from_buffer(door_image, sizeof door_image, &model) != DYN_OK;
    if (!failed) {
      nq = dyn_model_nq(model), nv = dyn_model_nv(model), nu = dyn_model_nu(model);
      const Variable q = {"q", nq, nv}, v = {"v", nv, nv};
      n_in = DOOR_KIND == DOOR_FRAME_PLACEMENT ? 1 : DOOR_KIND == DOOR_STEP && nu ? 4 : 3;
      n_out = DOOR_KIND == DOOR_STEP ? 2 : 1;
      in[0] = q, in[1] = v, in[2] = (Variable){DOOR_KIND == DOOR_RNEA ? "a" : "tau", nv, nv};
      in[3] = (Variable){"control", nu, nu};
      out[0] = DOOR_KIND == DOOR_STEP              ? (Variable){"q_next", nq, nv}
               : DOOR_KIND == DOOR_FRAME_PLACEMENT ? (Variable){"placement", 12, 6}
                                                   : (Variable){DOOR_KIND == DOOR_ABA ? "ddq" : "tau", nv, nv};
      out[1] = (Variable){"v_next", nv, nv};
      for (int k = 0; k < n_in; ++k) columns += in[k].tangent;
      for (int k = 0; k < n_out; ++k) rows += out[k].tangent;
      failed = list_joints() || make_shapes();
      atomic_store(&opened, !failed);
    }
  }
  atomic_flag_clear(&opening);
  return failed;
}

/* ------------------------------------------------------------------------------------------- the tangent map */

static void cross(const double* a, const double* b, double* c) {
  c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}
static double dot(const double* a, const double* b, int n) {
  double s = 0;
  for (int k = 0; k < n; ++k) s += a[k] * b[k];
  return s;
}

/* R x, or R' x with sign -1, of a quaternion of any norm */
static void rotate(const double* quaternion, double sign, const double* x, double* y) {
  double t[3], s[3];
  cross(quaternion, x, t);
  for (int k = 0; k < 3; ++k) t[k] *= 2 * sign / dot(quaternion, quaternion, 4);
  cross(quaternion, t, s);
  for (int k = 0; k < 3; ++k) y[k] = x[k] + quaternion[3] * t[k] + sign * s[k];
}

/* scale G v, with G v the product of a quaternion and (v, 0), and scale G' x */
static void up_quaternion(const double* q, const double* v, double scale, double* x) {
  cross(q, v, x);
  for (int k = 0; k < 3; ++k) x[k] = scale * (x[k] + q[3] * v[k]);
  x[3] = -scale * dot(q, v, 3);
}
static void down_quaternion(const double* q, const double* x, double scale, double* v) {
  double t[3];
  cross(q, x, t);
  for (int k = 0; k < 3; ++k) v[k] = scale * (q[3] * x[k] - x[3] * q[k] - t[k]);
}

/* Calls act(context, first of q, first of v, nq, nv) for the coordinates of each joint. */
typedef void (*Act)(void* context, int iq, int iv, int joint_nq, int joint_nv);
static void each_joint(Act act, void* context) {
  for (int j = 0; j < n_joints; ++j) act(context, joints[j].iq, joints[j].iv, joints[j].nq, joints[j].nv);
}

typedef struct {
  const double *q, *from;
  double* to;
  int inverse; /* of up: T+' instead of T; of down: T+ instead of T' */
} Map;

static void up_joint(void* context, int iq, int iv, int m, int n) {
  const Map* map = context;
  const double *q = map->q + iq, *v = map->from + iv;
  double* x = map->to + iq;
  if (m == 2 && n == 1) { /* (cos, sin) */
    const double s = map->inverse ? *v / dot(q, q, 2) : *v;
    x[0] = -q[1] * s, x[1] = q[0] * s;
  } else if (m == n + 1) { /* a quaternion, after a position or alone */
    const double* quaternion = q + m - 4;
    if (m == 7) rotate(quaternion, 1, v, x);
    up_quaternion(quaternion, v + n - 3, map->inverse ? 2 / dot(quaternion, quaternion, 4) : 0.5, x + m - 4);
  } else {
    memcpy(x, v, (size_t)n * sizeof *x);
  }
}
static void down_joint(void* context, int iq, int iv, int m, int n) {
  const Map* map = context;
  const double *q = map->q + iq, *x = map->from + iq;
  double* v = map->to + iv;
  if (m == 2 && n == 1) {
    *v = (q[0] * x[1] - q[1] * x[0]) / (map->inverse ? dot(q, q, 2) : 1);
  } else if (m == n + 1) {
    const double* quaternion = q + m - 4;
    if (m == 7) rotate(quaternion, -1, x, v);
    down_quaternion(quaternion, x + m - 4, map->inverse ? 2 / dot(quaternion, quaternion, 4) : 0.5, v + n - 3);
  } else {
    memcpy(v, x, (size_t)n * sizeof *v);
  }
}
static void up(const double* q, const double* v, double* x, int inverse) {
  Map map = {q, v, x, inverse};
  each_joint(up_joint, &map);
}
static void down(const double* q, const double* x, double* v, int inverse) {
  Map map = {q, x, v, inverse};
  each_joint(down_joint, &map);
}

/* H += the derivative by q of T+' g, g fixed, nq x nq */
typedef struct {
  const double *q, *g;
  double* H;
} Bend;
static void bend_joint(void* context, int iq, int iv, int m, int n) {
  const Bend* bend = context;
  const int w = m == n ? 0 : m == 2 ? 2 : 4; /* numbers that are normed */
  const double *q = bend->q + iq + m - w, *g = bend->g + iv;
  double* H = bend->H + iq + (size_t)iq * nq;
  double a[4] = {0}, e[4] = {0}, t[4], s[4];
  if (!w) return;
  const double norm2 = dot(q, q, w);
  for (int b = 0; b < w; ++b) {
    e[b] = 1;
    double* column = H + (size_t)(m - w + b) * nq;
    if (w == 2) {
      t[0] = -e[1] * *g / norm2, t[1] = e[0] * *g / norm2;
      a[0] = -q[1] * *g / norm2, a[1] = q[0] * *g / norm2;
    } else {
      up_quaternion(e, g + n - 3, 2 / norm2, t);
      up_quaternion(q, g + n - 3, 2 / norm2, a);
    }
    for (int k = 0; k < w; ++k) column[m - w + k] += t[k] - 2 * q[b] / norm2 * a[k];
    if (m == 7) { /* g . R'x turns with the quaternion: R (omega x g) */
      down_quaternion(q, e, 2 / norm2, s);
      cross(s, g, t);
      rotate(q, 1, t, s);
      for (int k = 0; k < 3; ++k) column[k] += s[k];
    }
    e[b] = 0;
  }
}

/* Numbers of an output for a change dy on its tangent space, and the transpose. */
static void lift(int o, const double* y, const double* dy, double* numbers) {
  if (out[o].tangent == 6 && DOOR_KIND == DOOR_FRAME_PLACEMENT) {
    for (int k = 0; k < 9; k += 3) cross(dy + 3, y + k, numbers + k);
    memcpy(numbers + 9, dy, 3 * sizeof *dy);
  } else if (DOOR_KIND == DOOR_STEP && !o) {
    up(y, dy, numbers, 0);
  } else {
    memcpy(numbers, dy, (size_t)out[o].size * sizeof *dy);
  }
}
static void lift_transposed(int o, const double* y, const double* seed, double* g) {
  if (DOOR_KIND == DOOR_FRAME_PLACEMENT) {
    memset(g, 0, 6 * sizeof *g);
    for (int k = 0; k < 9; k += 3) {
      double t[3];
      cross(y + k, seed + k, t);
      for (int i = 0; i < 3; ++i) g[3 + i] += t[i];
    }
    memcpy(g, seed + 9, 3 * sizeof *g);
  } else if (DOOR_KIND == DOOR_STEP && !o) {
    down(y, seed, g, 0);
  } else {
    memcpy(g, seed, (size_t)out[o].size * sizeof *g);
  }
}

/* ------------------------------------------------------------------------------------------------- the function */

/* The value, outputs one after another in y, and, where J is wanted, the Jacobian on tangent spaces, rows x columns.
   y may be NULL where no Jacobian by numbers depends on it (LIFTED). */
enum { LIFTED = DOOR_KIND == DOOR_FRAME_PLACEMENT || DOOR_KIND == DOOR_STEP };
static int evaluate(Memory* m, const double** x, double* y, double* J) {
  const size_t block = (size_t)nv * nv;
  if (DOOR_KIND == DOOR_ABA) {
    if (!J) return dyn_aba(model, m->data, x[0], x[1], x[2], NULL, y);
    dynAbaDerivatives d;
    dyn_aba_derivatives_init(&d);
    d.ddq_dq = J, d.ddq_dv = J + block, d.ddq_dtau = J + 2 * block;
    return (y && dyn_aba(model, m->data, x[0], x[1], x[2], NULL, y)) ||
           dyn_aba_derivatives(model, m->data, x[0], x[1], x[2], NULL, &d);
  }
  if (DOOR_KIND == DOOR_RNEA) {
    if (y && dyn_rnea(model, m->data, x[0], x[1], x[2], NULL, y)) return 1;
    return J && (dyn_rnea_derivatives(model, m->data, x[0], x[1], x[2], NULL, J, J + block) ||
                 dyn_crba(model, m->data, x[0], J + 2 * block));
  }
  if (DOOR_KIND == DOOR_FRAME_PLACEMENT) {
    if (dyn_forward_kinematics(model, m->data, x[0], NULL, NULL) || dyn_frame_placement(model, m->data, DOOR_FRAME, y)) return 1;
    return J && dyn_frame_jacobian(model, m->data, DOOR_FRAME, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, J);
  }
  dynStepDerivatives d;
  dyn_step_derivatives_init(&d);
  d.q = y, d.v = y + nq;
  if (J) d.A = J, d.B = J + 4 * block, d.B_control = nu ? J + 6 * block : NULL;
  return dyn_data_set_state(model, m->data, x[0], x[1], NULL, x[2]) || (nu && dyn_data_set_control(model, m->data, x[3])) ||
         dyn_step_derivatives(model, m->data, NULL, &d);
}

/* Inputs that are not given are zeros. */
static const double** given(Memory* m, const double** arg, const double** x) {
  for (int k = 0; k < n_in; ++k) x[k] = arg[k] ? arg[k] : m->zeros;
  return x;
}

/* g = J' seed on tangent spaces. y: outputs one after another. Seeds that are not given are zeros. */
static void products(const double* J, const double* y, const double** seed, double* t, double* g) {
  int row = 0, at = 0;
  for (int o = 0; o < n_out; at += out[o].size, row += out[o++].tangent) {
    if (seed[o]) lift_transposed(o, y + at, seed[o], t + row);
    else memset(t + row, 0, (size_t)out[o].tangent * sizeof *t);
  }
  for (int k = 0; k < columns; ++k) g[k] = dot(J + (size_t)k * rows, t, rows);
}

static int value(Memory* m, const double** arg, double** res) {
  const double* x[MOST_INPUTS];
  if (evaluate(m, given(m, arg, x), m->y, NULL)) return 1;
  const double* y = m->y;
  for (int o = 0; o < n_out; y += out[o++].size)
    if (res[o]) memcpy(res[o], y, (size_t)out[o].size * sizeof *y);
  return 0;
}

/* Blocks of the Jacobian by output and input. transposed: (input, output), a stride of res apart. */
static void blocks(Memory* m, const double* q, double** res, int stride, int transposed) {
  int row = 0, at = 0;
  for (int o = 0; o < n_out; at += out[o].size, row += out[o++].tangent)
    for (int i = 0, column = 0; i < n_in; column += in[i++].tangent) {
      double* to = res[transposed ? i * stride + o : o * stride + i];
      if (!to) continue;
      const int done = i && !transposed;
      double* lifted = done ? to : m->X; /* size of the output x columns of the tangent space */
      for (int k = 0; k < in[i].tangent; ++k)
        lift(o, m->y + at, m->J + row + (size_t)(column + k) * rows, lifted + (size_t)k * out[o].size);
      for (int r = 0; !done && r < out[o].size; ++r) {
        for (int k = 0; k < in[i].tangent; ++k) m->u[k] = lifted[r + (size_t)k * out[o].size];
        if (i) memcpy(m->w, m->u, (size_t)in[i].size * sizeof *m->w);
        else up(q, m->u, m->w, 1);
        for (int k = 0; k < in[i].size; ++k)
          to[transposed ? k + (size_t)r * in[i].size : r + (size_t)k * out[o].size] = m->w[k];
      }
    }
}

static int jacobian(Memory* m, const double** arg, double** res) {
  const double* x[MOST_INPUTS];
  if (evaluate(m, given(m, arg, x), LIFTED ? m->y : NULL, m->J)) return 1;
  blocks(m, x[0], res, n_in, 0);
  return 0;
}

static int adjoint(Memory* m, const double** arg, double** res) {
  const double* x[MOST_INPUTS];
  if (evaluate(m, given(m, arg, x), LIFTED ? m->y : NULL, m->J)) return 1;
  products(m->J, m->y, arg + n_in + n_out, m->t, m->u);
  for (int i = 0, column = 0; i < n_in; column += in[i++].tangent) {
    if (!res[i]) continue;
    if (i) memcpy(res[i], m->u + column, (size_t)in[i].size * sizeof *m->u);
    else up(x[0], m->u, res[i], 1);
  }
  return 0;
}

/* H of a product with lambda (nv), on tangent spaces: row j, column k is the derivative along k of that along j. */
static int rnea_hessian(Memory* m, const double** x, const double* a, const double* lambda, double* H) {
  const size_t n = (size_t)nv, N = 3 * n;
  double *qq = m->X, *vv = qq + n * n, *qv = vv + n * n, *aq = qv + n * n;
  dynSecondOrderDerivatives d;
  dyn_second_order_derivatives_init(&d);
  d.dqdq = qq, d.dvdv = vv, d.dqdv = qv, d.dadq = aq;
  if (dyn_rnea_second_order_product(model, m->data, x[0], x[1], a, NULL, lambda, &d)) return 1;
  memset(H, 0, N * N * sizeof *H);
  for (size_t j = 0; j < n; ++j)
    for (size_t k = 0; k < n; ++k) {
      H[j + N * k] = qq[j + n * k], H[n + j + N * (n + k)] = vv[j + n * k];
      H[j + N * (n + k)] = H[n + k + N * j] = qv[j + n * k];
      H[2 * n + j + N * k] = H[k + N * (2 * n + j)] = aq[j + n * k];
    }
  return 0;
}

/* With tau = rnea(q, v, ddq) along the solution: H = -X' K X, K that of rnea at mu = M^-1 lambda, X = [1 0 0; 0 1 0; J]. */
static int aba_hessian(Memory* m, const double** x, const double* lambda, double* H) {
  const size_t n = (size_t)nv, N = 3 * n;
  double *mu = m->w, *K = m->H + N * N, *KX = K;
  for (size_t k = 0; k < n; ++k) mu[k] = dot(m->J + n * (2 * n + k), lambda, nv);
  if (rnea_hessian(m, x, m->y, mu, H)) return 1;
  /* KX = K X: columns of q and v keep their own part */
  for (size_t c = 0; c < N; ++c)
    for (size_t r = 0; r < N; ++r) {
      double s = c < 2 * n ? H[r + N * c] : 0;
      for (size_t k = 0; k < n; ++k) s += H[r + N * (2 * n + k)] * m->J[k + n * c];
      KX[r + N * c] = s;
    }
  for (size_t c = 0; c < N; ++c)
    for (size_t r = 0; r < N; ++r)
      H[r + N * c] = -((r < 2 * n ? KX[r + N * c] : 0) + dot(m->J + n * r, KX + 2 * n + N * c, nv));
  return 0;
}

/* lambda: of the position and of the rotation's columns */
static int placement_hessian(Memory* m, const double* seed, double* H) {
  double* D = m->X; /* derivatives of the frame's Jacobian, 6 x nv each */
  if (dyn_frame_kinematic_hessian(model, m->data, DOOR_FRAME, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, D)) return 1;
  for (int j = 0; j < nv; ++j)
    for (int k = 0; k < nv; ++k) {
      const double *d = D + 6 * (j + (size_t)nv * k), *wj = m->J + 6 * j + 3, *wk = m->J + 6 * k + 3;
      double s = dot(seed + 9, d, 3);
      for (int c = 0; c < 9; c += 3) {
        double t[3], u[3];
        cross(d + 3, m->y + c, t);
        s += dot(seed + c, t, 3);
        cross(wk, m->y + c, t);
        cross(wj, t, u);
        s += dot(seed + c, u, 3);
      }
      H[j + (size_t)nv * k] = s;
    }
  return 0;
}

/* Blocks of the Hessian by input and input, from H and the gradient g on tangent spaces: T+' H T+ and the change of T+. */
static void hessian_blocks(Memory* m, const double* q, const double* g, double** res, int stride) {
  for (int i = 0, row = 0; i < n_in; row += in[i++].tangent)
    for (int k = 0, column = 0; k < n_in; column += in[k++].tangent) {
      double* to = res[i * stride + k];
      if (!to) continue;
      const int R = in[i].size, r = in[i].tangent, c = in[k].tangent;
      double* left = m->X; /* R x c */
      for (int b = 0; b < c; ++b) {
        const double* h = m->H + row + (size_t)(column + b) * columns;
        if (i) memcpy(left + (size_t)b * R, h, (size_t)r * sizeof *h);
        else up(q, h, left + (size_t)b * R, 1);
      }
      for (int a = 0; a < R; ++a) {
        for (int b = 0; b < c; ++b) m->t[b] = left[a + (size_t)b * R];
        if (k) memcpy(m->w, m->t, (size_t)c * sizeof *m->w);
        else up(q, m->t, m->w, 1);
        for (int b = 0; b < in[k].size; ++b) to[a + (size_t)b * R] = m->w[b];
      }
      if (!i && !k) {
        Bend bend = {q, g, to};
        each_joint(bend_joint, &bend);
      }
    }
}

/* Hessian of the step, which has no analytic one: central differences of the adjoint. */
static int step_hessian(Memory* m, const double** x, const double** seed, double** res, int stride) {
  const double *arg[MOST_INPUTS + 2 * MOST_OUTPUTS] = {0}, h = 1e-6;
  double *plus[MOST_INPUTS], *minus[MOST_INPUTS], *moved = m->H, *next = m->H + nq + 3 * (size_t)nv + nu;
  for (int k = 0; k < n_in; ++k) {
    memcpy(moved, x[k], (size_t)in[k].size * sizeof *moved);
    arg[k] = moved, moved += in[k].size;
    plus[k] = next, minus[k] = next + in[k].size, next += 2 * in[k].size;
  }
  for (int o = 0; o < n_out; ++o) arg[n_in + n_out + o] = seed[o];
  for (int k = 0; k < n_in; ++k)
    for (int b = 0; b < in[k].size; ++b) {
      double* at = (double*)arg[k] + b;
      const double center = *at;
      *at = center + h;
      int failed = adjoint(m, arg, plus);
      *at = center - h;
      failed = failed || adjoint(m, arg, minus);
      *at = center;
      if (failed) return 1;
      for (int i = 0; i < n_in; ++i)
        for (int a = 0; res[i * stride + k] && a < in[i].size; ++a)
          res[i * stride + k][a + (size_t)b * in[i].size] = (plus[i][a] - minus[i][a]) / (2 * h);
    }
  return 0;
}

static int adjoint_jacobian(Memory* m, const double** arg, double** res) {
  const double* x[MOST_INPUTS];
  const double** seed = arg + n_in + n_out;
  const int stride = n_in + 2 * n_out;
  if (DOOR_KIND == DOOR_STEP && step_hessian(m, given(m, arg, x), seed, res, stride)) return 1;
  if (evaluate(m, given(m, arg, x), m->y, m->J)) return 1;
  blocks(m, x[0], res + n_in + n_out, stride, 1);
  if (DOOR_KIND == DOOR_STEP) return 0;
  products(m->J, m->y, seed, m->t, m->u);
  const double* lambda = seed[0] ? seed[0] : m->zeros;
  if (DOOR_KIND == DOOR_ABA ? aba_hessian(m, x, lambda, m->H)
      : DOOR_KIND == DOOR_RNEA ? rnea_hessian(m, x, x[2], lambda, m->H) : placement_hessian(m, lambda, m->H)) return 1;
  hessian_blocks(m, x[0], m->u, res, stride);
  return 0;
}

/* ---------------------------------------------------------------------------------------------- what CasADi asks */

/* Data and buffers stay for the next caller: generated code takes and gives them in each call. */
static void release(int k) {
  if (k >= 0 && k < MOST_DATA) atomic_flag_clear(&taken[k]);
}
static int give_up(int k) {
  dyn_data_free(memory[k].data);
  free(memory[k].J);
  memset(&memory[k], 0, sizeof memory[k]);
  release(k);
  return -1;
}

/* Data and buffers of one caller at a time. -1: no memory. */
static int checkout(void) {
  static const dynParts parts[] = {
      DYN_PART_FORWARD_DERIVATIVES | DYN_PART_SECOND_ORDER, DYN_PART_INVERSE_DERIVATIVES | DYN_PART_SECOND_ORDER | DYN_PART_MASS,
      DYN_PART_KINEMATICS | DYN_PART_JACOBIANS, DYN_PART_SIMULATION | DYN_PART_STEP_DERIVATIVES};
  if (open_model()) return -1;
  int k = 0;
  while (k < MOST_DATA && atomic_flag_test_and_set(&taken[k])) ++k;
  if (k == MOST_DATA) return -1;
  Memory* m = &memory[k];
  if (m->data) return k;
  const size_t J = (size_t)rows * columns, N = (size_t)columns + nq, H = 2 * N * N + 16 * N, vector = N + 12;
  const size_t X = 6 * (size_t)nv * nv + vector * N;
  m->J = calloc(J + H + X + 5 * vector, sizeof *m->J);
  if (!m->J || dyn_data_new(model, parts[DOOR_KIND], &m->data) != DYN_OK) return give_up(k);
  m->H = m->J + J, m->X = m->H + H, m->t = m->X + X, m->u = m->t + vector, m->w = m->u + vector;
  m->y = m->w + vector, m->zeros = m->y + vector;
  if (DOOR_KIND == DOOR_STEP) {
    dynStepOptions options;
    options.struct_size = sizeof options;
    if (dyn_data_step_options(model, m->data, &options)) return give_up(k);
    if (DOOR_DT > 0) options.dt = DOOR_DT;
    if (DOOR_INTEGRATOR >= 0) options.integrator = (dynIntegrator)DOOR_INTEGRATOR;
    if (dyn_data_set_step_options(model, m->data, &options)) return give_up(k);
  }
  return k;
}

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

static const long long* shape_in(int f, long long k) { return open_model() || k < 0 || k >= count_in(f) ? NULL : vectors[k]; }
static const long long* shape_out(int f, long long k) { return open_model() || k < 0 || k >= count_out(f) ? NULL : shapes[f][k]; }
static int work(int f, long long* args, long long* results, long long* integers, long long* numbers) {
  if (open_model()) return 1;
  if (args) *args = count_in(f);
  if (results) *results = count_out(f);
  if (integers) *integers = 0;
  if (numbers) *numbers = 0;
  return 0;
}

#define DOOR(name, f, call)                                                                                          \
  EXPORT int name(const double** arg, double** res, long long* iw, double* w, int k) {                               \
    (void)iw, (void)w;                                                                                               \
    return k < 0 || k >= MOST_DATA || !memory[k].data || call(&memory[k], arg, res) != 0;                            \
  }                                                                                                                  \
  EXPORT long long JOIN(name, _n_in)(void) { return open_model() ? 0 : count_in(f); }                                \
  EXPORT long long JOIN(name, _n_out)(void) { return open_model() ? 0 : count_out(f); }                              \
  EXPORT const long long* JOIN(name, _sparsity_in)(long long i) { return shape_in(f, i); }                      \
  EXPORT const long long* JOIN(name, _sparsity_out)(long long i) { return shape_out(f, i); }                    \
  EXPORT int JOIN(name, _work)(long long* a, long long* r, long long* i, long long* n) { return work(f, a, r, i, n); } \
  EXPORT int JOIN(name, _checkout)(void) { return checkout(); }                                                      \
  EXPORT void JOIN(name, _release)(int k) { release(k); }

DOOR(DOOR_NAME, VALUE, value)
DOOR(JOIN(jac_, DOOR_NAME), JACOBIAN, jacobian)
DOOR(JOIN(adj1_, DOOR_NAME), ADJOINT, adjoint)
DOOR(JOIN(jac_adj1_, DOOR_NAME), ADJOINT_JACOBIAN, adjoint_jacobian)

EXPORT const char* JOIN(DOOR_NAME, _name_in)(long long k) { return open_model() || k < 0 || k >= n_in ? NULL : in[k].name; }
EXPORT const char* JOIN(DOOR_NAME, _name_out)(long long k) { return open_model() || k < 0 || k >= n_out ? NULL : out[k].name; }
