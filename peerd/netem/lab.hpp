#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "peerd/config/scenario.hpp"
#include "peerd/measure/run_record.hpp"

namespace peerd::netem {

// A network of this computer's kernel: a namespace for each peer, joined by a bridge, and a netem of its own in each
// direction between two peers.
//
//   namespace 0        this process's namespace                   namespace 1
//   e0 ══ veth ══ p0 ─┐                               ┌─ p1 ══ veth ══ e0
//                     ├─ bridge ─ leaving by p1, from 0: i0-1 (ifb: netem) ─┘
//
// What the bridge sends out of a port goes, by the sender's hardware address, through the device of that direction, so
// each receiver loses and waits by itself, as in the simulator. ARP passes untouched.
//
// Everything lives in namespaces of this process and its children: the kernel takes it down with the last of them,
// however that ends.
class Lab {
 public:
  // Moves this process into namespaces of its own: at most one a process. The error says what the system lacks.
  [[nodiscard]] static Result<std::unique_ptr<Lab>> build(std::size_t peers);

  // What each direction does from now on. Counts begin anew.
  [[nodiscard]] Result<void> set_links(const config::RunSettings& run);
  // Sends datagrams each way, all at once, and fills in what became of them: the delay by one clock.
  [[nodiscard]] Result<report::NetworkMeasured> measure(const config::RunSettings& run) const;
  // Whether the peers' interfaces do multicast from now on; at first they do.
  [[nodiscard]] Result<void> set_multicast(bool on);
  // Fills in what netem has counted since set_links.
  [[nodiscard]] Result<void> count(report::NetworkMeasured& measured) const;

  // In front of a command that is to run as a peer; such a process is terminated if this one dies.
  [[nodiscard]] static std::vector<std::string> inside(std::size_t peer);
  [[nodiscard]] static std::string address(std::size_t peer);
  static constexpr const char* kInterface = "e0";
  static constexpr std::size_t kPeersMax = 100;  // 9,900 directions

 private:
  explicit Lab(std::size_t peers) : peers_(peers) {}
  std::size_t peers_;
};

}  // namespace peerd::netem
