// The solid ellipsoid of uniform density that has a link's mass and inertia.

/** Eigenvalues and eigenvectors (columns) of a symmetric 3 x 3 matrix, by Jacobi's rotations. */
export function eigen(inertia) {
  const a = [0, 1, 2].map((i) => [0, 1, 2].map((j) => inertia[i + 3 * j]));
  const v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 30; ++sweep)
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (a[p][q] === 0) continue;
      const angle = 0.5 * Math.atan2(2 * a[p][q], a[q][q] - a[p][p]);
      const c = Math.cos(angle), s = Math.sin(angle);
      for (let k = 0; k < 3; ++k) [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
      for (let k = 0; k < 3; ++k) [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
      for (let k = 0; k < 3; ++k) [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
    }
  return { values: [a[0][0], a[1][1], a[2][2]], vectors: v };
}

/** I_x = m (b^2 + c^2) / 5 and so on, solved for a, b, c. */
export function semiAxes([x, y, z], mass) {
  return [y + z - x, z + x - y, x + y - z].map((sum) => Math.sqrt(Math.max((2.5 * sum) / mass, 0)));
}
