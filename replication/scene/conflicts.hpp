#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/scene/known_operations.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// The place of an operation among all.
using OperationKey = std::pair<SimTime, OperationId>;

// An operation whose effect is lost by another one, and neither author knew of the other's: the later value of a field,
// of data or of a place has overwritten it, or what it changes, or has added, is removed.
struct Conflict {
  OperationKey loser;
  std::optional<OperationKey> winner;  // none: not known
  SimTime found{};

  friend bool operator==(const Conflict&, const Conflict&) = default;
};

// The ids that a removal takes with it.
struct RemovedIds {
  std::vector<ObjectId> objects;  // ascending
  std::vector<NodeId> nodes;      // ascending
};

// The conflicts that this peer has found lately. They are not part of what peers agree on: who hears of two operations
// one after the other finds the same ones.
class Conflicts {
 public:
  static constexpr Duration kKept = std::chrono::hours(24);  // since found, in session time
  static constexpr std::size_t kMax = 4096;                  // of more the oldest are forgotten
  // The ids of removals that are kept to find out who has removed something; the oldest removals go first.
  static constexpr std::size_t kRemovedIdsMax = 262'144;

  // Whether an operation is in force: it has taken effect, and is not undone.
  using IsInForce = std::function<bool(const OperationKey&)>;
  explicit Conflicts(IsInForce is_in_force) : is_in_force_(std::move(is_in_force)) {}

  // The operation is known; operations of one author in the order of its log.
  void add(const Operation& operation);
  // The operation is in force from now on, or still is. `objects`: the number that it has added. `removed`: what has
  // gone by it.
  void on_in_force(const OperationKey& key, const OperationBody& body, std::uint32_t objects, RemovedIds removed,
                   bool is_new);
  // It changes nothing, as another one that its author did not know makes it impossible.
  void on_refused(const OperationKey& key, const OperationBody& body);
  void on_undone(const OperationKey& key);
  // Finds what is lost by the operations since the last call. `now`: session time.
  void find(SimTime now);

  // The conflicts by the operation that has lost.
  [[nodiscard]] std::vector<Conflict> list(SimTime now) const;
  // The number of conflicts that were forgotten early, because there were more than kMax.
  [[nodiscard]] std::uint64_t forgotten() const { return forgotten_; }
  // The next operation of that author says so of others' (KnownOperations::news_for()).
  [[nodiscard]] std::vector<OperationId> news_for(AuthorId author) const { return known_.news_for(author); }

 private:
  // A write overwrites a register: a field or data of a node, or the place of an object.
  struct Register {
    enum class Kind : std::uint8_t { kField, kData, kPlace };
    Kind kind{};
    std::uint64_t id = 0;
    std::string name{};
    friend auto operator<=>(const Register&, const Register&) = default;
  };
  using Writes = std::vector<OperationKey>;  // ascending

  struct New {  // in force since the last find()
    OperationKey key;
    const OperationBody* body = nullptr;
  };

  [[nodiscard]] static std::optional<Register> register_of(const OperationBody& body);
  [[nodiscard]] bool knew(const OperationKey& a, const OperationKey& b) const {
    return known_.knew(a.second, b.second);
  }
  void find_overwritten(const Writes& writes, const OperationKey& key);
  void find_lost(const Writes& writes, std::size_t at);
  void find_removed_later(const New& operation, const std::optional<Register>& written);
  void find_removed(const OperationKey& removal, const RemovedIds& ids);
  void find_removed_writes(const OperationKey& removal, Register::Kind kind, std::uint64_t id);
  [[nodiscard]] std::optional<OperationKey> cause_of(const OperationKey& refused, const OperationBody& body) const;
  void set_removal(const OperationKey& removal, RemovedIds ids);
  void erase_removal(const OperationKey& removal);
  // The known removals of what the operation names; ascending.
  [[nodiscard]] std::vector<OperationKey> removals_of(const OperationBody& body) const;
  void note(const OperationKey& loser, std::optional<OperationKey> winner);

  IsInForce is_in_force_;
  KnownOperations known_;
  std::map<Register, Writes> writes_;
  std::map<ObjectId, std::pair<OperationKey, std::uint32_t>> added_;  // by the first object; how many
  std::map<OperationKey, RemovedIds> removals_;
  std::size_t removed_ids_ = 0;
  std::map<ObjectId, std::vector<OperationKey>> removals_of_object_;  // those of removals_, by what they have removed
  std::map<NodeId, std::vector<OperationKey>> removals_of_node_;
  std::map<OperationKey, Conflict> found_;  // by the loser
  std::vector<New> new_;
  std::vector<std::pair<OperationKey, std::optional<OperationKey>>> refused_;
  SimTime now_ = SimTime::min();
  std::uint64_t forgotten_ = 0;
};

}  // namespace peerd::replication
