// A report in a real browser: node browser_test.mjs BROWSER PAGE FOLDER ERROR
// PAGE: the report of a study of both estimators and two seeds, whose question is $DUET_QUESTION.
// FOLDER: where pictures go, for looking at. ERROR: of the first run's last position, m. Prints one
// line a check; status 1 where one does not hold.

import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';
import {Browser} from './devtools.mjs';

const [program, page, folder, lastError] = process.argv.slice(2);
const question = process.env.DUET_QUESTION;
let failures = 0;

function check(holds, what, found = '') {
  if (!holds) ++failures;
  console.log(`${holds ? 'holds' : 'FAILS'}: ${what}${holds ? '' : ` (${JSON.stringify(found)})`}`);
}

const rowsShown = `document.querySelectorAll('.readout tbody tr').length`;
const timeShown = `Number(document.querySelector('.readout tbody td').textContent)`;
const caption = `document.querySelector('.readout caption').textContent`;

async function boxOf(browser, selector) {
  return browser.value(`(() => {
    const element = document.querySelector(${JSON.stringify(selector)});
    element.scrollIntoView({block: 'center'});
    const {left, top, width, height} = element.getBoundingClientRect();
    return {left, top, width, height};
  })()`);
}

/** An element as it is seen: a PNG in base64. Equal texts are equal pictures. */
async function picture(browser, selector) {
  const box = await boxOf(browser, selector);
  await browser.settle();
  const scroll = await browser.value('({x: scrollX, y: scrollY})');
  const clip = {x: box.left + scroll.x, y: box.top + scroll.y, width: box.width, height: box.height, scale: 1};
  return (await browser.screenshot({clip})).toString('base64');
}

/** How many colours a picture has, and how many pixels that are not of the commonest one. */
async function contents(browser, png) {
  return browser.value(`(async () => {
    const bytes = Uint8Array.from(atob('${png}'), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes]));
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const {data} = context.getImageData(0, 0, image.width, image.height);
    const counts = new Map();
    for (const colour of new Uint32Array(data.buffer)) counts.set(colour, (counts.get(colour) ?? 0) + 1);
    return {colours: counts.size, drawn: data.length / 4 - Math.max(...counts.values())};
  })()`);
}

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

async function loads(browser) {
  check(await browser.value('document.documentElement.dataset.ready') === 'true', 'the page gets ready');
  const shown = await browser.value('document.querySelector(".question").textContent');
  check(shown === question, 'text is shown as it is', shown);
  const asked = browser.requests.filter((url) => !url.startsWith('data:'));  // figures are in the page
  check(same(asked, [pathToFileURL(page).href]), 'nothing else is asked for', asked);
  check(await browser.value(rowsShown) === 2, 'one run of each estimator is shown first');
  check(await browser.value('document.querySelectorAll(".uplot").length') === 7,
        'three position errors, three orientation errors and the NEES are plotted');
  // From the record through thinning, float32, base64 and the script: three digits are shown.
  const error = await browser.value('Number(document.querySelectorAll(".readout tbody td")[1].textContent)');
  check(Math.abs(error - lastError) < 0.006 * lastError, 'the last position error is the record\'s', [error, lastError]);
}

async function scrubs(browser) {
  const end = await browser.value(timeShown);
  const before = await picture(browser, '.view');
  await browser.value('document.querySelector(".scrubber").focus()');
  await browser.press('Home');
  const start = await browser.value(timeShown);
  check(start < end, 'Home brings the scrubber to the start', [start, end]);
  check(await picture(browser, '.view') !== before, 'the trajectories follow the scrubber');
  await browser.press('ArrowRight');
  check(await browser.value(timeShown) > start, 'an arrow key moves it on');
  await browser.press('End');
  check(await browser.value(timeShown) === end, 'End brings it to the end');
  const line = 'document.querySelector(".scrub-line").style.transform';
  const right = await browser.value(line);
  await browser.press('PageDown');
  check(await browser.value(line) !== right, 'its line in the plots goes with it');
}

