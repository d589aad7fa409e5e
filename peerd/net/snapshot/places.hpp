#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include <boost/asio/ip/address.hpp>

namespace peerd::snapshot {

// Decides which connections a server keeps where more come than it has places for. A connection is proven once it has
// shown that it has the session's key. Proven connections have places of their own, and no unproven one ever takes one
// of these. The addresses of one IPv6 network (/64) count as one address, as they may all be
// one computer's. It has no sockets.
class Places {
 public:
  Places(std::size_t proven_most, std::size_t unproven_most)
      : proven_most_(proven_most), unproven_most_(unproven_most) {}

  // A connection has come from that address and has proven nothing yet. Its number is higher than all before. Returns
  // the connection that has to be closed for it: the oldest unproven one. None: there is room.
  [[nodiscard]] std::optional<std::uint64_t> add(std::uint64_t number, const boost::asio::ip::address& from);
  // A connection has proven itself. Returns the one that has to be closed for it: the oldest proven one of the address
  // that has the most of these, if that has at least two more than the new one's address, the new one included. Else it
  // is the new one. None: there is room, or it was proven before.
  [[nodiscard]] std::optional<std::uint64_t> note_proven(std::uint64_t number);
  // A connection is over. Those that are to be closed are removed already.
  void remove(std::uint64_t number);
  [[nodiscard]] bool is_proven(std::uint64_t number) const { return proven_.contains(number); }
  [[nodiscard]] std::size_t size() const { return proven_.size() + unproven_.size(); }

 private:
  using Address = boost::asio::ip::address;

  [[nodiscard]] std::uint64_t to_close(std::uint64_t proven) const;

  std::size_t proven_most_, unproven_most_;
  std::map<std::uint64_t, Address> proven_, unproven_;  // in the order in which they came; of IPv6 the network
  std::map<Address, std::size_t> proven_from_;          // how many of each address
};

}  // namespace peerd::snapshot
