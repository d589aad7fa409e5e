#pragma once
#include "core/vrml/token_stream.hpp"

namespace peerd::vrml {

// The units of a file of X3D (ISO/IEC 19775-1, 4.3.6): factors that lead from its numbers to metres and radians.
struct FileUnits {
  double length = 1.0, angle = 1.0;
};

// Reads a PROFILE, COMPONENT, META or UNIT of the Classic VRML encoding (ISO/IEC 19776-2) if one stands here, and says
// whether one did. Units go to `units`; nothing else of these statements is kept.
bool read_head_statement(TokenStream& tokens, FileUnits& units);

}  // namespace peerd::vrml
