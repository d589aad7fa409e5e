#include "replication/edits/scene/node_data.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {

std::expected<void, std::string> NodeData::set(NodeId node, const std::string& key, std::string value) {
  if (key.empty() || key.size() > kKeyMax_bytes) {
    return std::unexpected("a key has 1 to " + std::to_string(kKeyMax_bytes) + " bytes, and this one " +
                           std::to_string(key.size()));
  }
  if (value.size() > kValueMax_bytes) {
    return std::unexpected("the value has " + std::to_string(value.size()) + " bytes, and may have " +
                           std::to_string(kValueMax_bytes));
  }
  const std::string* const known = find(node, key);
  const std::size_t before = known == nullptr ? 0 : key.size() + known->size();
  const std::size_t after = bytes_ - before + key.size() + value.size();
  if (after > kMax_bytes) {
    return std::unexpected("the data of all nodes would have " + std::to_string(after) + " bytes, and may have " +
                           std::to_string(kMax_bytes));
  }
  const auto at = values_.find(node);
  if (known == nullptr && at != values_.end() && at->second.size() >= kKeysOfNodeMax) {
    return std::unexpected("the node has " + std::to_string(kKeysOfNodeMax) + " keys, which is the most");
  }
  values_[node].insert_or_assign(key, std::move(value));
  bytes_ = after;
  assert(bytes_ <= kMax_bytes && values_.at(node).size() <= kKeysOfNodeMax);
  return {};
}

void NodeData::remove(NodeId node, const std::string& key) {
  const auto at = values_.find(node);
  if (at == values_.end()) return;
  const auto value = at->second.find(key);
  if (value == at->second.end()) return;
  assert(bytes_ >= key.size() + value->second.size());
  bytes_ -= key.size() + value->second.size();
  at->second.erase(value);
  if (at->second.empty()) values_.erase(at);
}

bool NodeData::are_all(const std::function<bool(NodeId)>& is_such) const {
  return std::ranges::all_of(values_, [&](const auto& each) { return is_such(each.first); });
}

void NodeData::keep(const std::function<bool(NodeId)>& is_kept) {
  std::erase_if(values_, [&](const auto& of_node) {
    if (is_kept(of_node.first)) return false;
    for (const auto& [key, value] : of_node.second) bytes_ -= key.size() + value.size();
    return true;
  });
  assert(!values_.empty() || bytes_ == 0);
}

const std::string* NodeData::find(NodeId node, const std::string& key) const {
  const auto at = values_.find(node);
  if (at == values_.end()) return nullptr;
  const auto value = at->second.find(key);
  return value == at->second.end() ? nullptr : &value->second;
}

std::vector<std::string> NodeData::keys(NodeId node) const {
  std::vector<std::string> keys;
  if (const auto at = values_.find(node); at != values_.end()) {
    for (const auto& [key, value] : at->second) keys.push_back(key);
  }
  return keys;
}

std::vector<NodeData::Change> NodeData::changes_since(const NodeData& before) const {
  std::vector<Change> changes;
  for (const auto& [node, values] : before.values_) {
    for (const auto& [key, value] : values) {
      if (find(node, key) == nullptr) changes.push_back({node, key, std::nullopt});
    }
  }
  for (const auto& [node, values] : values_) {
    for (const auto& [key, value] : values) {
      const std::string* const was = before.find(node, key);
      if (was == nullptr || *was != value) changes.push_back({node, key, value});
    }
  }
  std::ranges::sort(changes, {}, [](const Change& c) { return std::pair(c.node, c.key); });
  return changes;
}

}  // namespace peerd::replication
