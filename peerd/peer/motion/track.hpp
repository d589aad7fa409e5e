#pragma once
#include <filesystem>
#include <vector>

#include "peerd/input/input_error.hpp"
#include "peerd/peer/motion/motion_path.hpp"

namespace peerd::motion {

// A recorded motion: a CSV file with the header t,x,y,z or t,x,y,z,qw,qx,qy,qz, in seconds and metres, in order of
// time.
struct Track {
  std::filesystem::path file;
  bool loop = false, corners = false;  // as in Waypoints
};

struct LoadedTrack {
  std::vector<Knot> knots;
  bool turns = false;  // the file has orientations
};
[[nodiscard]] Result<LoadedTrack> load_track(const Track& track);

}  // namespace peerd::motion
