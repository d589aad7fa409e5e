#include "peerd/net/snapshot/parts.hpp"

#include <algorithm>
#include <cassert>

#include "peerd/net/snapshot/snapshot_message.hpp"

namespace peerd::snapshot {

using replication::AuthorId;
using replication::LogLength;
using replication::OperationRange;

namespace {

void add(std::set<OperationRange>& planned, AuthorId author, std::uint64_t bytes) {
  for (std::uint64_t from = 0; from < bytes; from += kPartMax_bytes) {
    planned.insert({author, from, std::min<std::uint64_t>(bytes, from + kPartMax_bytes)});
  }
}

}  // namespace

void Parts::plan(std::uint64_t archive_bytes, const std::vector<LogLength>& logs) {
  std::set<OperationRange> planned;
  add(planned, replication::kNoAuthor, archive_bytes);
  for (const LogLength& log : logs) add(planned, log.author, log.bytes);
  std::erase_if(held_, [&](const auto& each) { return !planned.contains(each.first); });
  std::erase_if(awaited_, [&](const Awaited& each) { return !planned.contains(each.part); });
  for (const auto& [part, held] : held_) planned.erase(part);
  for (const Awaited& each : awaited_) planned.erase(each.part);
  unasked_.assign(planned.begin(), planned.end());
}

std::optional<OperationRange> Parts::next(const std::map<AuthorId, std::uint64_t>& held,
                                          std::set<OperationRange>& asked) {
  const auto fits = [&](const OperationRange& part) {
    const auto log = held.find(part.author);
    return log != held.end() && part.to <= log->second && !asked.contains(part);
  };
  auto found = std::ranges::find_if(unasked_, fits);
  if (found != unasked_.end()) {
    const OperationRange part = *found;
    unasked_.erase(found);
    awaited_.push_back({part, 1});
    asked.insert(part);
    return part;
  }
  const auto again =
      std::ranges::find_if(awaited_, [&](const Awaited& each) { return each.connections == 1 && fits(each.part); });
  if (again == awaited_.end()) return std::nullopt;
  ++again->connections;
  asked.insert(again->part);
  return again->part;
}

bool Parts::take(const OperationRange& part, std::string_view bytes, std::size_t peer) {
  if (bytes.size() != part.to - part.from) return false;
  const auto awaited = std::ranges::find(awaited_, part, &Awaited::part);
  if (awaited == awaited_.end()) return true;  // another peer was faster
  awaited_.erase(awaited);
  held_.emplace(part, Held{std::string(bytes), peer});
  given_bytes_[peer] += bytes.size();
  givers_[part.author].insert(peer);
  return true;
}

void Parts::give_back(const OperationRange& part) {
  const auto awaited = std::ranges::find(awaited_, part, &Awaited::part);
  if (awaited == awaited_.end() || --awaited->connections > 0) return;
  awaited_.erase(awaited);
  unasked_.push_front(part);
}

void Parts::drop(std::size_t peer) {
  std::erase_if(held_, [&](const auto& each) { return each.second.giver == peer; });
  given_bytes_.erase(peer);
  for (auto& [author, givers] : givers_) givers.erase(peer);
}

std::uint64_t Parts::given_bytes(std::size_t peer) const {
  const auto given = given_bytes_.find(peer);
  return given == given_bytes_.end() ? 0 : given->second;
}

std::string& Parts::content(AuthorId author) {
  const auto [text, is_new] = contents_.try_emplace(author);
  if (!is_new) return text->second;
  assert(are_there());
  const auto first = held_.lower_bound({author, 0, 0});
  const auto last = std::find_if(first, held_.end(), [&](const auto& each) { return each.first.author != author; });
  std::size_t bytes = 0;
  for (auto part = first; part != last; ++part) bytes += part->second.bytes.size();
  text->second.reserve(bytes);
  for (auto part = first; part != last; part = held_.erase(part)) text->second += part->second.bytes;
  return text->second;
}

}  // namespace peerd::snapshot
