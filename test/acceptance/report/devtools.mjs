// A headless Chromium driven over its DevTools protocol by a pipe: commands and events are JSON
// objects, ended by a zero byte (https://chromedevtools.github.io/devtools-protocol/). Needs node
// and the browser, no package.

import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';

const kTimeoutMs = 60000;

const kKeys = {
  Tab: 9, Enter: 13, ' ': 32, PageUp: 33, PageDown: 34, End: 35, Home: 36,
  ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40,
};

export class Browser {
  /** `flags`: further ones of the command line. */
  static async start(program, flags = []) {
    const browser = new Browser();
    browser.profile = mkdtempSync(join(tmpdir(), 'duet-report-browser-'));
    // Software rendering: a machine that tests has no graphics card.
    browser.process = spawn(program, [
      '--headless=new', '--no-sandbox', '--disable-gpu-sandbox', '--disable-dev-shm-usage',
      '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-first-run', '--hide-scrollbars',
      '--disable-background-networking', '--disable-component-update', '--disable-sync',
      '--force-color-profile=srgb', '--remote-debugging-pipe', `--user-data-dir=${browser.profile}`,
      ...flags, 'about:blank',
    ], {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
    browser.messages = browser.process.stdio[3];
    browser.waiting = new Map();
    browser.next = 1;
    browser.problems = [];
    browser.requests = [];
    browser.events = new Map();
    let rest = '';
    browser.process.stdio[4].setEncoding('utf8');
    browser.process.stdio[4].on('data', (text) => {
      const parts = (rest + text).split('\0');
      rest = parts.pop();
      for (const part of parts) browser.receive(JSON.parse(part));
    });
    browser.process.on('error', (error) => browser.fail(error));
    browser.process.on('exit', () => browser.fail(new Error('the browser ended')));
    const {targetInfos} = await browser.send('Target.getTargets');
    const page = targetInfos.find((target) => target.type === 'page');
    const {sessionId} = await browser.send('Target.attachToTarget', {targetId: page.targetId, flatten: true});
    browser.session = sessionId;
    for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await browser.send(`${domain}.enable`);
    return browser;
  }

  fail(error) {
    for (const {reject} of this.waiting.values()) reject(error);
    this.waiting.clear();
  }

  send(method, params = {}) {
    const id = this.next++;
    const message = {id, method, params, ...(this.session ? {sessionId: this.session} : {})};
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`${method}: no answer`)), kTimeoutMs);
      this.waiting.set(id, {
        resolve: (value) => {
          clearTimeout(timer);
          resolve(value);
        },
        reject: (error) => {
          clearTimeout(timer);
          reject(error);
        },
      });
      this.messages.write(JSON.stringify(message) + '\0');
    });
  }

  receive(message) {
    if (message.id) {
      const waiting = this.waiting.get(message.id);
      this.waiting.delete(message.id);
      if (!waiting) return;
      if (message.error) {
        waiting.reject(new Error(message.error.message));
      } else {
        waiting.resolve(message.result);
      }
      return;
    }
    const {method, params} = message;
    if (method === 'Runtime.exceptionThrown') {
      const {text, exception} = params.exceptionDetails;
      this.problems.push(exception?.description ?? text);
    } else if (method === 'Runtime.consoleAPICalled' && ['error', 'warning', 'assert'].includes(params.type)) {
      this.problems.push(`console.${params.type}: ${params.args.map((a) => a.value ?? a.description).join(' ')}`);
    } else if (method === 'Log.entryAdded' && ['error', 'warning'].includes(params.entry.level)) {
      this.problems.push(`${params.entry.source}: ${params.entry.text}`);
    } else if (method === 'Network.requestWillBeSent') {
      this.requests.push(params.request.url);
    }
    this.events.get(method)?.(params);
    this.events.delete(method);
  }

  async size(width, height) {
    await this.send('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor: 1, mobile: false});
  }

  async dark(on) {
    await this.send('Emulation.setEmulatedMedia', {
      features: [{name: 'prefers-color-scheme', value: on ? 'dark' : 'light'}],
    });
  }

  async open(file) {
    const loaded = new Promise((resolve) => this.events.set('Page.loadEventFired', resolve));
    await this.send('Page.navigate', {url: pathToFileURL(file).href});
    await loaded;
  }

  /** The value of an expression in the page; promises are awaited. */
  async value(expression) {
    const answer = await this.send('Runtime.evaluate', {expression, returnByValue: true, awaitPromise: true});
    if (answer.exceptionDetails) {
      throw new Error(`${expression}: ${answer.exceptionDetails.exception?.description ?? answer.exceptionDetails.text}`);
    }
    return answer.result.value;
  }

  /** Until the page has drawn what it was told. */
  async settle() {
    await this.value('new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done))))');
  }

  async press(key, modifiers = 0) {
    const code = kKeys[key] ?? key.toUpperCase().charCodeAt(0);
    const common = {key, windowsVirtualKeyCode: code, modifiers};
    const text = key === 'Enter' ? '\r' : key.length === 1 ? key : undefined;
    await this.send('Input.dispatchKeyEvent', {type: 'keyDown', text, ...common});
    await this.send('Input.dispatchKeyEvent', {type: 'keyUp', ...common});
    await this.settle();
  }

  async move(x, y) {
    await this.send('Input.dispatchMouseEvent', {type: 'mouseMoved', x, y});
    await this.settle();
  }

  async click(x, y) {
    await this.move(x, y);
    for (const type of ['mousePressed', 'mouseReleased']) {
      await this.send('Input.dispatchMouseEvent', {type, x, y, button: 'left', clickCount: 1});
    }
    await this.settle();
  }

  /** PNG bytes of what is seen. */
  async screenshot(options = {}) {
    const {data} = await this.send('Page.captureScreenshot', {format: 'png', ...options});
    return Buffer.from(data, 'base64');
  }

  async stop() {
    this.process.removeAllListeners('exit');
    const ended = new Promise((resolve) => this.process.on('exit', resolve));
    this.session = null;
    await this.send('Browser.close').catch(() => this.process.kill());
    await ended;
    rmSync(this.profile, {recursive: true, force: true, maxRetries: 5});
  }
}
