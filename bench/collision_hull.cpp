#include "collision_hull.hpp"

#include <libqhull_r/qhull_ra.h>

#include <cstdio>
#include <vector>

namespace peerd::bench {

std::optional<double> qhull_volume(std::span<const Vec3> points) {
  std::vector<coordT> coordinates;
  for (const Vec3& p : points) coordinates.insert(coordinates.end(), {p[0], p[1], p[2]});
  qhT state{};
  qh_zero(&state, stderr);
  char command[] = "qhull FA";  // with the volume
  std::FILE* const quiet = std::tmpfile();
  const bool failed =
      qh_new_qhull(&state, 3, static_cast<int>(points.size()), coordinates.data(), False, command, quiet, quiet) != 0;
  std::optional<double> out;
  if (!failed) out = state.totvol;
  qh_freeqhull(&state, !qh_ALL);
  int blocks = 0, bytes = 0;
  qh_memfreeshort(&state, &blocks, &bytes);
  if (quiet != nullptr) std::fclose(quiet);
  return out;
}

}  // namespace peerd::bench
