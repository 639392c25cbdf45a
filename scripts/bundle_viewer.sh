#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Rebuilds report/html/assets/scene_viewer.bundle.js, the viewer of the pages' 3D scene, from
# report/html/viewer with npm (vtk.js and esbuild at the versions of package-lock.json). The result
# is committed, so that building Plumbline needs no npm; run this after editing scene_viewer.js.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cp "$root"/report/html/viewer/*.* "$work"
cd "$work"
npm ci --no-fund --no-audit --silent
node_modules/.bin/esbuild scene_viewer.js --bundle --minify --format=iife --target=es2020 \
  --legal-comments=none --metafile=meta.json --outfile=bundle.js --log-level=warning
# One line per package that went in, with its licence and the notice that the licence asks for.
node notices.js > notices.txt
{ cat notices.txt; cat bundle.js; } > "$root/report/html/assets/scene_viewer.bundle.js"
echo "bundled: $(wc -c < "$root/report/html/assets/scene_viewer.bundle.js") bytes"
