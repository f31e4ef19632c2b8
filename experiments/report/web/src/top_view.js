// The trajectories from above, for browsers without WebGL: the same data on a flat canvas.

import {curvesOf, indexAt} from './data.js';
import {boundsOf, truthsOf} from './layout.js';
import {pageColor, slotColor} from './plots.js';
import {rotate} from './rotation.js';

const kSigmas = 3;

export class TopView {
  constructor(host, store) {
    this.host = host;
    this.store = store;
    this.magnification = 1;
    this.canvas = document.createElement('canvas');
    this.canvas.className = 'top-view';
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', 'Trajectories from above');
    host.append(this.canvas);
    for (const change of ['choice', 'time', 'theme']) store.on(change, () => this.update());
    new ResizeObserver(() => this.update()).observe(host);
  }

  rebuild() {
    this.update();
  }

  view() {}

  update() {
    const [width, height] = [this.host.clientWidth, this.host.clientHeight];
    const ratio = Math.min(2, devicePixelRatio);
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const context = this.canvas.getContext('2d');
    context.scale(ratio, ratio);
    const {low, high, step} = boundsOf(this.store);
    const margin = 40;
    const scale = Math.min((width - 2 * margin) / (high[0] - low[0]), (height - 2 * margin) / (high[1] - low[1]));
    const toX = (x) => width / 2 + (x - (low[0] + high[0]) / 2) * scale;
    const toY = (y) => height / 2 - (y - (low[1] + high[1]) / 2) * scale;
    this.drawGrid(context, {low, high, step, toX, toY});
    for (const curves of truthsOf(this.store)) {
      this.path(context, curves.truth, curves.t.length, toX, toY);
      context.setLineDash([5, 3]);
      context.strokeStyle = pageColor('--text');
      context.lineWidth = 1.5;
      context.stroke();
    }
    for (const {run, slot} of this.store.chosen) {
      const curves = curvesOf(run, this.store.alignment);
      const i = indexAt(curves.t, this.store.shownTime);
      context.setLineDash(slot.dash);
      context.strokeStyle = slotColor(slot);
      for (const [count, alpha, line] of [[curves.t.length, 0.3, 1.5], [i + 1, 1, 2.5]]) {
        this.path(context, curves.estimate, count, toX, toY);
        context.globalAlpha = alpha;
        context.lineWidth = line;
        context.stroke();
      }
      context.setLineDash([]);
      this.ellipse(context, curves, i, toX, toY, scale, slotColor(slot));
    }
  }

  drawGrid(context, {low, high, step, toX, toY}) {
    context.strokeStyle = pageColor('--grid');
    context.fillStyle = pageColor('--text');
    context.font = '12px system-ui, sans-serif';
    context.lineWidth = 1;
    const name = (value) => String(+value.toFixed(6));
    context.beginPath();
    context.textAlign = 'center';
    for (let x = low[0]; x <= high[0] + 1e-9; x += step) {
      context.moveTo(toX(x), toY(low[1]));
      context.lineTo(toX(x), toY(high[1]));
      context.fillText(name(x), toX(x), toY(low[1]) + 15);
    }
    context.textAlign = 'right';
    for (let y = low[1]; y <= high[1] + 1e-9; y += step) {
      context.moveTo(toX(low[0]), toY(y));
      context.lineTo(toX(high[0]), toY(y));
      context.fillText(name(y), toX(low[0]) - 6, toY(y) + 4);
    }
    context.stroke();
    context.textAlign = 'center';
    context.fillText('x [m]', (toX(low[0]) + toX(high[0])) / 2, toY(low[1]) + 32);
    context.textAlign = 'left';
    context.fillText('y [m]', toX(low[0]) - 20, toY(high[1]) - 10);
  }

  path(context, columns, count, toX, toY) {
    context.beginPath();
    for (let i = 0; i < count; ++i) {
      if (Number.isFinite(columns[0][i])) context.lineTo(toX(columns[0][i]), toY(columns[1][i]));
    }
  }

  /** What the ellipsoid looks like from above: that of the covariance's upper left 2 x 2. */
  ellipse(context, curves, i, toX, toY, scale, color) {
    context.fillStyle = color;
    const [x, y] = [toX(curves.estimate[0][i]), toY(curves.estimate[1][i])];
    context.beginPath();
    context.arc(x, y, 4, 0, 2 * Math.PI);
    context.fill();
    const [xx, xy, , yy] = curves.covariance.map((column) => column[i]);
    const yaw = Math.atan2(...[1, 0].map((k) => rotate(curves.rotation, [1, 0, 0])[k]));
    const mean = (xx + yy) / 2;
    const half = Math.hypot((xx - yy) / 2, xy);
    if (!(mean - half > 0)) return;
    const size = (variance) => kSigmas * this.magnification * Math.sqrt(variance) * scale;
    const angle = yaw + Math.atan2(2 * xy, xx - yy) / 2;
    context.beginPath();
    context.ellipse(x, y, size(mean + half), size(mean - half), -angle, 0, 2 * Math.PI);
    context.globalAlpha = 0.25;
    context.fill();
    context.globalAlpha = 1;
  }
}
