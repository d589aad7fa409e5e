#include "peerd/chaos/watch/operation_book.hpp"

#include <algorithm>
#include <variant>

#include <spdlog/fmt/fmt.h>

namespace peerd::chaos {

std::string name_of(replication::OperationId id) { return fmt::format("{}:{}", id.author.value, id.number); }

using namespace replication;

void OperationBook::follow(const OperationLogs& logs, AuthorId author) {
  const std::uint64_t whole = logs.whole(author);
  std::uint64_t& read = read_bytes_[author];
  if (read >= whole) return;
  const std::uint64_t from = read;
  const auto bytes = logs.bytes({author, from, whole});
  while (read < whole) {
    const auto next = decode_operation(author, std::span(bytes).subspan(read - from));
    if (!next || !*next) return;  // the peer has read it, so that this is another log than that of before
    operations_.insert_or_assign((*next)->operation.id, (*next)->operation);
    read += (*next)->size_bytes;
  }
}

void OperationBook::cut(const OperationLogs& logs, AuthorId author) {
  const std::uint32_t last = logs.last(author).number;
  std::erase_if(operations_, [&](const auto& each) { return each.first.author == author && each.first.number > last; });
  std::uint64_t& read = read_bytes_[author];
  read = std::min(read, logs.whole(author));
}

const Operation* OperationBook::find(OperationId id) const {
  const auto at = operations_.find(id);
  return at == operations_.end() ? nullptr : &at->second;
}

// An author's undos come in the order of its log, which is that of their stamps.
std::set<OperationId> OperationBook::undone(SimTime until) const {
  std::set<OperationId> all;
  for (const auto& [id, operation] : operations_) {
    const auto* const undo = std::get_if<UndoOperation>(&operation.body);
    if (undo == nullptr || operation.stamp > until) continue;
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
