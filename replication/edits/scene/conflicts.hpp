#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/edits/scene/known_operations.hpp"
#include "replication/edits/scene/operation_bodies.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// An operation whose effect is lost by another one, and neither author knew of the other's: the later value of a field,
// of data or of a place has overwritten it, or what it changes, or has added, is removed. It is no loss where somebody
// has gone on from the operation without knowing of what has overwritten it.
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

  friend bool operator==(const RemovedIds&, const RemovedIds&) = default;
};

// The conflicts among the operations that this peer knows: a function of these, whichever came first, but for when each
// was found, and for what kMax and kRemovedIdsMax leave out. So peers that know the same list the same.
class Conflicts {
 public:
  static constexpr Duration kKept = std::chrono::hours(24);  // since found, in session time
  static constexpr std::size_t kMax = 4096;                  // of more the oldest are forgotten
  // The ids of removals that are kept to find out who has removed something; the oldest removals go first.
  static constexpr std::size_t kRemovedIdsMax = 262'144;

  // Whether an operation is in force: it has taken effect, and is not undone.
  using IsInForce = std::function<bool(const OperationKey&)>;
  // The body of an operation that has been in force or refused.
  using BodyOf = std::function<OperationBody(const OperationKey&)>;
  Conflicts(IsInForce is_in_force, BodyOf body_of)
      : is_in_force_(std::move(is_in_force)), body_of_(std::move(body_of)) {}

  // The operation is known; operations of one author in the order of its log.
  void add(const Operation& operation);
  // The operation is in force from now on, or still is. `objects`: the number that it has added. `removed`: what has
  // gone by it.
  void on_in_force(const OperationKey& key, std::uint32_t objects, RemovedIds removed, bool is_new);
  // It changes nothing, as another one that its author did not know makes it impossible.
  void on_refused(const OperationKey& key);
  void on_undone(const OperationKey& key);
  // Finds what is lost by the operations since the last call, and what is lost no more. `now`: session time.
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
  using Keys = std::vector<OperationKey>;
  using Winner = std::optional<OperationKey>;

  [[nodiscard]] static std::optional<Register> register_of(const OperationBody& body);
  [[nodiscard]] bool knew(const OperationKey& a, const OperationKey& b) const {
    return known_.knew(a.second, b.second);
  }
  // Marks what may be lost, or lost no more, since that operation is in force, or is not.
  void spread(const OperationKey& changed);
  void spread_write(const Register& written, const OperationKey& changed);
  void spread_removal(const OperationKey& removal);
  void mark_writes_before(const OperationKey& removal, Register::Kind kind, std::uint64_t id);
  // None: the operation is not lost.
  struct Loss {
    Winner winner;
  };
  [[nodiscard]] std::optional<Loss> loss_of(const OperationKey& key) const;
  [[nodiscard]] std::optional<Loss> loss_by_next(const Keys& writes, Keys::const_iterator next,
                                                 const OperationKey& key) const;
  [[nodiscard]] std::optional<Loss> loss_by_removal(const OperationKey& key, const Keys& removals) const;
  [[nodiscard]] Winner cause_of(const OperationKey& refused, const OperationBody& body) const;
  void index(const OperationKey& key, const OperationBody& body, std::uint32_t objects);
  void set_removal(const OperationKey& removal, RemovedIds ids);
  void erase_removal(const OperationKey& removal);
  // The known removals of what an operation in force has changed or added; those of what a refused one names,
  // ascending.
  [[nodiscard]] Keys removals_of_effect(const OperationKey& key, const OperationBody& body) const;
  [[nodiscard]] Keys removals_of(const OperationBody& body) const;
  void note(const OperationKey& loser, Winner winner);
  void forget(const OperationKey& loser);

  IsInForce is_in_force_;
  BodyOf body_of_;
  KnownOperations known_;
  std::map<Register, Keys> writes_;                                   // ascending
  std::map<ObjectId, std::pair<OperationKey, std::uint32_t>> added_;  // by the first object; how many
  std::map<ObjectId, std::set<OperationKey>> added_below_;            // what has no object, by its parent
  std::map<NodeId, std::set<OperationKey>> routes_of_;
  std::map<OperationKey, RemovedIds> removals_;
  std::size_t removed_ids_ = 0;
  std::map<ObjectId, Keys> removals_of_object_;  // those of removals_, by what they have removed
  std::map<NodeId, Keys> removals_of_node_;
  std::set<OperationKey> refused_;                          // now
  std::map<OperationKey, Conflict> found_;                  // by the loser
  std::map<Register, std::set<OperationKey>> lost_writes_;  // those of found_
  std::set<OperationKey> changed_;                          // since the last find()
  std::set<OperationKey> marked_;                           // to be found lost, or not
  SimTime now_ = SimTime::min();
  std::uint64_t forgotten_ = 0;
};

}  // namespace peerd::replication
