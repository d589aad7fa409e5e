#include "peerd/lab/chaos/watch/operation_book.hpp"

#include <algorithm>
#include <variant>

#include <spdlog/fmt/fmt.h>

namespace peerd::chaos {

std::string name_of(replication::OperationId id) { return fmt::format("{}:{}", id.author.value, id.number); }

using namespace replication;

void OperationBook::follow(const OperationLogs& logs, AuthorId author) {
  std::vector<std::byte>& read = read_[author];
  const auto bytes = logs.bytes({author, 0, logs.whole(author)});
  const auto common = static_cast<std::size_t>(std::ranges::mismatch(read, bytes).in1 - read.begin());
  if (common < std::min(read.size(), bytes.size())) forget(author);
  while (read.size() < bytes.size()) {
    const auto next = decode_operation(author, std::span(bytes).subspan(read.size()));
    assert(next && *next && "the peer has read it");
    operations_.insert_or_assign((*next)->operation.id, (*next)->operation);
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(read.size());
    read.insert(read.end(), from, from + static_cast<std::ptrdiff_t>((*next)->size_bytes));
  }
}

void OperationBook::cut(const OperationLogs& logs, AuthorId author) {
  if (logs.whole(author) < read_[author].size()) forget(author);
  follow(logs, author);
}

void OperationBook::forget(AuthorId author) {
  std::erase_if(operations_, [&](const auto& each) { return each.first.author == author; });
  read_[author].clear();
}

const Operation* OperationBook::find(OperationId id) const {
  const auto at = operations_.find(id);
  return at == operations_.end() ? nullptr : &at->second;
}

// An author's undos come in the order of its log, which is that of their stamps.
std::set<OperationId> OperationBook::undone(SimTime until, const std::function<bool(OperationId)>& refused) const {
  std::set<OperationId> all;
  for (const auto& [id, operation] : operations_) {
    const auto* const undo = std::get_if<UndoOperation>(&operation.body);
    if (undo == nullptr || operation.stamp > until || (refused && refused(id))) continue;
    const OperationId target{id.author, undo->number};
    const Operation* const undone = find(target);
    if (undone == nullptr || undone->stamp != undo->stamp) continue;
    if (undo->redoes) {
      all.erase(target);
    } else {
      all.insert(target);
    }
  }
  return all;
}

}  // namespace peerd::chaos
