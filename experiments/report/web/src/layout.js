// What the views of the trajectories have in common: which truths there are, and how large all is.

import {covarianceFactor, curvesOf} from './data.js';

/** Curves with a truth, one for each input among the chosen runs: the longest. */
export function truthsOf(store) {
  const longest = new Map();
  for (const {run} of store.chosen) {
    const curves = curvesOf(run, store.alignment);
    if (!curves.has_truth) continue;
    const other = longest.get(run.stream_id);
    if (!other || other.t.length < curves.t.length) longest.set(run.stream_id, curves);
  }
  return [...longest.values()];
}

/** 1, 2 or 5 times a power of ten: about `count` steps in `length`. */
export function gridStep(length, count) {
  const rough = Math.max(1e-6, length / count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const share = rough / power;
  return power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
}

/**
 * A box of whole grid steps around all that is chosen, its middle and the radius of a ball around
 * it. A trajectory that has gone astray (more than ten times as far as the truth) is left out: it
 * would make the rest a dot.
 */
export function boundsOf(store) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const include = (columns, within) => {
    for (let i = 0; i < columns[0].length; ++i) {
      for (let k = 0; k < 3; ++k) {
        const value = columns[k][i];
        if (!Number.isFinite(value) || (within && Math.abs(value - within.center[k]) > within.reach)) continue;
        low[k] = Math.min(low[k], value);
        high[k] = Math.max(high[k], value);
      }
    }
  };
  for (const curves of truthsOf(store)) include(curves.truth);
  const within = Number.isFinite(low[0]) && {
    center: low.map((l, k) => (l + high[k]) / 2),
    reach: 5 * Math.max(0.1, ...low.map((l, k) => high[k] - l)),
  };
  for (const {run} of store.chosen) include(curvesOf(run, store.alignment).estimate, within);
  if (!Number.isFinite(low[0])) {
    low.fill(-1);
    high.fill(1);
  }
  const extent = Math.max(...low.map((l, k) => high[k] - l), 1e-3);
  const step = gridStep(extent, 6);
  const snappedLow = low.map((l) => Math.floor(l / step) * step);
  const snappedHigh = high.map((h) => Math.ceil(h / step) * step);
  for (let k = 0; k < 2; ++k) {
    if (snappedHigh[k] <= snappedLow[k]) snappedHigh[k] += step;
  }
  const center = snappedLow.map((l, k) => (l + snappedHigh[k]) / 2);
  const radius = Math.max(step, Math.hypot(...snappedLow.map((l, k) => snappedHigh[k] - l)) / 2);
  const key = [...snappedLow, ...snappedHigh].map((v) => v.toPrecision(9)).join();
  return {low: snappedLow, high: snappedHigh, floor: snappedLow[2], step, center, radius, key};
}

export const kMagnifications = [1 / 1000, 1 / 300, 1 / 100, 1 / 30, 1 / 10, 1 / 3, 1, 3, 10, 30, 100, 300];

/**
 * How much larger than they are ellipsoids are drawn: as they are, unless they could not be seen or
 * would hide the rest.
 */
export function fittingMagnification(store) {
  const kSamples = 20;
  const sizes = [];
  for (const {run} of store.chosen) {
    const {covariance, t} = curvesOf(run, store.alignment);
    for (let k = 0; k <= kSamples; ++k) {
      const L = covarianceFactor(covariance, Math.round((k / kSamples) * (t.length - 1)));
      if (L) sizes.push((3 * Math.hypot(...L)) / Math.sqrt(3));
    }
  }
  if (sizes.length === 0) return 1;
  sizes.sort((a, b) => a - b);
  const share = sizes[sizes.length >> 1] / boundsOf(store).radius;
  if (share > 0.02 && share < 0.3) return 1;
  return kMagnifications.find((m) => m * share >= 0.03) ?? kMagnifications.at(-1);
}
