// The time that is shown: a slider, and playing it.

import {button, dropDown, element, labelled} from './dom.js';

export class Scrubber {
  constructor(host, store) {
    this.store = store;
    this.speed = 2;
    this.steps = 1;
    this.slider = element('input', {
      type: 'range',
      class: 'scrubber',
      'aria-label': 'Time after the start',
      oninput: () => {
        this.stop();
        const share = Number(this.slider.value) / this.steps;
        store.setTime(store.earliest + share * (store.duration - store.earliest));
      },
    });
    this.output = element('output', {class: 'time'});
    this.play = button('Play', () => (this.frame ? this.stop() : this.start()), {class: 'play'});
    const speeds = [1, 2, 5, 10].map((s) => [String(s), `${s}×`]);
    host.append(this.play, this.slider, this.output,
                labelled('speed', dropDown(speeds, '2', (value) => (this.speed = Number(value)))));
    store.on('choice', () => this.adjust());
    store.on('time', () => this.show());
  }

  /** A step is a state, or as many as make 600 steps: both ends are reached exactly. */
  adjust() {
    const states = Math.max(1, ...this.store.chosen.map(({run}) => run.instants - 1));
    this.steps = Math.min(600, states);
    this.slider.min = 0;
    this.slider.max = this.steps;
    this.show();
  }

  show() {
    const {time, earliest, duration} = this.store;
    this.slider.value = Math.round(((time - earliest) / (duration - earliest || 1)) * this.steps);
    this.slider.setAttribute('aria-valuetext', `${time.toFixed(2)} seconds`);
    this.output.textContent = `${time.toFixed(2)} s`;
  }

  start() {
    if (this.store.time >= this.store.duration - 1e-6) this.store.setTime(this.store.earliest);
    this.play.textContent = 'Pause';
    let last = null;
    const advance = (now) => {
      if (last !== null) this.store.setTime(this.store.time + ((now - last) / 1000) * this.speed);
      last = now;
      if (this.store.time >= this.store.duration - 1e-6) return this.stop();
      this.frame = requestAnimationFrame(advance);
      return undefined;
    };
    this.frame = requestAnimationFrame(advance);
  }

  stop() {
    cancelAnimationFrame(this.frame);
    this.frame = null;
    this.play.textContent = 'Play';
  }
}
