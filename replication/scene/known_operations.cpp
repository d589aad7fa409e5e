#include "replication/scene/known_operations.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {

void KnownOperations::add(const Operation& operation) {
  assert(operation.id.author != kNoAuthor && operation.id.number > 0);
  assert(operation.knows.size() <= kKnowsMax);
  std::uint32_t& last = last_[operation.id.author];
  last = std::max(last, operation.id.number);
  for (const auto& [author, number] : operation.knows) {
    std::vector<Step>& steps = said_[operation.id.author][author];
    const bool goes_on = steps.empty() || (steps.back().number < operation.id.number && steps.back().known < number);
    if (goes_on) steps.push_back({operation.id.number, number});  // an author that unlearns is not believed
  }
}

bool KnownOperations::knew(OperationId operation, OperationId other) const {
  if (operation.author == other.author) return other.number < operation.number;
  const auto said = said_.find(operation.author);
  if (said == said_.end()) return false;
  const auto of_other = said->second.find(other.author);
  if (of_other == said->second.end()) return false;
  const auto after = std::ranges::upper_bound(of_other->second, operation.number, {}, &Step::number);
  return after != of_other->second.begin() && std::prev(after)->known >= other.number;
}

std::vector<OperationId> KnownOperations::news_for(AuthorId author) const {
  std::vector<OperationId> news;
  const auto said = said_.find(author);
  for (const auto& [other, number] : last_) {
    if (other == author || news.size() == kKnowsMax) continue;
    if (said != said_.end()) {
      const auto of_other = said->second.find(other);
      if (of_other != said->second.end() && of_other->second.back().known >= number) continue;
    }
    news.push_back({other, number});
  }
  assert(std::ranges::is_sorted(news) && news.size() <= kKnowsMax);
  return news;
}

}  // namespace peerd::replication
