// Bundles src/ into the folder named on the command line: report.js, report.css, LICENSES.txt and
// SHA256SUMS. The same sources and package-lock.json give the same bytes.

import {createHash} from 'node:crypto';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import * as esbuild from 'esbuild';

const out = process.argv[2];
if (!out) throw new Error('usage: node build.mjs FOLDER');
mkdirSync(out, {recursive: true});

const options = {
  bundle: true,
  minify: true,
  charset: 'utf8',
  // What a browser of 2023 knows; older ones keep tables and figures, which need no script.
  target: ['chrome110', 'firefox115', 'safari16.4'],
  legalComments: 'none',  // LICENSES.txt has them whole
  logLevel: 'warning',
};
await esbuild.build({
  ...options,
  entryPoints: ['src/main.js'],
  format: 'iife',
  outfile: join(out, 'report.js'),
});
await esbuild.build({...options, entryPoints: ['src/report.css'], outfile: join(out, 'report.css')});

// A closing tag inside a script would end it; esbuild writes it as <\/script>.
const script = readFileSync(join(out, 'report.js'), 'utf8');
if (/<\/script|<!--/i.test(script)) throw new Error('report.js cannot stand inside a page');

let licences = '';
for (const name of ['three', 'uplot']) {
  const folder = join('node_modules', name);
  const {version, homepage} = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  const text = readFileSync(join(folder, 'LICENSE'), 'utf8').replace(/\r\n/g, '\n').trim();
  licences += `${name} ${version}  ${homepage}\n\n${text}\n\n\n`;
}
writeFileSync(join(out, 'LICENSES.txt'), licences.trimEnd() + '\n');

const sums = ['LICENSES.txt', 'report.css', 'report.js'].map((name) => {
  const hash = createHash('sha256').update(readFileSync(join(out, name))).digest('hex');
  return `${hash}  ${name}\n`;
});
writeFileSync(join(out, 'SHA256SUMS'), sums.join(''));
