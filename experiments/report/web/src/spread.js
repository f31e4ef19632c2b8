// One metric over all runs: a column of dots for each estimator, setting and perturbation, the median
// as a bar. A click on a dot shows the run.

import {dropDown, element, labelled, significant} from './dom.js';
import {gridStep} from './layout.js';
import {kSlots} from './store.js';
import {slotColor} from './plots.js';

const kSvg = 'http://www.w3.org/2000/svg';
const kWidth = 420;
const kHeight = 190;
const kLeft = 56;
const kBottom = 40;

function svg(tag, attributes, ...children) {
  const made = document.createElementNS(kSvg, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

function median(sorted) {
  const middle = sorted.length >> 1;
  return sorted.length % 2 === 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

function roundTicks(from, to) {
  const step = gridStep(to - from, 5);
  const first = Math.ceil(from / step - 1e-9);
  const count = Math.floor(to / step + 1e-9) - first + 1;
  return Array.from({length: count}, (_, i) => +((first + i) * step).toPrecision(6));
}

export class Spread {
  constructor(host, store, names) {
    this.host = host;
    this.store = store;
    this.names = names;
    const keys = [...new Set(store.data.runs.flatMap((run) => [...run.metrics.keys()]))].filter((key) =>
        store.data.runs.filter((run) => Number.isFinite(run.metrics.get(key))).length > 1);
    if (keys.length === 0) return;
    this.key = keys.includes('ate.position_m') ? 'ate.position_m' : keys[0];
    this.plot = element('div');
    host.append(element('div', {class: 'bar'}, labelled('over all runs', dropDown(
        keys.map((key) => [key, this.title(key)]), this.key, (value) => {
          this.key = value;
          this.draw();
        }))), this.plot);
    store.on('choice', () => this.draw());
    store.on('theme', () => this.draw());
  }

  title(key) {
    return this.store.data.metrics[key]?.label ?? key;
  }

  columns() {
    const {runs} = this.store.data;
    const axes = ['stream', 'estimator', 'setting', 'perturbation'].filter(
        (key) => new Set(runs.map((run) => run[key])).size > 1);
    const columns = new Map();
    for (const run of runs) {
      const value = run.metrics.get(this.key);
      const name = axes.map((key) => run[key]).join(', ') || run.estimator;
      if (!columns.has(name)) columns.set(name, []);
      if (Number.isFinite(value)) columns.get(name).push({run, value});
    }
    return [...columns];
  }

  draw() {
    const columns = this.columns();
    const values = columns.flatMap(([, points]) => points.map(({value}) => value));
    const high = Math.max(...values);
    const low = Math.min(...values);
    const logarithmic = low > 0 && high / low > 30;
    const place = (v) => (logarithmic ? Math.log10(v) : v);
    const from = logarithmic ? Math.floor(place(low)) : Math.min(0, low);
    const to = logarithmic ? Math.ceil(place(high)) : high * 1.06 || 1;
    const y = (v) => 8 + (1 - (place(v) - from) / (to - from || 1)) * (kHeight - kBottom - 8);
    const wide = (kWidth - kLeft - 8) / columns.length;

    const drawing = svg('svg', {viewBox: `0 0 ${kWidth} ${kHeight}`, class: 'spread-plot', role: 'img'});
    drawing.setAttribute('aria-label', `${this.title(this.key)} over all runs. ` + columns.map(([name, points]) => {
      const sorted = points.map(({value}) => value).sort((a, b) => a - b);
      return sorted.length === 0 ? `${name}: none` : `${name}: median ${significant(median(sorted))} of ${sorted.length}`;
    }).join('; '));
    const ticks = logarithmic ? Array.from({length: to - from + 1}, (_, i) => 10 ** (from + i)) :
                                roundTicks(from, to);
    for (const tick of ticks) {
      drawing.append(svg('line', {x1: kLeft, x2: kWidth, y1: y(tick), y2: y(tick), class: 'rule'}),
                     svg('text', {x: kLeft - 6, y: y(tick) + 4, class: 'tick', 'text-anchor': 'end'}, String(tick)));
    }
    columns.forEach(([name, points], c) => {
      const middle = kLeft + (c + 0.5) * wide;
      const reach = Math.min(60, wide * 0.36);
      const sorted = points.map(({value}) => value).sort((a, b) => a - b);
      if (sorted.length > 0) {
        const m = y(median(sorted));
        drawing.append(svg('line', {x1: middle - reach, x2: middle + reach, y1: m, y2: m, class: 'median'}));
      }
      points.forEach(({run, value}, i) => {
        const x = middle + reach * 0.85 * (points.length > 1 ? (2 * i) / (points.length - 1) - 1 : 0);
        const chosen = this.store.chosen.find((item) => item.run === run);
        const own = kSlots[this.store.data.estimators.indexOf(run.estimator)] ?? kSlots[0];
        const dot = svg('circle', {
          cx: x, cy: y(value), r: chosen ? 6 : 4, fill: slotColor(chosen?.slot ?? own),
          class: chosen ? 'dot chosen' : run.failed ? 'dot failed' : 'dot',
        }, svg('title', {}, `${this.names(run)}: ${significant(value)}`));
        dot.addEventListener('click', () => this.store.choose(run, !this.store.isChosen(run)));
        drawing.append(dot);
      });
      const label = name.length * 6.5 > wide ? `${name.slice(0, Math.max(3, Math.floor(wide / 6.5) - 1))}…` : name;
      drawing.append(svg('text', {x: middle, y: kHeight - kBottom + 16, class: 'tick', 'text-anchor': 'middle'},
                         label, svg('title', {}, name)));
    });
    drawing.append(svg('text', {x: kLeft, y: kHeight - 6, class: 'tick'}, 'bar: median; click a dot to show its run'));
    this.plot.replaceChildren(drawing);
  }
}
