#!/usr/bin/env bash
# X_ITE never starts a TimeSensor whose startTime lies ahead when the file is read; 6.50 starts it when that time comes.
# Versions: x_ite 15.0.1 (npm) in Chromium.
# Where it matters: a world that waits for a date moves in peerd (times of the future stay what they are) and stands there.
source "$(dirname "$0")/lib/finding.sh"
CHROMIUM=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || skip "there is no Chromium"
export CHROMIUM
npm_packages x_ite@15.0.1 playwright-core@1.48.2
cp "$(dirname "$0")/lib/x_ite_page.mjs" "$folder/"
cat >"$folder/try.mjs" <<'TEXT'
import { inX_ite } from './x_ite_page.mjs';
const inEightSeconds = (Date.now() / 1000 + 8).toFixed(1); // the browser has started by then
const world = `#VRML V2.0 utf8
DEF NOW TimeSensor { cycleInterval 100 loop TRUE }
DEF AHEAD TimeSensor { cycleInterval 100 loop TRUE startTime ${inEightSeconds} }`;
const seen = await inX_ite(world, async (scene) => {
  await new Promise((over) => setTimeout(over, 14000));
  return ['NOW', 'AHEAD'].map((name) => `${name} ${scene.getNamedNode(name).isActive ? 'runs' : 'stands'}`).join(', ');
});
console.log(seen);
TEXT
verdict "X_ITE 15.0.1 in $("$CHROMIUM" --version 2>/dev/null | head -n 1)" "NOW runs, AHEAD runs: six seconds after its startTime (6.50, 4.6.9)" \
  "NOW runs, AHEAD stands" "$(cd "$folder" && node try.mjs)"
