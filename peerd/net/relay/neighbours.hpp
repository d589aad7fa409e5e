#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/time.hpp"
#include "peerd/net/greeting/address_numbers.hpp"
#include "peerd/net/greeting/link_meter.hpp"
#include "peerd/net/relay/byte_budget.hpp"
#include "peerd/net/relay/forwarding_table.hpp"

namespace peerd::relay {

// A single peer or another relay, at one address, that has echoed this relay's number for it.
struct Neighbour {
  LinkId link = 0;
  boost::asio::ip::udp::endpoint at;
  std::uint32_t instance = 0;
  std::uint64_t number = 0;  // the last number that it sent, which greetings to it echo
  HostTime last_received{};
  bool is_relay = false;
  bool is_parent = false;  // this relay has chosen it: greetings to it, and what they measure, are RelayChoice's
  net::LinkMeter meter = {};
  std::optional<ByteBudget> budget = {};
  Wanted wanted_elsewhere = {};                    // what is wanted behind all others, as the last greeting to it said
  int repeats = 0;                                 // greetings that are to repeat this soon, in case one gets lost
  std::uint64_t datagrams_in = 0, bytes_in = 0;    // without greetings; bytes with the header
  std::uint64_t datagrams_out = 0, bytes_out = 0;  // likewise
  std::uint64_t over_budget = 0;                   // datagrams that were not sent
};

// The neighbours of a relay by address. A link's number is used again when its neighbour has gone.
class Neighbours {
 public:
  // Links get numbers from `first` on.
  explicit Neighbours(LinkId first) : first_(first) {}

  [[nodiscard]] Neighbour* find(const boost::asio::ip::udp::endpoint& at);
  // The neighbour of that link. It exists.
  [[nodiscard]] Neighbour& of(LinkId link) { return *slots_[link - first_]; }
  // There is none at that address yet.
  Neighbour& add(const boost::asio::ip::udp::endpoint& at);
  void remove(const Neighbour& neighbour);
  [[nodiscard]] std::size_t count() const { return by_address_.size(); }

  // In the order of their links. visit() may remove the neighbour that it is called for.
  template <class Visit>
  void visit(Visit visit) {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (slots_[i]) visit(*slots_[i]);
    }
  }
  template <class Visit>
  void visit(Visit visit) const {
    for (const auto& slot : slots_) {
      if (slot) visit(static_cast<const Neighbour&>(*slot));
    }
  }

 private:
  struct Hash {
    std::size_t operator()(const boost::asio::ip::udp::endpoint& at) const;
  };

  LinkId first_;
  std::vector<std::unique_ptr<Neighbour>> slots_;
  std::vector<LinkId> free_;
  std::unordered_map<boost::asio::ip::udp::endpoint, LinkId, Hash> by_address_;
};

}  // namespace peerd::relay
