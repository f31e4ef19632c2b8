// The report's data as `duet report` wrote it (experiments/report/report_json.h): runs, and for each
// of them curves over time as one block of little-endian float32 numbers, column after column.

import {conjugate, exponential, logarithm, product, rotate} from './rotation.js';

const kDegrees = 180 / Math.PI;

function decodeFloats(base64) {
  const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const floats = new Float32Array(bytes.length / 4);
  for (let i = 0; i < floats.length; ++i) floats[i] = view.getFloat32(4 * i, true);
  return floats;
}

export function readData(text) {
  const data = JSON.parse(text);
  data.runs.forEach((run, index) => {
    run.index = index;
    run.metrics = new Map(run.metrics);
    if (!run.curves) return;
    const floats = decodeFloats(run.curves);
    const count = floats.length / data.columns.length;
    run.column = new Map(
        data.columns.map((name, i) => [name, floats.subarray(i * count, (i + 1) * count)]));
    run.curves = null;
  });
  return data;
}

/** The coordinates of the grid in which the runs differ, e.g. ['estimator', 'seed']. */
export function differingCoordinates(runs) {
  return ['stream', 'estimator', 'setting', 'perturbation', 'seed'].filter(
      (key) => new Set(runs.map((run) => run[key])).size > 1);
}

/** What tells a run from the others, in words. */
export function runName(run, coordinates) {
  const parts = coordinates.map((key) => (key === 'seed' ? `seed ${run.seed}` : String(run[key])));
  return parts.length > 0 ? parts.join(', ') : run.estimator;
}

/** 'none' or 'posyaw' where all runs are alike; 'own': each as it was started. */
export function firstAlignment(runs) {
  const shown = runs.filter((run) => run.column);
  if (shown.every((run) => run.from_truth)) return 'none';
  return shown.some((run) => run.from_truth) ? 'own' : 'posyaw';
}

/**
 * A run's curves with its estimate left where it is ('none') or moved by the position and yaw that
 * bring it nearest to the truth ('posyaw'); 'own': left where it was started from the truth. `moved`
 * says which it is: the position and yaw are not always determined. Errors are true minus estimate; orientation's is the
 * rotation vector of R_true R_estimate^T, in degrees. Positions are [x, y, z] arrays of columns.
 */
export function curvesOf(run, alignment) {
  run.aligned ||= {};
  const own = alignment === 'own' ? (run.from_truth ? 'none' : 'posyaw') : alignment;
  return (run.aligned[own] ||= makeCurves(run, own));
}

function makeCurves(run, alignment) {
  const columns = (names) => names.map((name) => run.column.get(name));
  const t = run.column.get('t');
  const p = columns(['p_x', 'p_y', 'p_z']);
  const r = columns(['r_x', 'r_y', 'r_z']);
  const e = columns(['e_p_x', 'e_p_y', 'e_p_z']);
  const theta = columns(['e_theta_x', 'e_theta_y', 'e_theta_z']);
  const covariance = columns(['P_xx', 'P_xy', 'P_xz', 'P_yy', 'P_yz', 'P_zz']);
  const variance = [covariance[0], covariance[3], covariance[5]];
  const make = () => [0, 1, 2].map(() => new Float64Array(t.length));
  const curves = {
    t,
    truth: make(),
    estimate: make(),
    covariance,
    rotation: null,
    position: {error: make(), sigma: variance.map((column) => Float64Array.from(column, Math.sqrt))},
    orientation: {
      error: make(),
      sigma: columns(['s_theta_x', 's_theta_y', 's_theta_z'])
                 .map((column) => Float64Array.from(column, (sigma) => sigma * kDegrees)),
    },
    attitude: [],  // quaternions of R_GB
    nees: Object.fromEntries(
        ['pose', 'position', 'orientation'].map((name) => [name, run.column.get(`nees_${name}`)])),
    has_truth: e[0].some(Number.isFinite),
    has_covariance: covariance[0].some(Number.isFinite),
  };
  const moved = alignment === 'posyaw' && Boolean(run.alignment);
  const identity = [0, 0, 0, 1];
  const R = moved ? run.alignment.R : identity;
  const shift = moved ? run.alignment.p : [0, 0, 0];
  const R_orientation = moved ? run.alignment.orientation_R : identity;
  curves.rotation = R;
  curves.moved = moved;
  for (let i = 0; i < t.length; ++i) {
    const p_i = [p[0][i], p[1][i], p[2][i]];
    const q_i = exponential([r[0][i], r[1][i], r[2][i]]);
    const estimate = rotate(R, p_i).map((value, k) => value + shift[k]);
    const q_true = product(exponential([theta[0][i], theta[1][i], theta[2][i]]), q_i);
    const q = product(R_orientation, q_i);
    const angle = logarithm(product(q_true, conjugate(q)));
    for (let k = 0; k < 3; ++k) {
      curves.truth[k][i] = p_i[k] + e[k][i];
      curves.estimate[k][i] = estimate[k];
      // Where nothing is moved, the error as it was written: it does not lose digits to p.
      curves.position.error[k][i] = moved ? curves.truth[k][i] - estimate[k] : e[k][i];
      curves.orientation.error[k][i] = (moved ? angle[k] : theta[k][i]) * kDegrees;
    }
    curves.attitude.push(q);
  }
  for (const part of [curves.position, curves.orientation]) {
    part.norm = Float64Array.from(t, (_, i) => Math.hypot(...part.error.map((c) => c[i])));
    part.sigma_norm = Float64Array.from(t, (_, i) => Math.hypot(...part.sigma.map((c) => c[i])));
  }
  return curves;
}

/** The index of the last instant not after `time`; the first where all are. */
export function indexAt(t, time) {
  let low = 0;
  let high = t.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (t[middle] <= time + 1e-6) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

/** L of the position's covariance P = L L^T at one instant, by rows; null where P is not definite. */
export function covarianceFactor(covariance, i) {
  const [xx, xy, xz, yy, yz, zz] = covariance.map((column) => column[i]);
  const a = Math.sqrt(xx);
  const b = xy / a;
  const c = xz / a;
  const d = Math.sqrt(yy - b * b);
  const e = (yz - b * c) / d;
  const f = Math.sqrt(zz - c * c - e * e);
  const factor = [a, 0, 0, b, d, 0, c, e, f];
  return factor.every(Number.isFinite) && a > 0 && d > 0 && f > 0 ? factor : null;
}
