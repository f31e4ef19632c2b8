// The error plots: one uPlot a quantity, all of them over the same time, with one cursor. Bands are
// the estimators' own +-3 sigma.

import uPlot from 'uplot';
import {curvesOf, indexAt} from './data.js';
import {element, significant} from './dom.js';

const kSigmas = 3;
const kHeight = 150;

/** A colour of the page, so that plots follow light and dark. */
export function pageColor(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export function slotColor(slot) {
  return matchMedia('(prefers-color-scheme: dark)').matches ? slot.light : slot.color;
}

function translucent(hex, alpha) {
  return hex + Math.round(alpha * 255).toString(16).padStart(2, '0');
}

/** What the plots are of: title, unit, and a function from a run's curves to value and sigma. */
function quantities(store) {
  const list = [];
  const parts = [
    ['position', 'Position error', 'm', ['x', 'y', 'z']],
    ['orientation', 'Orientation error', 'deg', ['about x', 'about y', 'about z']],
  ];
  for (const [key, title, unit, axes] of parts) {
    if (store.components === 'norm') {
      list.push({
        group: title,
        label: `${key} error [${unit}]`,
        oneSided: true,
        values: (curves) => ({value: curves[key].norm, sigma: curves[key].sigma_norm}),
      });
      continue;
    }
    axes.forEach((axis, k) => list.push({
      group: title,
      label: `${axis} [${unit}]`,
      values: (curves) => ({value: curves[key].error[k], sigma: curves[key].sigma[k]}),
    }));
  }
  const dof = store.data.nees[store.nees].dof;
  list.push({
    group: `NEES of the ${store.nees}, ${dof} degrees of freedom`,
    label: 'NEES',
    wide: true,
    logarithmic: true,
    band: store.data.nees[store.nees].band,
    values: (curves) => ({
      value: Float64Array.from(curves.nees[store.nees], (n) => (n > 0 ? n : NaN)),
      sigma: null,
    }),
  });
  return list;
}

// uPlot: null is a gap, undefined is an instant that only other runs have.
const gapped = (values) => Array.from(values, (v) => (Number.isFinite(v) ? v : null));

/** The columns that uPlot draws for one quantity, and how. */
function seriesOf(store, quantity) {
  const tables = [];
  const series = [{label: 'time'}];
  const bands = [];
  for (const {run, slot} of store.chosen) {
    const curves = curvesOf(run, store.alignment);
    const {value, sigma} = quantity.values(curves);
    const color = slotColor(slot);
    const columns = [gapped(value)];
    const line = {
      stroke: color,
      width: 1.75,
      dash: slot.dash,
      points: {show: false},
    };
    if (sigma && !curves.moved && curves.has_covariance) {
      const edge = {
        stroke: translucent(color, 0.55),
        width: 1,
        points: {show: false},
      };
      const upper = gapped(sigma).map((s) => (s === null ? null : kSigmas * s));
      columns.push(upper);
      series.push(line, edge);
      if (!quantity.oneSided) {
        columns.push(upper.map((u) => (u === null ? null : -u)));
        series.push({...edge});
        const last = series.length - 1;
        bands.push({series: [last - 1, last], fill: translucent(color, 0.13)});
      }
    } else {
      series.push(line);
    }
    tables.push([Array.from(curves.t), ...columns]);
  }
  return {data: tables.length > 0 ? uPlot.join(tables) : [[0]], series, bands};
}

export class Plots {
  constructor(host, store) {
    this.host = host;
    this.store = store;
    this.plots = [];
    this.range = null;  // of time, where zoomed
    store.on('choice', () => this.rebuild());
    store.on('theme', () => this.rebuild());
    store.on('time', () => this.placeScrubber());
    new ResizeObserver(() => this.resize()).observe(host);
  }

  rebuild() {
    for (const {plot} of this.plots) plot.destroy();
    this.plots = [];
    this.host.replaceChildren();
    if (this.store.chosen.length === 0) {
      this.host.append(element('p', {class: 'note'}, 'Choose a run to see its errors.'));
      return;
    }
    const groups = new Map();
    for (const quantity of quantities(this.store)) {
      if (!groups.has(quantity.group)) {
        const box = element('figure', {class: quantity.wide ? 'plots wide' : 'plots'},
                            element('figcaption', {}, quantity.group));
        groups.set(quantity.group, box);
        this.host.append(box);
      }
      this.add(groups.get(quantity.group), quantity);
    }
    for (const box of groups.values()) {
      const own = this.plots.filter((p) => p.box === box);
      own.forEach((p, i) => this.make(p, i === own.length - 1));
    }
    this.placeScrubber();
  }

  add(box, quantity) {
    const {data, series, bands} = seriesOf(this.store, quantity);
    const target = element('div', {class: 'plot'});
    box.append(target);
    const has = data.slice(1).some((column) => column.some((v) => v !== null && v !== undefined));
    this.plots.push({box, target, quantity, data, series, bands, has, plot: null});
  }

  make(entry, last) {
    const {target, quantity, data, series, bands} = entry;
    if (!entry.has) {
      target.append(element('p', {class: 'note'}, `${quantity.label}: not in these records.`));
      entry.plot = {destroy() {}, setSize() {}, setScale() {}, over: null};
      return;
    }
    const line = element('div', {class: 'scrub-line'});
    const peek = element('div', {class: 'scrub-line peek', hidden: true});
    const text = pageColor('--text');
    const axis = {
      stroke: text,
      font: '12px system-ui, sans-serif',
      labelFont: '12px system-ui, sans-serif',
      grid: {stroke: pageColor('--grid'), width: 1},
      ticks: {stroke: pageColor('--grid'), width: 1, size: 4},
    };
    const height = last ? kHeight + 38 : kHeight;
    const options = {
      width: Math.max(200, target.clientWidth),
      height,
      legend: {show: false},
      padding: [8, 10, last ? 0 : 6, 0],
      cursor: {
        sync: {key: 'duet', scales: ['x', null]},
        y: false,
        points: {size: 6},
        drag: {x: true, y: false, setScale: true},
        dataIdx: (plot, column, hovered) => nearestWithValue(plot.data[column], hovered),
      },
      scales: {
        x: {time: false, range: () => this.range ?? [this.store.earliest, this.store.duration]},
        y: quantity.logarithmic
               ? {distr: 3, range: (_, low, high) => logRange(low, high, quantity.band)}
               : {range: (_, low, high) => paddedRange(low, high, quantity.oneSided)},
      },
      axes: [
        {...axis, label: last ? 'time [s]' : null, labelSize: last ? 18 : 0,
         size: last ? 26 : 6, values: last ? undefined : (_, ticks) => ticks.map(() => '')},
        {...axis, label: quantity.label, labelSize: 18, size: 54,
         ...(quantity.logarithmic ? {splits: (_, i, low, high) => decades(low, high), filter: (_, ticks) => ticks} : {}),
         values: quantity.logarithmic ? (_, ticks) => ticks.map(powerOfTen)
                                      : (_, ticks) => ticks.map((v) => String(+v.toPrecision(6)))},
      ],
      series,
      bands,
      hooks: {
        drawClear: [(plot) => this.drawBackground(plot, quantity)],
        setCursor: [(plot) => this.peek(plot)],
        setScale: [(plot, scale) => this.zoomAll(plot, scale)],
        ready: [(plot) => {
          plot.over.append(line, peek);
          plot.over.addEventListener('mouseleave', () => this.store.setPeek(null));
          this.setTimeOnClick(plot);
          this.placeScrubber();  // uPlot has its scales only now
        }],
      },
    };
    entry.lines = [line, peek];
    entry.last = last;
    entry.plot = new uPlot(options, data, target);
    entry.plot.root.setAttribute('role', 'img');
    entry.plot.root.setAttribute('aria-label', this.describe(quantity));
  }

  describe(quantity) {
    const parts = this.store.chosen.map(({run}) => {
      const {value} = quantity.values(curvesOf(run, this.store.alignment));
      const finite = Array.from(value).filter(Number.isFinite);
      if (finite.length === 0) return `${run.estimator}: none`;
      return `${run.estimator}: ${significant(Math.min(...finite))} to ` +
          `${significant(Math.max(...finite))}`;
    });
    return `${quantity.group}, ${quantity.label}, over time. ${parts.join('; ')}.`;
  }

  /** The line at zero, or the band that a consistent estimator's NEES stays in. */
  drawBackground(plot, quantity) {
    const {ctx} = plot;
    const {left, top, width, height} = plot.bbox;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    if (quantity.band) {
      const low = plot.valToPos(quantity.band[0], 'y', true);
      const high = plot.valToPos(quantity.band[1], 'y', true);
      ctx.fillStyle = pageColor('--band');
      ctx.fillRect(left, high, width, low - high);
    } else {
      const zero = plot.valToPos(0, 'y', true);
      ctx.fillStyle = pageColor('--axis');
      ctx.fillRect(left, Math.round(zero), width, Math.max(1, devicePixelRatio));
    }
    ctx.restore();
  }

  peek(plot) {
    // Of the plot under the pointer only: the others follow it.
    if (plot.cursor.event == null || !plot.over.matches(':hover')) return;
    const {left} = plot.cursor;
    this.store.setPeek(left === null || left < 0 ? null : plot.posToVal(left, 'x'));
  }

  setTimeOnClick(plot) {
    let pressed = null;
    plot.over.addEventListener('mousedown', (event) => (pressed = event.clientX));
    plot.over.addEventListener('mouseup', (event) => {
      if (pressed === null || Math.abs(event.clientX - pressed) > 3) return;
      const left = event.clientX - plot.over.getBoundingClientRect().left;
      this.store.setTime(plot.posToVal(left, 'x'));
    });
    plot.over.addEventListener('dblclick', () => this.setRange(null));
  }

  zoomAll(plot, scale) {
    if (scale !== 'x' || this.zooming) return;
    const {min, max} = plot.scales.x;
    const whole = [this.store.earliest, this.store.duration];
    const current = this.range ?? whole;
    if (min === current[0] && max === current[1]) return;
    this.setRange([min, max]);
  }

  /** Time from `range[0]` to `range[1]` in all plots; null: all of it. */
  setRange(range) {
    this.range = range;
    this.zooming = true;
    const [min, max] = range ?? [this.store.earliest, this.store.duration];
    for (const {plot} of this.plots) plot.setScale('x', {min, max});
    this.zooming = false;
    this.placeScrubber();
  }

  /** Shows `factor` times the time that is shown, about the scrubber; at most all of it. */
  zoom(factor) {
    const whole = [this.store.earliest, this.store.duration];
    const [from, to] = this.range ?? whole;
    const width = Math.max(0.05, (to - from) * factor);
    if (width >= whole[1] - whole[0]) return this.setRange(null);
    const middle = Math.min(Math.max(this.store.time, from), to);
    const start = Math.min(Math.max(middle - width / 2, whole[0]), whole[1] - width);
    return this.setRange([start, start + width]);
  }

  /** The scrubber's line, and a second one for what is under the pointer in the trajectories. */
  placeScrubber() {
    const inPlots = this.host.matches(':hover');  // uPlot has its own line there
    const times = [this.store.time, inPlots ? null : this.store.peek];
    for (const {plot, lines} of this.plots) {
      lines?.forEach((line, i) => {
        const left = times[i] === null ? NaN : plot.valToPos(times[i], 'x');
        line.hidden = !(left > -1 && left < plot.over.clientWidth + 1);
        if (!line.hidden) line.style.transform = `translateX(${Math.round(left)}px)`;
      });
    }
  }

  resize() {
    for (const {plot, target, last} of this.plots) {
      plot.setSize({width: Math.max(200, target.clientWidth), height: last ? kHeight + 38 : kHeight});
    }
    this.placeScrubber();
  }
}

function nearestWithValue(column, index) {
  if (!column || column[index] !== undefined) return index;
  for (let step = 1; step < column.length; ++step) {
    if (column[index - step] !== undefined && column[index - step] !== null) return index - step;
    if (column[index + step] !== undefined && column[index + step] !== null) return index + step;
  }
  return index;
}

function paddedRange(low, high, oneSided) {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [-1, 1];
  const reach = Math.max(Math.abs(low), Math.abs(high)) || 1e-3;
  return oneSided ? [0, 1.06 * reach] : [Math.min(low * 1.06, 0.06 * -reach), Math.max(high * 1.06, 0.06 * reach)];
}

function logRange(low, high, band) {
  const least = Math.max(1e-3, Math.min(low > 0 ? low : band[0], band[0] / 2));
  const most = Math.max(high > 0 ? high : band[1], band[1] * 2);
  return [10 ** Math.floor(Math.log10(least)), 10 ** Math.ceil(Math.log10(most))];
}

function decades(low, high) {
  const from = Math.round(Math.log10(low));
  const count = Math.round(Math.log10(high)) - from;
  const every = Math.ceil(count / 5);
  return Array.from({length: Math.floor(count / every) + 1}, (_, i) => 10 ** (from + i * every));
}

function powerOfTen(value) {
  if (value === null) return '';
  const exponent = Math.log10(value);
  return value >= 0.01 && value <= 1000 ? String(+value.toPrecision(1)) : `1e${Math.round(exponent)}`;
}

/** The numbers at the shown instant, one row a chosen run. */
export function readout(store, names) {
  const rows = store.chosen.map(({run, slot}) => {
    const curves = curvesOf(run, store.alignment);
    const i = indexAt(curves.t, store.shownTime);
    const withSigma = !curves.moved && curves.has_covariance;
    const cell = (value) => element('td', {}, significant(value));
    const sigma = (value) => element('td', {}, withSigma ? significant(kSigmas * value) : '–');
    return element('tr', {}, element('th', {scope: 'row'}, swatch(slot), names(run)),
                   element('td', {}, curves.t[i].toFixed(2)),
                   cell(curves.position.norm[i]), sigma(curves.position.sigma_norm[i]),
                   cell(curves.orientation.norm[i]), sigma(curves.orientation.sigma_norm[i]),
                   cell(curves.nees.pose[i]));
  });
  const head = ['run', 'time [s]', 'position error [m]', '3σ [m]', 'orientation error [deg]',
                '3σ [deg]', 'NEES of the pose'];
  return element('table', {class: 'readout'},
                 element('caption', {}, store.peek === null ? 'At the scrubber' : 'Under the pointer'),
                 element('thead', {}, element('tr', {}, ...head.map((h) => element('th', {scope: 'col'}, h)))),
                 element('tbody', {}, ...rows));
}

const kSvg = 'http://www.w3.org/2000/svg';

/** A run's line as a key: colour and style. */
export function swatch(slot) {
  const svg = document.createElementNS(kSvg, 'svg');
  svg.setAttribute('class', 'swatch');
  svg.setAttribute('viewBox', '0 0 34 10');
  svg.setAttribute('role', 'img');
  svg.setAttribute('aria-label', `${slot.name} line`);
  const line = document.createElementNS(kSvg, 'line');
  const attributes = {x1: 1, y1: 5, x2: 33, y2: 5, stroke: slotColor(slot), 'stroke-width': 3};
  for (const [name, value] of Object.entries(attributes)) line.setAttribute(name, value);
  line.setAttribute('stroke-dasharray', slot.dash.map((d) => d * 0.75).join(' '));
  svg.append(line);
  return svg;
}