async function hovers(browser) {
  const {left, top, width, height} = await boxOf(browser, '.u-over');
  await browser.move(left + width / 4, top + height / 2);
  check(await browser.value(caption) === 'Under the pointer', 'a plot under the pointer tells its instant');
  const quarter = await browser.value(timeShown);
  await browser.move(left + width / 2, top + height / 2);
  check(await browser.value(timeShown) > quarter, 'further right is later');
  await browser.move(2, 2);
  check(await browser.value(caption) === 'At the scrubber', 'away from it the scrubber counts again');
  await browser.click(left + width / 2, top + height / 2);
  await browser.move(2, 2);
  check(await browser.value(timeShown) > quarter, 'a click sets the scrubber');
  await browser.value('document.querySelector(".scrubber").focus()');
  await browser.press('End');
}

async function chooses(browser) {
  const before = await picture(browser, '.plot-grid .plot');
  await browser.value('document.querySelector(".runs input").focus()');
  await browser.press(' ');
  check(await browser.value(rowsShown) === 1, 'the space bar takes a run away');
  check(await picture(browser, '.plot-grid .plot') !== before, 'the plots follow the choice');
  await browser.press(' ');
  check(await browser.value(rowsShown) === 2, 'and brings it back');
  check(await picture(browser, '.plot-grid .plot') === before, 'as it was');
  const press = (text) => browser.value(
      `[...document.querySelectorAll('.choice .bar button')].find((b) => b.textContent === '${text}').click()`);
  await press('none');
  check(await browser.value(rowsShown) === 0, 'no run at all can be shown');
  await browser.value('document.querySelectorAll(".runs input").forEach((box) => box.click())');
  check(await browser.value(rowsShown) === 4, 'and all again');
  await browser.value('document.querySelectorAll(".runs input").forEach((box, i) => i % 2 && box.click())');
  const names = '[...document.querySelectorAll(".readout tbody th")].map((cell) => cell.textContent).join("; ")';
  const seeds = await browser.value(names);
  await press('next seed');
  const next = await browser.value(names);
  check(next !== seeds && next.split('; ').length === 2, 'the next seed of the same runs is shown', [seeds, next]);
  await press('previous seed');
  check(await browser.value(names) === seeds, 'and the previous one again');
  await browser.value(`(() => {
    const select = document.querySelector('.choice select');
    select.value = 'window';
    select.dispatchEvent(new Event('change'));
  })()`);
  check(await browser.value('document.querySelectorAll(".runs tbody tr").length') === 2, 'runs are filtered');
  const dots = await browser.value('document.querySelectorAll(".spread .dot").length');
  check(dots === 4, 'every run is a dot of the spread', dots);
}

async function turns(browser) {
  const {colours, drawn} = await contents(browser, await picture(browser, '.view'));
  check(colours > 20 && drawn > 2000, 'the trajectories are drawn', [colours, drawn]);
  await browser.value('document.querySelector(".view-3d").focus()');
  await browser.press('0');
  const whole = await picture(browser, '.view');
  await browser.press('ArrowRight');
  check(await picture(browser, '.view') !== whole, 'an arrow key turns the view');
  await browser.press('0');
  check(await picture(browser, '.view') === whole, '0 brings it back');
  const points = await boxOf(browser, '.view');
  const wheel = async () => {
    const at = {x: points.left + points.width / 2, y: points.top + points.height / 2};
    await browser.send('Input.dispatchMouseEvent', {type: 'mouseWheel', ...at, deltaX: 0, deltaY: -120});
    await browser.settle();
  };
  await wheel();
  check(await picture(browser, '.view') !== whole, 'the wheel moves a view that has the focus');
  await browser.press('0');
  await browser.value('document.activeElement.blur()');
  const unfocused = await picture(browser, '.view');
  await wheel();
  check(await picture(browser, '.view') === unfocused, 'and lets the page scroll otherwise');
  let found = false;
  for (let x = 0.2; x < 0.8 && !found; x += 0.02) {
    await browser.move(points.left + x * points.width, points.top + 0.5 * points.height);
    found = await browser.value('!document.querySelector(".tip").hidden');
  }
  check(found, 'a trajectory under the pointer tells what is known of it');
  await browser.move(2, 2);
}

