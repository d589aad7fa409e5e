#pragma once
#include <string>

#include "core/vrml/position_map.hpp"

namespace peerd::vrml {

// A ClassicText says in the Classic VRML encoding what a file of X3D says in XML, and which parts of it stand where.
struct ClassicText {
  std::string text;
  PositionMap map;
};

}  // namespace peerd::vrml
