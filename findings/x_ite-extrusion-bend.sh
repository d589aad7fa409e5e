#!/usr/bin/env bash
# X_ITE puts an Extrusion's cross-section at a bend into the plane that halves the angle; 6.18 into that across the chord.
# Versions: x_ite 15.0.1 (npm) in Chromium.
# Where it matters: behind segments of 4 m and 1 m an edge of a 1 m wide pipe is drawn a quarter of a metre from where it collides.
source "$(dirname "$0")/lib/finding.sh"
CHROMIUM=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || skip "there is no Chromium"
export CHROMIUM
npm_packages x_ite@15.0.1 playwright-core@1.48.2
cp "$(dirname "$0")/lib/x_ite_page.mjs" "$folder/"
cat >"$folder/try.mjs" <<'TEXT'
import { inX_ite } from './x_ite_page.mjs';
const world = `#VRML V2.0 utf8
Shape { geometry DEF G Extrusion { crossSection [ 0.5 0.5 0.5 -0.5 -0.5 -0.5 -0.5 0.5 0.5 0.5 ] spine [ 0 0 0 0 4 0 1 4 0 ] } }`;
const outer = await inX_ite(world, (scene) => {
  const corners = Array.from(scene.getNamedNode('G').getValue().getVertices().getValue());
  let outermost = [Infinity, 0];
  for (let i = 0; i < corners.length; i += 4) if (corners[i + 1] > 3 && corners[i] < outermost[0]) outermost = [corners[i], corners[i + 1]];
  return outermost.map((x) => x.toFixed(3));
});
console.log(`the outer corner of the bend is at ${outer.join(' ')}`);
TEXT
verdict "X_ITE 15.0.1 in $("$CHROMIUM" --version 2>/dev/null | head -n 1)" \
  "the outer corner of the bend is at -0.485 4.121: across spine[2] - spine[0] = 1 4 0 (6.18.3)" \
  "the outer corner of the bend is at -0.354 4.354" "$(cd "$folder" && node try.mjs)"
