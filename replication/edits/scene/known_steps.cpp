#include "replication/edits/scene/known_steps.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace peerd::replication {

void KnownSteps::put(std::uint32_t difference) {
  for (; difference >= 128; difference >>= 7) differences_.push_back(static_cast<std::uint8_t>(difference | 128));
  differences_.push_back(static_cast<std::uint8_t>(difference));
}

std::uint32_t KnownSteps::take(std::size_t& at) const {
  std::uint32_t difference = 0;
  for (int shift = 0;; shift += 7) {
    const std::uint32_t group = differences_.at(at++);
    difference |= (group & 127) << shift;
    if (group < 128) return difference;
  }
}

void KnownSteps::add(std::uint32_t number, std::uint32_t known) {
  assert(number > last_.number && known > last_.known);
  if (marks_.empty() || since_mark_ == kSteps) {
    marks_.push_back({{number, known}, differences_.size()});
    since_mark_ = 0;
  } else {
    put(number - last_.number);
    put(known - last_.known);
  }
  ++since_mark_;
  last_ = {number, known};
}

std::uint32_t KnownSteps::known_at(std::uint32_t number) const {
  const auto after = std::ranges::upper_bound(marks_, number, {}, [](const Mark& mark) { return mark.step.number; });
  if (after == marks_.begin()) return 0;
  Step step = std::prev(after)->step;
  std::size_t at = std::prev(after)->next;
  const std::size_t end = after == marks_.end() ? differences_.size() : after->next;
  while (at < end) {
    const std::uint32_t next = step.number + take(at);
    if (next > number) break;
    step = {next, step.known + take(at)};
  }
  return step.known;
}

}  // namespace peerd::replication
