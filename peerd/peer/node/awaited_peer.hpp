#pragma once
#include <string>

#include "core/ids.hpp"

namespace peerd {

// A peer without which motions don't begin. The name is the configuration's; captures keep only the id.
struct AwaitedPeer {
  PeerId id;
  std::string name;

  friend bool operator==(const AwaitedPeer& a, const AwaitedPeer& b) { return a.id == b.id; }
};

}  // namespace peerd
