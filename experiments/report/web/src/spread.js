// One metric over all runs: a row of dots for each stream, estimator, setting and perturbation, the
// median as a bar. A click on a dot shows the run.

import {dropDown, element, labelled, significant} from './dom.js';
import {gridStep} from './layout.js';
import {kSlots} from './store.js';
import {slotColor} from './plots.js';

const kSvg = 'http://www.w3.org/2000/svg';
const kWidth = 470;
const kRow = 26;
const kTop = 6;
const kAxis = 36;
const kRight = 14;
const kLetter = 7.2;  // width of a letter of the labels, about

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
    const left = Math.min(210, 14 + kLetter * Math.max(...columns.map(([name]) => name.length)));
    const x = (v) => left + ((place(v) - from) / (to - from || 1)) * (kWidth - kRight - left);
    const bottom = kTop + kRow * columns.length;
    const drawing = svg('svg', {viewBox: `0 0 ${kWidth} ${bottom + kAxis}`, class: 'spread-plot', role: 'img'});
    drawing.setAttribute('aria-label', `${this.title(this.key)} over all runs. ` + columns.map(([name, points]) => {
      const sorted = points.map(({value}) => value).sort((a, b) => a - b);
      return sorted.length === 0 ? `${name}: none` : `${name}: median ${significant(median(sorted))} of ${sorted.length}`;
    }).join('; '));
    const ticks = logarithmic ? Array.from({length: to - from + 1}, (_, i) => 10 ** (from + i)) :
                                roundTicks(from, to);
    for (const tick of ticks) {
      drawing.append(svg('line', {x1: x(tick), x2: x(tick), y1: kTop, y2: bottom, class: 'rule'}),
                     svg('text', {x: x(tick), y: bottom + 14, class: 'tick', 'text-anchor': 'middle'}, String(tick)));
    }
    columns.forEach(([name, points], c) => {
      const middle = kTop + (c + 0.5) * kRow;
      const most = Math.floor((left - 14) / kLetter);
      drawing.append(svg('text', {x: left - 8, y: middle + 4, class: 'tick', 'text-anchor': 'end'},
                         name.length > most ? `${name.slice(0, most - 1)}…` : name, svg('title', {}, name)));
      const sorted = points.map(({value}) => value).sort((a, b) => a - b);
      if (sorted.length > 0) {
        const m = x(median(sorted));
        drawing.append(svg('line', {x1: m, x2: m, y1: middle - kRow * 0.45, y2: middle + kRow * 0.45, class: 'median'}));
      }
      points.forEach(({run, value}, i) => {
        // Apart from one another, by their order: nothing is drawn at random.
        const y = middle + kRow * 0.3 * (points.length > 1 ? (2 * i) / (points.length - 1) - 1 : 0);
        const chosen = this.store.chosen.find((item) => item.run === run);
        const own = kSlots[this.store.data.estimators.indexOf(run.estimator)] ?? kSlots[0];
        const dot = svg('circle', {
          cx: x(value), cy: y, r: chosen ? 5.5 : 3.5, fill: slotColor(chosen?.slot ?? own),
          class: chosen ? 'dot chosen' : run.failed ? 'dot failed' : 'dot',
        }, svg('title', {}, `${this.names(run)}: ${significant(value)}`));
        dot.addEventListener('click', () => this.store.choose(run, !this.store.isChosen(run)));
        drawing.append(dot);
      });
    });
    drawing.append(svg('text', {x: kWidth - kRight, y: bottom + 31, class: 'tick', 'text-anchor': 'end'},
                       'bar: median; a click on a dot shows its run'));
    this.plot.replaceChildren(drawing);
  }
}
