// Quaternions as [x, y, z, w], rotation vectors as [x, y, z] in rad.

export function exponential([x, y, z]) {
  const angle = Math.hypot(x, y, z);
  const s = angle < 1e-9 ? 0.5 : Math.sin(angle / 2) / angle;
  return [s * x, s * y, s * z, Math.cos(angle / 2)];
}

/** The shortest rotation vector. */
export function logarithm([x, y, z, w]) {
  const sign = w < 0 ? -1 : 1;
  const length = Math.hypot(x, y, z);
  const s = length < 1e-12 ? 2 : (2 * Math.atan2(length, sign * w)) / length;
  return [sign * s * x, sign * s * y, sign * s * z];
}

export function product([ax, ay, az, aw], [bx, by, bz, bw]) {
  return [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

export function conjugate([x, y, z, w]) {
  return [-x, -y, -z, w];
}

export function rotate(q, [x, y, z]) {
  const [rx, ry, rz] = product(product(q, [x, y, z, 0]), conjugate(q));
  return [rx, ry, rz];
}