/** By the Tab key alone. */
async function isReached(browser) {
  await browser.value('document.activeElement.blur(); window.scrollTo(0, 0)');
  const reached = new Set();
  for (let i = 0; i < 60; ++i) {
    await browser.send('Input.dispatchKeyEvent', {type: 'keyDown', key: 'Tab', windowsVirtualKeyCode: 9});
    await browser.send('Input.dispatchKeyEvent', {type: 'keyUp', key: 'Tab', windowsVirtualKeyCode: 9});
    reached.add(await browser.value(`(() => {
      const e = document.activeElement;
      return e.matches('.runs input') ? 'run' : e.matches('.scrubber') ? 'scrubber' :
          e.matches('.view-3d') ? 'view' : e.matches('.play') ? 'play' : e.localName;
    })()`));
  }
  for (const what of ['run', 'view', 'scrubber', 'play', 'select', 'summary']) {
    check(reached.has(what), `the Tab key reaches: ${what}`, [...reached]);
  }
}

async function isNamed(browser) {
  await browser.send('Accessibility.enable');
  const {nodes} = await browser.send('Accessibility.getFullAXTree');
  const roles = ['button', 'checkbox', 'combobox', 'slider', 'link', 'image', 'img', 'application', 'table', 'region'];
  const nameless = nodes.filter((n) => !n.ignored && roles.includes(n.role?.value) && !n.name?.value);
  check(nameless.length === 0, 'every control, picture and table has a name', nameless.map((n) => n.role.value));
  const controls = nodes.filter((n) => !n.ignored && ['button', 'checkbox', 'combobox', 'slider'].includes(n.role?.value));
  check(controls.length > 15, 'and the browser sees them as such', controls.length);
}

/** WCAG 2's contrast of text with the page. */
async function contrasts(browser, mode) {
  const ratios = await browser.value(`(() => {
    const luminance = (text) => {
      const [r, g, b] = text.match(/[\\d.]+/g).map(Number)
          .map((v) => v / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const page = luminance(getComputedStyle(document.body).backgroundColor);
    return ['h1', '.note', '.kind', 'nav a', '.readout td', '.status', 'footer p, footer summary'].map((selector) => {
      const text = luminance(getComputedStyle(document.querySelector(selector)).color);
      return (Math.max(text, page) + 0.05) / (Math.min(text, page) + 0.05);
    });
  })()`);
  check(Math.min(...ratios) >= 4.5, `text stands out, ${mode}`, ratios);
}

async function withWebGl() {
  const browser = await Browser.start(program);
  try {
    await browser.size(1360, 1000);
    await browser.dark(false);
    await browser.open(page);
    await browser.settle();
    await loads(browser);
    writeFileSync(join(folder, 'report.png'), await browser.screenshot());
    await turns(browser);
    await scrubs(browser);
    await hovers(browser);
    await chooses(browser);
    await isReached(browser);
    await isNamed(browser);
    await contrasts(browser, 'light');
    await browser.dark(true);
    await browser.settle();
    await contrasts(browser, 'dark');
    await browser.value('window.scrollTo(0, 0)');
    writeFileSync(join(folder, 'report_dark.png'), await browser.screenshot());
    await browser.size(420, 900);
    await browser.settle();
    check(await browser.value('document.documentElement.scrollWidth <= 420'), 'it fits a narrow screen',
          await browser.value('document.documentElement.scrollWidth'));
    check(browser.problems.length === 0, 'the console stays empty', browser.problems);
  } finally {
    await browser.stop();
  }
}

async function withoutWebGl() {
  const browser = await Browser.start(program, ['--disable-3d-apis']);
  try {
    await browser.size(1360, 1000);
    await browser.open(page);
    await browser.settle();
    check(await browser.value('Boolean(document.querySelector(".no-webgl"))'), 'without WebGL it says so');
    check(await browser.value('document.querySelectorAll(".uplot").length') === 7, 'the plots are there all the same');
    const {colours} = await contents(browser, await picture(browser, '.view'));
    check(colours > 20, 'and the trajectories from above', colours);
    await scrubs(browser);
    writeFileSync(join(folder, 'report_without_webgl.png'), await browser.screenshot());
    check(browser.problems.length === 0, 'the console stays empty then too', browser.problems);
  } finally {
    await browser.stop();
  }
}

await withWebGl();
await withoutWebGl();
console.log(failures === 0 ? 'all checks hold' : `${failures} checks fail`);
process.exit(failures === 0 ? 0 : 1);
