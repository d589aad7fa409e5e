#!/usr/bin/env bash
# three.js's VRMLLoader takes the heights of an ElevationGrid column by column; ISO/IEC 14772-1, 6.17 has rows along x.
# Versions: three 0.187.0.
# Where it matters: terrain that is longer one way than the other is another landscape there than in peerd, X_ITE and Coin.
source "$(dirname "$0")/lib/finding.sh"
npm_packages three@0.187.0
cat >"$folder/try.mjs" <<'TEXT'
import { VRMLLoader } from 'three/examples/jsm/loaders/VRMLLoader.js';
const world = '#VRML V2.0 utf8\nShape { geometry ElevationGrid { xDimension 2 zDimension 3 xSpacing 1 zSpacing 10 height [ 0 1 2 3 4 5 ] } }';
let height;
new VRMLLoader().parse(world, '').traverse((object) => {
  const place = object.geometry?.attributes.position;
  for (let i = 0; i < (place?.count ?? 0); ++i) if (place.getX(i) === 1 && place.getZ(i) === 0) height = place.getY(i);
});
console.log(`the height at x 1, z 0 is ${height}`);
TEXT
verdict "three.js VRMLLoader, three 0.187.0" "the height at x 1, z 0 is 1: height[1 + 0 * xDimension] (6.17)" \
  "the height at x 1, z 0 is 2" "$(cd "$folder" && node try.mjs)"
