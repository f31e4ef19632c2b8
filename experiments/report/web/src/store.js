// What is shown: one object that all views read, and that tells them when it has changed.

import {firstAlignment} from './data.js';

/** Colours of Okabe and Ito that stand out on white and on dark; the line style is the second cue. */
export const kSlots = [
  {color: '#0072b2', light: '#4aa8e0', dash: [], name: 'solid'},
  {color: '#d55e00', light: '#f0803c', dash: [9, 5], name: 'dashed'},
  {color: '#009e73', light: '#2fc79b', dash: [12, 4, 3, 4], name: 'dash-dotted'},
  {color: '#cc79a7', light: '#e29cc3', dash: [3, 4], name: 'dotted'},
  {color: '#b67d00', light: '#e69f00', dash: [18, 6], name: 'long dashes'},
  {color: '#3a9bd6', light: '#8fd0f5', dash: [12, 4, 3, 4, 3, 4], name: 'dash-dot-dotted'},
];

/** Changes: 'choice' (runs, alignment, components, what the plots show), 'time', 'theme'. */
export class Store {
  constructor(data) {
    this.data = data;
    this.slots = new Array(kSlots.length).fill(null);  // runs
    this.alignment = firstAlignment(data.runs);
    this.components = 'xyz';
    this.nees = 'pose';
    this.time = 0;
    this.peek = null;  // an instant under the pointer: shown while it is there
    this.listeners = {choice: [], time: [], theme: []};
  }

  on(change, listener) {
    this.listeners[change].push(listener);
  }

  tell(change) {
    for (const listener of this.listeners[change]) listener();
  }

  /** [{run, slot}] in the order of the slots. */
  get chosen() {
    return this.slots.map((run, i) => ({run, slot: kSlots[i], number: i})).filter((c) => c.run);
  }

  get full() {
    return this.slots.every((run) => run);
  }

  get shownTime() {
    return this.peek ?? this.time;
  }

  get duration() {
    return Math.max(1e-3, ...this.chosen.map(({run}) => run.column.get('t').at(-1)));
  }

  get earliest() {
    const first = Math.min(...this.chosen.map(({run}) => run.column.get('t')[0]));
    return Number.isFinite(first) ? first : 0;
  }

  isChosen(run) {
    return this.slots.includes(run);
  }

  /** False where no slot is free or the run has no curves. */
  choose(run, on) {
    if (on === this.isChosen(run)) return true;
    if (!run.column) return false;
    const slot = on ? this.freeSlot(run) : this.slots.indexOf(run);
    if (slot < 0) return false;
    this.slots[slot] = on ? run : null;
    this.settle();
    return true;
  }

  chooseOnly(runs) {
    this.slots.fill(null);
    for (const run of runs) {
      if (!run.column) continue;
      const slot = this.freeSlot(run);
      if (slot >= 0) this.slots[slot] = run;
    }
    this.settle();
  }

  /** An estimator keeps its own colour where it is free: the first ones are theirs. */
  freeSlot(run) {
    const own = this.data.estimators.indexOf(run.estimator);
    if (own >= 0 && own < this.slots.length && !this.slots[own]) return own;
    const others = this.slots.findIndex((r, i) => !r && i >= this.data.estimators.length);
    return others >= 0 ? others : this.slots.indexOf(null);
  }

  settle() {
    if (this.chosen.length > 0) this.time = Math.min(Math.max(this.time, this.earliest), this.duration);
    this.peek = null;
    this.tell('choice');
    this.tell('time');
  }

  setTime(time) {
    this.time = Math.min(Math.max(time, this.earliest), this.duration);
    this.peek = null;
    this.tell('time');
  }

  setPeek(time) {
    if (this.peek === time) return;
    this.peek = time;
    this.tell('time');
  }

  set(key, value) {
    this[key] = value;
    this.tell('choice');
    this.tell('time');
  }
}
