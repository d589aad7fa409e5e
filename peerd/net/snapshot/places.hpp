#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include <boost/asio/ip/address.hpp>

namespace peerd::snapshot {

// Decides which connections a server keeps where more come than it has places for. A connection is proven once it has
// shown that it has the session's key; before that it takes no place from one that has. It has no sockets.
class Places {
 public:
  explicit Places(std::size_t most) : most_(most) {}

  // One more connection has come, of a number that grows, from that address. Returns the connection that has to be
  // closed for it, which is forgotten here: the oldest one that is not proven; where all are, the oldest one of the
  // address that has the most, if that has at least two more than the new one's; else the new one. None: there is room.
  [[nodiscard]] std::optional<std::uint64_t> add(std::uint64_t number, const boost::asio::ip::address& from);
  void note_proven(std::uint64_t number);
  void remove(std::uint64_t number) { all_.erase(number); }
  [[nodiscard]] bool is_proven(std::uint64_t number) const;
  [[nodiscard]] std::size_t size() const { return all_.size(); }

 private:
  struct Connection {
    boost::asio::ip::address from;
    bool is_proven = false;
  };
  [[nodiscard]] std::uint64_t to_close(std::uint64_t added) const;

  std::size_t most_;
  std::map<std::uint64_t, Connection> all_;  // in the order in which they came
};

}  // namespace peerd::snapshot
