// The interactive part of a report: builds itself into #explorer from the data in #report-data.

import {Chooser} from './chooser.js';
import {curvesOf, differingCoordinates, readData, runName} from './data.js';
import {button, dropDown, element, labelled} from './dom.js';
import {fittingMagnification, kMagnifications} from './layout.js';
import {Plots, readout, swatch} from './plots.js';
import {Scrubber} from './scrubber.js';
import {Spread} from './spread.js';
import {openWebGl, Trajectories} from './scene.js';
import {Store} from './store.js';
import {TopView} from './top_view.js';

/** One run of each estimator (the first that did not fail) of the first stream and seed. */
function firstChoice(data) {
  const usable = data.runs.filter((run) => run.column);
  const first = usable.find((run) => !run.failed) ?? usable[0];
  if (!first) return [];
  const alike = usable.filter((run) => ['stream', 'setting', 'perturbation', 'seed'].every(
      (key) => run[key] === first[key]));
  return alike.slice(0, 3);
}

function makeView(host, store, names) {
  const canvas = element('canvas', {
    class: 'view-3d',
    tabindex: 0,
    role: 'application',
    'aria-label': 'Trajectories in 3-D. Arrow keys turn, with shift they move, plus and minus zoom, ' +
        'zero shows all.',
  });
  const context = openWebGl(canvas);
  if (context) return new Trajectories(host, store, context, canvas, names);
  return new TopView(host, store);
}

function trajectoriesPart(store, names) {
  const host = element('div', {class: 'view'});
  const view = makeView(host, store, names);
  const flat = view instanceof TopView;
  const magnification = dropDown(kMagnifications.map((m) => [String(m), m === 1 ? 'true size' : m > 1 ? `×${m}` : `1/${Math.round(1 / m)}`]), '1',
                                 (value) => setMagnification(Number(value)));
  const setMagnification = (value) => {
    view.magnification = value;
    magnification.value = String(value);
    view.rebuild();
  };
  const along = element('input', {type: 'checkbox', checked: true, onchange: () => {
    view.along = along.checked;
    view.rebuild();
  }});
  const bar = element('div', {class: 'bar'});
  if (flat) {
    bar.append(element('span', {class: 'note no-webgl', role: 'note'},
                       'This browser shows no WebGL: the trajectories are seen from above only.'));
  } else {
    bar.append(...[['corner', 'Whole'], ['top', 'From above'], ['side', 'From the side']].map(
        ([name, text]) => button(text, () => view.view(name))));
  }
  bar.append(labelled('3σ ellipsoids', magnification));
  if (!flat) bar.append(element('label', {class: 'field'}, along, 'along the way'));
  const truth = swatch({color: '#1b1f24', light: '#e8eaed', dash: [5, 3], name: 'short dashes, black or white'});
  const key = element('p', {class: 'note'}, truth, 'the truth. An estimate is strong up to the scrubber. ',
                      flat ? '' : 'Axes at the estimate: the body, x longest. Drag it; after a click on it the wheel and keys move it too.');
  return {part: element('div', {}, bar, host, key), setMagnification};
}

function plotsPart(store) {
  const host = element('div', {class: 'plot-grid'});
  const plots = new Plots(host, store);
  const components = dropDown([['xyz', 'x, y, z'], ['norm', 'length']], store.components,
                              (value) => store.set('components', value));
  const nees = dropDown([['pose', 'pose'], ['position', 'position'], ['orientation', 'orientation']], store.nees,
                        (value) => store.set('nees', value));
  const bar = element('div', {class: 'bar'}, labelled('errors', components), labelled('NEES of', nees));
  if (store.data.runs.some((run) => run.alignment)) {
    const choices = [['none', 'as it is'], ['posyaw', 'aligned in position and yaw']];
    if (store.alignment === 'own') choices.unshift(['own', 'aligned where not started from the truth']);
    bar.append(labelled('estimate', dropDown(choices, store.alignment, (value) => store.set('alignment', value))));
  }
  bar.append(button('Closer', () => plots.zoom(0.5)), button('Wider', () => plots.zoom(2)),
             button('All', () => plots.setRange(null)));
  const note = element('p', {class: 'note'});
  const say = () => {
    const {confidence} = store.data.nees;
    const curves = store.chosen.map(({run}) => curvesOf(run, store.alignment));
    const sentences = ['Errors are true minus estimate in G.'];
    if (curves.some((c) => c.moved)) {
      sentences.push('Estimates that were not started from the truth, or all where it is chosen, are aligned in ' +
                     'position and yaw; their σ belongs to their own start and is left out.');
    }
    if (curves.some((c) => !c.moved)) {
      sentences.push('Not aligned: bands and thin lines are ±3σ as the estimator said.');
    }
    if (store.alignment !== 'none' && curves.some((c) => !c.moved && c.has_truth)) {
      sentences.push('Where position and yaw are not determined (a truth that stands still) nothing is aligned.');
    }
    sentences.push(`Grey band of the NEES: ${Math.round(100 * confidence)} % of a consistent estimator’s instants.`,
                   'Drag over a plot to look closer, double-click for all; a click sets the scrubber.');
    note.textContent = sentences.join(' ');
  };
  store.on('choice', say);
  say();
  return element('div', {}, bar, host, note);
}

function start() {
  const data = readData(document.getElementById('report-data').textContent);
  const explorer = document.getElementById('explorer');
  const usable = data.runs.filter((run) => run.column);
  if (usable.length === 0) {
    explorer.append(element('p', {class: 'note'}, 'No run of these records has states to show.'));
    document.documentElement.dataset.ready = 'true';
    return;
  }
  const store = new Store(data);
  const coordinates = differingCoordinates(data.runs);
  const names = (run) => runName(run, coordinates);

  const choice = element('div', {class: 'choice'});
  const chooser = data.runs.length > 1 ? new Chooser(choice, store, coordinates, names) : null;
  const spread = element('div', {class: 'spread'});
  if (data.runs.length > 2) new Spread(spread, store, names);
  const trajectories = trajectoriesPart(store, names);
  const time = element('div', {class: 'bar time-bar', role: 'group', 'aria-label': 'Time'});
  new Scrubber(time, store);
  const values = element('div', {class: 'values'});
  const plots = plotsPart(store);
  store.on('time', () => values.replaceChildren(readout(store, names)));
  store.on('theme', () => values.replaceChildren(readout(store, names)));

  explorer.append(
      element('div', {class: 'explore-grid'},
              element('section', {'aria-label': 'Runs'}, ...(chooser ? [choice, spread] : [])),
              element('section', {'aria-label': 'Trajectories'}, trajectories.part)),
      element('div', {class: 'sticky'}, time, values),
      element('section', {'aria-label': 'Errors over time'}, plots));
  const grid = explorer.querySelector('.explore-grid');
  grid.classList.toggle('single', !chooser);
  grid.classList.toggle('few', data.runs.length <= 3);

  store.time = Infinity;
  store.chooseOnly(firstChoice(data));
  trajectories.setMagnification(fittingMagnification(store));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => store.tell('theme'));
  document.documentElement.dataset.ready = 'true';  // for tests
}

start();
