#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "core/animation/value.hpp"

namespace peerd::animation {

// A Delivered is an event from outside that a port has received.
struct Delivered {
  double t = 0.0;  // [s]
  Value value;
};

// A DeliveryLog holds the events from outside that ports other than the inputs of TimeSensors have received, by port
// and time.
class DeliveryLog {
 public:
  // Makes room for that many ports.
  void grow(std::size_t ports) { has_delivered_.resize(ports, 0); }

  // Adds an event behind those of the same port that are not later. The reference holds until the next call.
  Value& insert(std::uint32_t port, double t, const Value& value);

  [[nodiscard]] bool has(std::uint32_t port) const { return has_delivered_[port] != 0; }
  // Returns the latest event of the port at or before t; null if there is none.
  [[nodiscard]] const Delivered* latest(std::uint32_t port, double t) const;
  // Returns the earliest event of the port after t; null if there is none.
  [[nodiscard]] const Delivered* next(std::uint32_t port, double t) const;
  // Returns all events, by port and then by time.
  [[nodiscard]] const std::map<std::uint32_t, std::vector<Delivered>>& all() const { return delivered_; }

 private:
  std::map<std::uint32_t, std::vector<Delivered>> delivered_;
  std::vector<std::uint8_t> has_delivered_;  // indexed by port; answers most questions without a search
};

}  // namespace peerd::animation
