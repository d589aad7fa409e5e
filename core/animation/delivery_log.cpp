#include "core/animation/delivery_log.hpp"

#include <algorithm>
#include <iterator>

namespace peerd::animation {

Value& DeliveryLog::insert(std::uint32_t port, double t, const Value& value) {
  has_delivered_[port] = 1;
  std::vector<Delivered>& events = delivered_[port];
  return events.insert(std::ranges::upper_bound(events, t, {}, &Delivered::t), {t, value})->value;
}

const Delivered* DeliveryLog::latest(std::uint32_t port, double t) const {
  if (!has_delivered_[port]) return nullptr;
  const std::vector<Delivered>& events = delivered_.at(port);
  const auto after = std::ranges::upper_bound(events, t, {}, &Delivered::t);
  return after == events.begin() ? nullptr : &*std::prev(after);
}

const Delivered* DeliveryLog::next(std::uint32_t port, double t) const {
  if (!has_delivered_[port]) return nullptr;
  const std::vector<Delivered>& events = delivered_.at(port);
  const auto after = std::ranges::upper_bound(events, t, {}, &Delivered::t);
  return after == events.end() ? nullptr : &*after;
}

}  // namespace peerd::animation
