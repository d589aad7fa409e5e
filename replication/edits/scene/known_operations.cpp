#include "replication/edits/scene/known_operations.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {

void KnownOperations::add(const Operation& operation) {
  assert(operation.id.author != kNoAuthor && operation.id.number > 0);
  assert(operation.knows.size() <= kKnowsMax);
  std::uint32_t& last = last_[operation.id.author];
  last = std::max(last, operation.id.number);
  for (const auto& [author, number] : operation.knows) {
    KnownSteps& steps = said_[operation.id.author][author];
    const bool goes_on = steps.last_number() < operation.id.number && steps.last_known() < number;
    if (goes_on) steps.add(operation.id.number, number);  // an author that unlearns is not believed
  }
}

bool KnownOperations::knew(OperationId operation, OperationId other) const {
  if (operation.author == other.author) return other.number < operation.number;
  const auto said = said_.find(operation.author);
  if (said == said_.end()) return false;
  const auto of_other = said->second.find(other.author);
  return of_other != said->second.end() && of_other->second.known_at(operation.number) >= other.number;
}

std::vector<OperationId> KnownOperations::news_for(AuthorId author) const {
  std::vector<OperationId> news;
  const auto said = said_.find(author);
  for (const auto& [other, number] : last_) {
    if (other == author || news.size() == kKnowsMax) continue;
    if (said != said_.end()) {
      const auto of_other = said->second.find(other);
      if (of_other != said->second.end() && of_other->second.last_known() >= number) continue;
    }
    news.push_back({other, number});
  }
  assert(std::ranges::is_sorted(news) && news.size() <= kKnowsMax);
  return news;
}

}  // namespace peerd::replication
