#!/usr/bin/env bash
# three.js's VRMLLoader draws each face as a fan from its first corner, convex FALSE or not; a concave one leaves its outline.
# Versions: three 0.187.0.
# Where it matters: what is drawn there is larger than what collides in peerd, which cuts such faces along their inside.
source "$(dirname "$0")/lib/finding.sh"
npm_packages three@0.187.0
cat >"$folder/try.mjs" <<'TEXT'
import { VRMLLoader } from 'three/examples/jsm/loaders/VRMLLoader.js';
const world = '#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { convex FALSE coord Coordinate { point [ 4 0 0 1 1 0 0 4 0 0 0 0 ] } coordIndex [ 0 1 2 3 -1 ] } }';
let area_m2 = 0;
new VRMLLoader().parse(world, '').traverse((object) => {
  const place = object.geometry?.attributes.position;
  const at = (i) => [place.getX(i), place.getY(i)];
  for (let i = 0; i < (place?.count ?? 0); i += 3) {
    const [[ax, ay], [bx, by], [cx, cy]] = [at(i), at(i + 1), at(i + 2)];
    area_m2 += Math.abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2;
  }
});
console.log(`the triangles of the face have ${area_m2} square metres`);
TEXT
verdict "three.js VRMLLoader, three 0.187.0" "the triangles of the face have 4 square metres, as the face has (6.23, convex FALSE)" \
  "the triangles of the face have 12 square metres" "$(cd "$folder" && node try.mjs)"
