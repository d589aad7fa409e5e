#include "peerd/net/snapshot/places.hpp"

#include <algorithm>

namespace peerd::snapshot {
namespace {

using boost::asio::ip::address;
using boost::asio::ip::address_v6;

constexpr std::ptrdiff_t kNetwork_bytes = 8;  // of an IPv6 address

address network_of(const address& from) {
  if (!from.is_v6()) return from;
  auto bytes = from.to_v6().to_bytes();
  std::fill(bytes.begin() + kNetwork_bytes, bytes.end(), address_v6::bytes_type::value_type{0});
  return address_v6(bytes);
}

}  // namespace

std::optional<std::uint64_t> Places::add(std::uint64_t number, const Address& from) {
  unproven_.emplace(number, network_of(from));
  if (unproven_.size() <= unproven_most_) return std::nullopt;
  return unproven_.extract(unproven_.begin()).key();
}

std::optional<std::uint64_t> Places::note_proven(std::uint64_t number) {
  auto come = unproven_.extract(number);
  if (come.empty()) return std::nullopt;
  ++proven_from_[come.mapped()];
  proven_.insert(std::move(come));
  if (proven_.size() <= proven_most_) return std::nullopt;
  const std::uint64_t closed = to_close(number);
  remove(closed);
  return closed;
}

std::uint64_t Places::to_close(std::uint64_t proven) const {
  const auto busiest = std::ranges::max_element(proven_from_, {}, [](const auto& each) { return each.second; });
  if (busiest->second < proven_from_.at(proven_.at(proven)) + 2) return proven;
  return std::ranges::find_if(proven_, [&](const auto& each) { return each.second == busiest->first; })->first;
}

void Places::remove(std::uint64_t number) {
  unproven_.erase(number);
  const auto gone = proven_.extract(number);
  if (gone.empty()) return;
  const auto from = proven_from_.find(gone.mapped());
  if (--from->second == 0) proven_from_.erase(from);
}

}  // namespace peerd::snapshot
