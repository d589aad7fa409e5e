#include "peerd/net/greeting/read_greeting.hpp"

#include <vector>

namespace peerd::net {

std::optional<Greeting> read_greeting(std::span<const std::byte> bytes, bool v4, GreetingSeal* seal, HostTime at,
                                      const boost::asio::ip::udp::endpoint& from, SourceBuckets& strangers,
                                      TrafficCounters& counters) {
  std::optional<std::vector<std::byte>> opened;
  if (seal != nullptr) {
    if (!strangers.admits(from.address(), SourceBuckets::Kind::kAnnouncement, at)) {
      ++counters.greetings_flood;
      return std::nullopt;
    }
    opened = seal->open(bytes, at, from);
    if (!opened) {
      ++counters.greetings_unopened;
      return std::nullopt;
    }
  }
  auto greeting = decode_greeting(opened ? std::span<const std::byte>(*opened) : bytes, v4);
  if (!greeting) ++counters.in_malformed;
  return greeting;
}

bool looks_like_greeting(std::span<const std::byte> bytes) {
  return !bytes.empty() && (bytes.front() == kGreetingMark || bytes.front() == GreetingSeal::kMark);
}

}  // namespace peerd::net
