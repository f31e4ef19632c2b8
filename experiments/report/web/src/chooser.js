// Which runs are shown: a table of all of them with a box to tick, filters, and steps through seeds.

import {button, dropDown, element, labelled, significant} from './dom.js';
import {swatch} from './plots.js';

// The table is narrow: the metrics' full titles stand in the tables and over the dots.
const kShort = {
  'ate.position_m': 'position [m]',
  'ate.orientation_deg': 'orientation [deg]',
  'nees.pose': 'NEES pose',
  coverage_share: 'coverage',
};
const kLabels = {
  stream: 'stream', estimator: 'estimator', setting: 'setting', perturbation: 'perturbation', seed: 'seed',
};

export class Chooser {
  constructor(host, store, coordinates, names) {
    this.host = host;
    this.store = store;
    this.coordinates = coordinates;
    this.names = names;
    this.filters = new Map();
    this.order = null;  // {key, down}
    this.status = element('p', {class: 'status', role: 'status'});
    this.metrics = this.shownMetrics();
    this.build();
    store.on('choice', () => this.mark());
    store.on('theme', () => this.mark());
  }

  shownMetrics() {
    const wanted = Object.keys(kShort);
    return wanted.filter((key) => this.store.data.runs.some((run) => run.metrics.has(key)))
        .map((key) => ({key, label: kShort[key]}));
  }

  build() {
    const filters = this.coordinates.map((key) => {
      const values = [...new Set(this.store.data.runs.map((run) => run[key]))];
      const options = [['', 'all'], ...values.map((value) => [String(value), String(value)])];
      return labelled(kLabels[key], dropDown(options, '', (value) => {
        this.filters.set(key, value);
        this.fill();
      }));
    });
    const steps = this.coordinates.includes('seed') ?
        [button('previous seed', () => this.step(-1)), button('next seed', () => this.step(1))] :
        [];
    this.body = element('tbody');
    this.head = element('tr');
    const table = element('table', {class: 'runs'},
                          element('caption', {class: 'hidden'}, 'Runs; ticked ones are shown'),
                          element('thead', {}, this.head), this.body);
    this.host.append(
        element('div', {class: 'bar'}, ...filters, ...steps,
                button('none', () => this.store.chooseOnly([]))),
        element('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Runs'}, table),
        this.status);
    this.fill();
  }

  fillHead() {
    const columns = [
      ...this.coordinates.map((key) => ({key, label: kLabels[key]})),
      ...this.metrics,
    ];
    const sortable = (column) => {
      const active = this.order?.key === column.key;
      const sorted = active ? (this.order.down ? 'descending' : 'ascending') : 'none';
      return element('th', {scope: 'col', 'aria-sort': sorted, class: column.key in kShort ? 'number' : null}, button(column.label, () => {
        this.order = {key: column.key, down: active && !this.order.down};
        this.fill();
        this.head.querySelectorAll('button')[columns.indexOf(column)].focus();
      }));
    };
    this.head.replaceChildren(element('th', {scope: 'col'}, 'show'), ...columns.map(sortable));
  }

  visibleRuns() {
    const runs = this.store.data.runs.filter(
        (run) => [...this.filters].every(([key, value]) => value === '' || String(run[key]) === value));
    if (!this.order) return runs;
    const {key, down} = this.order;
    const value = (run) => (key in kLabels ? run[key] : run.metrics.get(key) ?? NaN);
    return runs.sort((a, b) => {
      const [x, y] = down ? [value(b), value(a)] : [value(a), value(b)];
      if (typeof x === 'string') return x < y ? -1 : x > y ? 1 : 0;
      return Number.isFinite(x) && Number.isFinite(y) ? x - y : Number.isFinite(x) ? -1 : 1;
    });
  }

  fill() {
    this.fillHead();
    this.rows = this.visibleRuns().map((run) => {
      const box = element('input', {
        type: 'checkbox',
        'aria-label': this.names(run),
        disabled: !run.column,
        onchange: () => this.tick(run, box),
      });
      const key = element('span', {class: 'key'});
      const cells = this.coordinates.map((name) => element('td', {}, String(run[name])));
      const metrics = this.metrics.map(
          ({key: name}) => element('td', {class: 'number'}, significant(run.metrics.get(name))));
      const failed = run.failed ? [element('span', {class: 'failed', title: run.reason}, 'failed')] : [];
      const row = element('tr', {}, element('td', {class: 'show'}, element('label', {}, box, key, ...failed)),
                          ...cells, ...metrics);
      this.body.append(row);
      return {run, box, key, row};
    });
    this.body.replaceChildren(...this.rows.map(({row}) => row));
    this.mark();
  }

  tick(run, box) {
    if (this.store.choose(run, box.checked)) return;
    box.checked = false;
    this.say(`At most ${this.store.slots.length} runs are shown at once.`);
  }

  mark() {
    for (const {run, box, key, row} of this.rows) {
      const chosen = this.store.chosen.find((c) => c.run === run);
      box.checked = Boolean(chosen);
      row.classList.toggle('chosen', Boolean(chosen));
      key.replaceChildren(...(chosen ? [swatch(chosen.slot)] : []));
    }
    const failed = this.store.data.runs.filter((run) => run.failed).length;
    this.say(`${this.rows.length} of ${this.store.data.runs.length} runs listed, ` +
             `${this.store.chosen.length} shown${failed > 0 ? `, ${failed} failed` : ''}.`);
  }

  say(text) {
    this.status.textContent = text;
  }

  /** The same runs with the next seed that there is. */
  step(by) {
    const seeds = [...new Set(this.store.data.runs.map((run) => run.seed))].sort((a, b) => a - b);
    const chosen = this.store.chosen.map(({run}) => run);
    if (chosen.length === 0) return;
    const others = this.coordinates.filter((key) => key !== 'seed');
    const stepped = chosen.map((run) => {
      const seed = seeds[(seeds.indexOf(run.seed) + by + seeds.length) % seeds.length];
      return this.store.data.runs.find(
          (other) => other.seed === seed && others.every((key) => other[key] === run[key]));
    });
    this.store.chooseOnly(stepped.filter((run) => run));
  }
}
