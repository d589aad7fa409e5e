#include "peerd/net/relay/neighbours.hpp"

#include <cassert>
#include <string_view>

namespace peerd::relay {

using boost::asio::ip::udp;

// Only addresses that have echoed a number are in the table, so that nobody fills it with colliding ones for free.
std::size_t Neighbours::Hash::operator()(const udp::endpoint& at) const {
  const auto mix = [](std::uint64_t x) { return (x ^ x >> 29) * 0x9E37'79B9'7F4A'7C15u; };
  if (at.address().is_v4()) return mix(std::uint64_t{at.address().to_v4().to_uint()} << 16 | at.port());
  const auto bytes = at.address().to_v6().to_bytes();
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return mix(std::hash<std::string_view>{}(text) + at.port());
}

Neighbour* Neighbours::find(const udp::endpoint& at) {
  const auto found = by_address_.find(at);
  return found == by_address_.end() ? nullptr : &of(found->second);
}

Neighbour& Neighbours::add(const udp::endpoint& at) {
  assert(!by_address_.contains(at));
  if (free_.empty()) {
    free_.push_back(first_ + static_cast<LinkId>(slots_.size()));
    slots_.emplace_back();
  }
  const LinkId link = free_.back();
  free_.pop_back();
  slots_[link - first_] = std::make_unique<Neighbour>(Neighbour{.link = link, .at = at});
  by_address_.emplace(at, link);
  return of(link);
}

void Neighbours::remove(const Neighbour& neighbour) {
  const LinkId link = neighbour.link;
  by_address_.erase(neighbour.at);
  free_.push_back(link);
  slots_[link - first_].reset();
}

}  // namespace peerd::relay
