#pragma once
#include <cstddef>
#include <map>

#include "core/time.hpp"
#include "peerd/net/seal/announcement.hpp"

namespace peerd::seal {

// When announcements of boots that prove nothing came first. One that came long ago is a record that somebody says
// again and again, or of a peer that hears nobody: it makes way for newer ones.
class FirstHeard {
 public:
  static constexpr Duration kNew = std::chrono::seconds(10);
  static constexpr std::size_t kMost = 1 << 16;  // beyond that all are new once more

  void note(const BootId& boot, HostTime now);
  [[nodiscard]] bool is_old(const BootId& boot, HostTime now) const;

 private:
  std::map<BootId, HostTime> first_;
};

}  // namespace peerd::seal
