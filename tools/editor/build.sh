#!/bin/sh
# Make grader/service/web/static/codemirror.js and its licences from the packages that package-lock.json names (needs npm).
# Newer ones: `npm update --omit-lockfile-registry-resolved` in a copy of this folder, and take its package-lock.json.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
static="$here/../../grader/service/web/static"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here/package.json" "$here/package-lock.json" "$here/editor.js" "$work"
cd "$work"
npm ci --ignore-scripts --no-audit --no-fund --silent
node_modules/.bin/esbuild editor.js --bundle --minify --format=esm --target=es2022 --legal-comments=none \
    --banner:js='// CodeMirror 6; licences in codemirror.LICENSE.txt, made by tools/editor/build.sh' \
    --metafile=meta.json --outfile="$static/codemirror.js" --log-level=warning
node -e '
const [{ inputs }] = Object.values(JSON.parse(require("fs").readFileSync("meta.json", "utf8")).outputs);
const used = Object.keys(inputs).filter((path) => inputs[path].bytesInOutput > 0);
const found = used.map((path) => path.match(/node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1]);
for (const name of [...new Set(found)].filter(Boolean).sort()) {
  const { version } = require(`${process.cwd()}/node_modules/${name}/package.json`);
  console.log(`${name} ${version}\n\n${require("fs").readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim()}\n\n`);
}' >"$static/codemirror.LICENSE.txt"
ls -l "$static/codemirror.js"
