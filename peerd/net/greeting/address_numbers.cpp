#include "peerd/net/greeting/address_numbers.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace peerd::net {
namespace {

using asio::ip::udp;

// The bytes of an endpoint: port, address and, for a link-local IPv6 address, the link.
struct EndpointBytes {
  std::array<std::byte, 30> bytes{};  // of an endpoint, and a number after it
  std::size_t size = 0;

  void put(std::uint64_t value, int size_bytes) {
    for (int i = 0; i < size_bytes; ++i) bytes[size++] = static_cast<std::byte>(value >> (8 * i));
  }
};

EndpointBytes bytes_of(const udp::endpoint& at) {
  EndpointBytes out;
  out.put(at.port(), 2);
  if (at.address().is_v4()) {
    out.put(at.address().to_v4().to_uint(), 4);
  } else {
    const auto address = at.address().to_v6();
    for (const unsigned char byte : address.to_bytes()) out.put(byte, 1);
    out.put(static_cast<std::uint32_t>(address.scope_id()), 4);
  }
  return out;
}

}  // namespace

// The instance is public and is the hash of no bytes. Every endpoint has bytes, so the instance reveals no number.
AddressNumbers::AddressNumbers(const SipKey& key, Duration period)
    : key_(key), length_(period), instance_(static_cast<std::uint32_t>(sip_hash(key, {}))) {}

bool AddressNumbers::is_number_for(const udp::endpoint& at, std::uint64_t number) const {
  return number == number_for(at, period_) || number == number_for(at, period_ - 1);
}

std::uint64_t AddressNumbers::number_for(const udp::endpoint& at, std::int64_t period) const {
  EndpointBytes input = bytes_of(at);
  input.put(static_cast<std::uint64_t>(period), 8);
  return sip_hash(key_, std::span(input.bytes).first(input.size)) >> (64 - kAddressNumberBits) | 1;
}

}  // namespace peerd::net
