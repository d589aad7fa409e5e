#!/usr/bin/env bash
# Coin draws no caps on an Extrusion whose spine is closed; 6.18.4 has them wherever beginCap and endCap are TRUE.
# Versions: libcoin80c 4.0.0+ds-3 of Debian 12.
# Where it matters: a ring that is cut open at one place shows its inside there; in peerd two caps lie in it, and collide.
source "$(dirname "$0")/lib/finding.sh"
command -v g++ >/dev/null || skip "there is no C++ compiler"
debian_packages libcoin80c=4.0.0+ds-3 libcoin-dev=4.0.0+ds-3
cat >"$folder/try.cpp" <<'TEXT'
#include <cstdio>
#include <string>
#include <Inventor/SbMatrix.h>
#include <Inventor/SoDB.h>
#include <Inventor/SoInput.h>
#include <Inventor/SoInteraction.h>
#include <Inventor/SoPrimitiveVertex.h>
#include <Inventor/VRMLnodes/SoVRML.h>
#include <Inventor/VRMLnodes/SoVRMLGroup.h>
#include <Inventor/actions/SoCallbackAction.h>

int triangles = 0;
void count(void*, SoCallbackAction*, const SoPrimitiveVertex*, const SoPrimitiveVertex*, const SoPrimitiveVertex*) { ++triangles; }

int main() {
  SoDB::init();
  SoInteraction::init();
  std::string world = "#VRML V2.0 utf8\nShape { geometry Extrusion { crossSection [ 0.1 0.1 0.1 -0.1 -0.1 -0.1 0.1 0.1 ] "
                      "spine [ 0 0 0 4 0 0 4 4 0 0 0 0 ] } }";
  SoInput input;
  input.setBuffer(world.data(), world.size());
  SoVRMLGroup* const scene = SoDB::readAllVRML(&input);
  if (scene == nullptr) return 1;
  scene->ref();
  SoCallbackAction action;
  action.addTriangleCallback(SoNode::getClassTypeId(), count, nullptr);
  action.apply(scene);
  std::printf("three segments of three sides have %d triangles\n", triangles);
}
TEXT
libraries=$(dirname "$(find "$folder/root" -name 'libCoin.so.80c')")
g++ -std=c++17 -I"$folder/root/usr/include" -I"$(find "$folder/root/usr/include" -name Inventor -prune -printf '%h\n' | head -n 1)" \
  "$folder/try.cpp" -o "$folder/try" -L"$libraries" -lCoin 2>"$folder/g++.log" || skip "it can't be built: $(grep -m 1 error "$folder/g++.log")"
verdict "Coin 4.0.0 (libcoin80c 4.0.0+ds-3)" "three segments of three sides have 20 triangles, two of them caps (6.18.4)" \
  "three segments of three sides have 18 triangles" "$(LD_LIBRARY_PATH=$libraries "$folder/try")"
