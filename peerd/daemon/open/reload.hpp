#pragma once
#include <string>
#include <vector>

#include "peerd/peer/config/run_settings.hpp"

namespace peerd {

// A Reload is what a changed configuration asks of a peer that runs already.
struct Reload {
  std::vector<std::string> requests;  // lines of the control protocol, which the peer is to be asked
  std::vector<std::string> now;       // keys that count from now on, by dotted name
  std::vector<std::string> later;     // keys that count when the peer is started again
};

// `peer` is the name of the peer that runs. From now on count: the table [log], the peer's viewpoint, and paths that
// its `owns` has gained or lost.
[[nodiscard]] Reload reload_of(const config::RunSettings& before, const config::RunSettings& after,
                               const std::string& peer);

}  // namespace peerd
