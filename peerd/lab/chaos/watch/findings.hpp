#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace peerd {
class PeerNode;
}

namespace peerd::chaos {

// All that was found in a run: what must not be, and how often each rare branch was taken.
class Findings {
 public:
  static constexpr std::size_t kViolationsMax = 20;  // the first ones

  void violate(double now_s, const std::string& what);
  void count(const std::string& branch, std::uint64_t times = 1) { branches_[branch] += times; }

  [[nodiscard]] const std::vector<std::string>& violations() const { return violations_; }
  [[nodiscard]] const std::map<std::string, std::uint64_t>& branches() const { return branches_; }

 private:
  std::vector<std::string> violations_;
  std::map<std::string, std::uint64_t> branches_;
};

// A peer that runs: which life of all, on which host.
struct WatchedPeer {
  std::size_t life = 0, host = 0;
  const PeerNode* node = nullptr;  // not null
};
[[nodiscard]] std::string name_of(const WatchedPeer& peer);

}  // namespace peerd::chaos
