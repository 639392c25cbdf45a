// SPDX-License-Identifier: BSD-3-Clause
// Writes a comment with the licence of every package whose code is in the bundle.
const fs = require('fs');
const path = require('path');
const inputs = Object.keys(JSON.parse(fs.readFileSync('meta.json', 'utf8')).inputs);
const folders = new Set();
for (const file of inputs) {
  const found = file.match(/^(node_modules\/(?:@[^/]+\/)?[^/]+)/);
  if (found) folders.add(found[1]);
}
const notices = [...folders].sort().map((folder) => {
  const info = JSON.parse(fs.readFileSync(path.join(folder, 'package.json'), 'utf8'));
  const file = fs.readdirSync(folder).find((name) => /^(licen[cs]e|copying)/i.test(name));
  const text = file ? fs.readFileSync(path.join(folder, file), 'utf8').trim() : '';
  return `${info.name} ${info.version}, ${info.license}\n\n${text}`;
});
const body = notices.join('\n\n----\n\n').replace(/\*\//g, '* /').replace(/[^\x00-\x7f]/g, '?');
console.log(`/*! Viewer of the 3D scene, built from report/html/viewer by scripts/bundle_viewer.sh.\nIt contains these packages:\n\n${body}\n*/`);
