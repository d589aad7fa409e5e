#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd::live {

// A network of this computer's kernel: a namespace for each peer, joined by a bridge, and a netem of its own in each
// direction between two peers.
//
//   namespace 0        this process's namespace                   namespace 1
//   e0 ══ veth ══ p0 ─┐                               ┌─ p1 ══ veth ══ e0
//                     ├─ bridge ─ leaving by p1, from 0: i0-1 (ifb: netem) ─┘
//
// A packet that leaves the bridge by a port goes, by the sender's hardware address, through the device of that
// direction. So each receiver has losses and delays of its own, as in the simulator. ARP passes untouched.
//
// Everything lives in namespaces of this process and its children: the kernel takes it down with the last of them,
// however that ends.
class Lab {
 public:
  // Moves this process into namespaces of its own, which it can do once. The error says what the system lacks.
  [[nodiscard]] static Result<std::unique_ptr<Lab>> build(std::size_t peers);

  // Sets the network of each direction, and begins its counts anew.
  [[nodiscard]] Result<void> set_links(const config::RunSettings& run);
  // Sends datagrams in all directions at once and fills in their losses and their delays, which are measured by one
  // clock.
  [[nodiscard]] Result<measure::NetworkMeasured> measure(const config::RunSettings& run) const;
  // Switches multicast of the peers' interfaces on or off; at first it is on.
  [[nodiscard]] Result<void> set_multicast(bool on);
  // Fills in the packets that netem has counted since set_links().
  [[nodiscard]] Result<void> count(measure::NetworkMeasured& measured) const;

  // The words in front of a command that is to run as a peer. Such a process is terminated if this one dies.
  [[nodiscard]] static std::vector<std::string> inside(std::size_t peer);
  [[nodiscard]] static std::string address(std::size_t peer);
  static constexpr const char* kInterface = "e0";
  static constexpr std::size_t kPeersMax = 100;  // 9,900 directions

 private:
  explicit Lab(std::size_t peers) : peers_(peers) {}
  std::size_t peers_;
};

}  // namespace peerd::live
