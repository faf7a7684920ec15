// The sketch of a jaw, for pages. Frame of the head: x forward, y left, z up.

/**
 * Lower jaw between two condyles and the incisor, as lines: rami, body and chin, as points of their
 * plane and a height above it, in shares of the distances between the three.
 */
export function outline(left, right, incisor) {
  const middle = left.map((v, i) => (v + right[i]) / 2);
  const down = [0, 0, -1];
  const distance = Math.hypot(...incisor.map((v, i) => v - middle[i]));
  const along = (condyle, share, depth, spread) => condyle.map((v, i) => {
    const side = middle[i] + (v - middle[i]) * spread;
    return side + (incisor[i] - middle[i]) * share + down[i] * depth * distance;
  });
  const half = (condyle) => [
    condyle, along(condyle, 0.02, 0.25, 1), along(condyle, 0.12, 0.5, 0.95),
    along(condyle, 0.5, 0.42, 0.75), along(condyle, 0.9, 0.28, 0.3), along(condyle, 1, 0.24, 0),
  ];
  return [half(left), half(right), [incisor, along(left, 1, 0.24, 0)]];
}

// Axes of a triangle.
function frame(a, b, c) {
  const minus = (u, v) => u.map((x, i) => x - v[i]);
  const cross = (u, v) => [
    u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const unit = (u) => u.map((x) => x / Math.hypot(...u));
  const x = unit(minus(b, a));
  const z = unit(cross(x, minus(c, a)));
  return [x, cross(z, x), z];
}

/** The rigid displacement that moves the three points `from` to `to`, applied to `p`. */
export function moved(p, from, to) {
  const f = frame(...from);
  const t = frame(...to);
  const d = p.map((v, i) => v - from[0][i]);
  const local = f.map((axis) => axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2]);
  return to[0].map((v, i) => v + t[0][i] * local[0] + t[1][i] * local[1] + t[2][i] * local[2]);
}

/** Writes beside the drawn condyles which is which; `ratio`: device pixels for each px. */
export function nameCondyles(context, left, right, ratio) {
  context.font = `${12 * ratio}px system-ui, "Liberation Sans", Arial, sans-serif`;
  context.textBaseline = 'bottom';
  [['left', left], ['right', right]].forEach(([name, [x, y]]) => {
    context.fillText(name, x + 6 * ratio, y - 4 * ratio);
  });
}
