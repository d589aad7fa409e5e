#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "peerd/control/answer.hpp"

namespace peerd::gateway {

// The peer that a gateway shows. Everything is called in the thread of its io_context, and does a bounded amount of
// work.
class GatewaySource {
 public:
  GatewaySource() = default;
  GatewaySource(const GatewaySource&) = delete;
  GatewaySource& operator=(const GatewaySource&) = delete;
  virtual ~GatewaySource() = default;

  // Answers one request of the control protocol.
  virtual api::Answer ask(std::string_view request) = 0;
  // The peer's counters, peers, clock and regions in the text format of Prometheus.
  virtual std::string metrics() = 0;
  // The revision of the scene that viewers have to have.
  virtual std::uint32_t revision() = 0;
};

}  // namespace peerd::gateway
