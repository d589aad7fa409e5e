#pragma once
#include <cstddef>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.hpp"

namespace peerd::replication {

// The data of applications: values under keys, at nodes.
class NodeData {
 public:
  static constexpr std::size_t kKeyMax_bytes = 256, kValueMax_bytes = std::size_t{16} << 10;
  static constexpr std::size_t kKeysOfNodeMax = 256;
  // All keys and values together.
  static constexpr std::size_t kMax_bytes = std::size_t{16} << 20;

  // Sets a value; the error says, for people, which limit it exceeds, and nothing is changed then.
  [[nodiscard]] std::expected<void, std::string> set(NodeId node, const std::string& key, std::string value);
  void remove(NodeId node, const std::string& key);
  // Whether all nodes that have data are such.
  [[nodiscard]] bool are_all(const std::function<bool(NodeId)>& is_such) const;
  // Keeps the data of such nodes only.
  void keep(const std::function<bool(NodeId)>& is_kept);

  // Null: there is none.
  [[nodiscard]] const std::string* find(NodeId node, const std::string& key) const;
  // The keys of a node, ascending.
  [[nodiscard]] std::vector<std::string> keys(NodeId node) const;
  [[nodiscard]] bool empty() const { return values_.empty(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

  // A value that is another than before, or is gone.
  struct Change {
    NodeId node;
    std::string key;
    std::optional<std::string> value;  // none: the key is gone

    friend bool operator==(const Change&, const Change&) = default;
  };
  // In the order of nodes and keys.
  [[nodiscard]] std::vector<Change> changes_since(const NodeData& before) const;

 private:
  std::map<NodeId, std::map<std::string, std::string>> values_;  // no node without keys
  std::size_t bytes_ = 0;
};

}  // namespace peerd::replication
