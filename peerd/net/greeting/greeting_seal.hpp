#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/time.hpp"

namespace peerd::net {

// Seals the greetings of a session: who does not have its key neither reads nor makes one.
class GreetingSeal {
 public:
  static constexpr std::byte kMark{0x67};  // the first byte of a sealed greeting

  GreetingSeal() = default;
  GreetingSeal(const GreetingSeal&) = delete;
  GreetingSeal& operator=(const GreetingSeal&) = delete;
  virtual ~GreetingSeal() = default;

  [[nodiscard]] virtual std::vector<std::byte> seal(std::span<const std::byte> greeting) = 0;
  // The greeting that was sealed. None: whoever sent it at that time from there has another key, or none.
  [[nodiscard]] virtual std::optional<std::vector<std::byte>> open(std::span<const std::byte> sealed, HostTime at,
                                                                   const boost::asio::ip::udp::endpoint& from) = 0;
};

}  // namespace peerd::net
