"""Numbers that count what is done with them, and vectors, matrices and motions of them. See flops.py."""
import math


class Count:
    mul = add = 0


class N:
    """A number that counts. Zeros and ones of the formulas are plain Python numbers."""
    __slots__ = ("x",)

    def __init__(self, x):
        self.x = float(x)

    def __add__(self, b):
        if isinstance(b, N):
            Count.add += 1
            return N(self.x + b.x)
        return self if b == 0 else N(self.x + b)

    def __sub__(self, b):
        if isinstance(b, N):
            Count.add += 1
            return N(self.x - b.x)
        return self if b == 0 else N(self.x - b)

    def __mul__(self, b):
        if isinstance(b, N):
            Count.mul += 1
            return N(self.x * b.x)
        if b == 0:
            return 0
        return self if b == 1 else -self if b == -1 else N(self.x * b)  # a 2 of the formulas folds into constants

    def __rsub__(self, b):
        return -self if b == 0 else N(b - self.x)

    def __truediv__(self, b):
        Count.mul += 1
        return N(self.x / b.x)

    def cos(self):
        return N(math.cos(self.x))

    def sin(self):
        return N(math.sin(self.x))

    def __neg__(self):
        return N(-self.x)

    __radd__, __rmul__ = __add__, __mul__


O3 = (0, 0, 0)
def plus(a, b): return tuple(x + y for x, y in zip(a, b))
def minus(a, b): return tuple(x - y for x, y in zip(a, b))
def times(a, s): return tuple(x * s for x in a)
def neg(a): return tuple(0 - x for x in a)
def dot(a, b): return sum((x * y for x, y in zip(a, b)), 0)
def cross(a, b): return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
# matrices are tuples of columns
def mv(A, x): return tuple(A[0][i] * x[0] + A[1][i] * x[1] + A[2][i] * x[2] for i in range(3))
def tv(A, x): return tuple(dot(c, x) for c in A)                     # A^T x
def mm(A, B): return tuple(mv(A, c) for c in B)
def transposed(A): return tuple(zip(*A))
def mplus(A, B): return tuple(plus(a, b) for a, b in zip(A, B))
def mminus(A, B): return tuple(minus(a, b) for a, b in zip(A, B))
def outer(a, b): return tuple(times(a, y) for y in b)                # a b^T
def skew(a): return ((0, a[2], 0 - a[1]), (0 - a[2], 0, a[0]), (a[1], 0 - a[0], 0))
def symmetric(entry): # of entry(row, column), the six on and above the diagonal
    e = {(i, j): entry(i, j) for j in range(3) for i in range(j + 1)}
    return tuple(tuple(e[min(i, j), max(i, j)] for i in range(3)) for j in range(3))
def congruence(R, I):                                                # R I R^T, I symmetric
    A = mm(R, I)
    return symmetric(lambda i, j: A[0][i] * R[0][j] + A[1][i] * R[1][j] + A[2][i] * R[2][j])
def splus(A, B): return symmetric(lambda i, j: A[j][i] + B[j][i])
# motions and forces: (linear, angular)
def plus6(a, b): return plus(a[0], b[0]), plus(a[1], b[1])
def minus6(a, b): return minus(a[0], b[0]), minus(a[1], b[1])
def times6(a, s): return times(a[0], s), times(a[1], s)
def dot6(a, b): return dot(a[0], b[0]) + dot(a[1], b[1])
def motion_cross(v, s): return plus(cross(v[1], s[0]), cross(v[0], s[1])), cross(v[1], s[1])
def force_cross(s, f): return cross(s[1], f[0]), plus(cross(s[1], f[1]), cross(s[0], f[0]))
WORLD = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
