#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/edit/scene_editor.hpp"
#include "core/scene/scene.hpp"
#include "core/time.hpp"
#include "replication/edits/scene/conflicts.hpp"
#include "replication/edits/scene/locks.hpp"
#include "replication/edits/scene/node_data.hpp"
#include "replication/settings/policy/rare_branches.hpp"
#include "replication/settings/policy/writer.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// The owners by operations: absent are objects that none has given to anybody.
using OwnersByOperation = std::map<ObjectId, PeerId>;

// The objects that owners have left behind: whose each was, and the session time at which it stood where the scene has
// it since.
struct LeftObject {
  PeerId owner;
  SimTime at{};

  friend bool operator==(const LeftObject&, const LeftObject&) = default;
};
using LeftObjects = std::map<ObjectId, LeftObject>;

// A LivingScene is the scene that the world's file and operations make together, the data that applications keep at its
// nodes, and who owns what of it by operations:
// all of them, applied to the file's scene in the order of their stamps and ids, whenever they came. So peers that know
// the same operations have the same scene. An operation that what is before it in this order makes impossible (it sets
// a field of a node that is gone) changes nothing, until another one that comes later allows it. From an UndoOperation
// on, all is as if the operation that it undoes had never been, and others' later ones are applied without it. What a
// writer has locked, the operations of other writers do not change, nor their undos.
class LivingScene {
 public:
  // The scene of the world's file outlives this. `writer_of`: of each author with operations.
  explicit LivingScene(const Scene& file, RareBranches rare = {}, OperationBodies bodies = {},
                       WriterOf writer_of = writer_without_key);
  LivingScene(const LivingScene&) = delete;
  LivingScene& operator=(const LivingScene&) = delete;

  // Adds an operation; it takes effect with a later apply(). False: it is known.
  bool add(Operation operation);

  // A Change says what becomes of the scene at an instant.
  struct Outcome {
    OperationId id;
    std::string refused;  // why it changes nothing; empty: it does what it says
  };
  struct Change {
    SimTime at{};                                      // from then on, which may be in the past
    std::shared_ptr<const Scene> scene;                // null: as before
    std::vector<std::pair<ObjectId, PeerId>> given{};  // objects that have another owner than before
    LeftObjects left{};                                // those that were left anew
    std::vector<NodeData::Change> data{};
    std::vector<SetField> fields{};     // of operations that are new, in order
    std::vector<Operation> messages{};  // of SendMessage, in order; each once
    std::vector<Outcome> outcomes{};    // of the operations that are new, and of those whose outcome is another now
  };
  // Applies the operations that take effect first of those that do until `until`, and with them all others until
  // `known`, up to which the world has been computed already. None: there are none.
  [[nodiscard]] std::optional<Change> apply(SimTime until, SimTime known);

  // Some writers may do more than they might. Where that matters, all from the first lock on is found anew, with the
  // next apply().
  void follow_writers();

  // An operation of the author as it would be in the scene that all known operations until `until` make, which is not
  // before what has been applied: with the names of its text, and how many ids it uses. The error says why it would
  // change nothing.
  struct Draft {
    OperationBody body;
    std::uint32_t objects = 0, nodes = 0;
  };
  [[nodiscard]] std::expected<Draft, std::string> draft(OperationBody body, AuthorId author,
                                                        SimTime until = SimTime::max());

  // The operation that undoes, by the same author, the last edit that it has not undone; or that redoes the one that it
  // has undone last, if it has made no other edit since. Edits that others have overwritten are passed over, as undoing
  // them would change nothing. The error says, for people, why there is none.
  struct Undoing {
    UndoOperation undo;
    OperationBody undone;
  };
  [[nodiscard]] std::expected<Undoing, std::string> next_undo(AuthorId author, bool redoes, SimTime until);

  // The losses of operations by others that did not know them.
  [[nodiscard]] const Conflicts& conflicts() const { return conflicts_; }
  // None: it is not known.
  [[nodiscard]] std::optional<OperationBody> find(const OperationKey& key) const;

  // The ids that the known operations of an author have used are below these, also those of operations that change
  // nothing here, and have done what they say elsewhere.
  struct NextIds {
    std::uint32_t object = 0, node = 0;
  };
  [[nodiscard]] NextIds next_ids(AuthorId author) const;

  // The scene by the last apply(); at first that of the file.
  [[nodiscard]] const std::shared_ptr<const Scene>& scene() const { return now_.scene; }
  // The objects that operations have given to somebody, each with its owner; kNobody: the last owner has released it.
  [[nodiscard]] const OwnersByOperation& owners() const { return now_.owners; }
  [[nodiscard]] const LeftObjects& left() const { return now_.left; }
  [[nodiscard]] const NodeData& data() const { return *now_.data; }
  [[nodiscard]] const Locks& locks() const { return now_.locks; }
  // The object whose lock holds for another one: that one, or the one nearest above it; none: nobody has locked it.
  [[nodiscard]] std::optional<ObjectId> lock_around(ObjectId object) const;
  // Why a lock keeps the author from changing the object; empty: none does.
  [[nodiscard]] std::string why_locked(ObjectId object, AuthorId author) const;
  // The words for an author's writer, for people.
  [[nodiscard]] std::string name_of_writer(AuthorId author) const;
  // The last stamp of all operations until then; min(): there is none.
  [[nodiscard]] SimTime last_stamp(SimTime until) const;

 private:
  // The meaning of a path that names nothing in the text in which it stands.
  using Find = std::function<std::optional<ObjectId>(std::string_view)>;
  struct UsedIds {
    std::uint32_t objects = 0, nodes = 0;
  };
  using Key = OperationKey;
  // The edits that are not in force, and the undos that change nothing because of a lock, each with the reason.
  struct Undone {
    std::set<Key> edits;
    std::map<Key, std::string> locked;
    // Returns whether the undo changes anything.
    bool follow(const Key& target, bool redoes) {
      return redoes ? edits.erase(target) > 0 : edits.insert(target).second;
    }
  };
  // There is one for each operation: what few of them have is in maps of its own.
  struct Entry {
    std::uint8_t kind = 0;  // OperationBody::index()
    bool applied = false, undone = false;
    bool refused = false;   // reasons_ says why
    bool has_done = false;  // what it says, once at least: by the ids in used_, or by none
    bool unlocks = false;   // a LockObject
    template <class Kind>
    [[nodiscard]] bool is() const {
      return kind == kIndexOf<Kind>;
    }
  };
  using Entries = std::map<Key, Entry>;
  // The outcome of operations.
  struct State {
    std::shared_ptr<const Scene> scene;
    OwnersByOperation owners;
    std::shared_ptr<const NodeData> data;
    LeftObjects left{};
    Locks locks{};
  };
  // The outcome of all operations up to a key.
  struct Checkpoint {
    Key last;
    State state;
    std::size_t count = 0;  // of operations
  };

  [[nodiscard]] ReadOptions reading() const;
  // The ids of the nodes of a text, wherever it stands.
  [[nodiscard]] UsedIds ids_in(const AddNodes& add) const;
  // A State that is being made.
  struct Editing {
    State state;
    std::shared_ptr<NodeData> new_data{};  // null: as before
    std::optional<SceneEditor> scene{};    // none: nothing edits it yet, for that costs a pass over it
    SceneEditor& editor() { return scene ? *scene : scene.emplace(*state.scene); }
    [[nodiscard]] bool contains(ObjectId id) const { return scene ? scene->contains(id) : state.scene->contains(id); }
    NodeData& data() {
      if (!new_data) state.data = new_data = std::make_shared<NodeData>(*state.data);
      return *new_data;
    }
    [[nodiscard]] bool contains(NodeId node);
    // The scene as it is by now, to be looked at: that costs a pass over it, too, where nothing edits it yet.
    const SceneEditor& structure() { return scene ? *scene : unedited ? *unedited : unedited.emplace(*state.scene); }
    std::optional<SceneEditor> unedited{};
    std::map<ObjectId, std::vector<NodeId>> locked_nodes{};  // the nodes below locked objects, as far as somebody asked
  };
  // Applies one operation; the error says why it cannot be.
  [[nodiscard]] static std::expected<void, std::string> set_data(Editing& editing, const SetData& set);
  [[nodiscard]] std::expected<UsedIds, std::string> apply_to(Editing& editing, const OperationBody& body,
                                                             AuthorId author, const Find& find) const;
  [[nodiscard]] static std::expected<void, std::string> give_to(Editing& editing, const GiveObject& give);
  [[nodiscard]] static std::expected<void, std::string> place_in(Editing& editing, const PlaceObject& place);
  [[nodiscard]] std::expected<void, std::string> lock_in(Editing& editing, const LockObject& lock,
                                                         AuthorId author) const;
  // The error says what the edits together make impossible.
  [[nodiscard]] static std::expected<State, std::string> finish(Editing editing);
  // An Effect says what an operation does.
  struct Effect {
    std::string refused;  // why it changes nothing; empty: it does what it says
    UsedIds used;
    RemovedIds removed{};
    bool undone = false;
  };
  // An Applied has what operations, in order, make of a state, and what each of them does.
  struct Applied {
    State state;
    std::vector<Effect> effects;
  };
  [[nodiscard]] Applied applied(const State& base, std::span<const Entries::const_iterator> entries,
                                const Undone& undone) const;
  // Applies the first of them by one editor: as many as cannot make what it cannot finish, and the next one. So the
  // outcome is that of one operation after the other, and a thousand that move things cost one new scene.
  void apply_run(std::span<const Entries::const_iterator> entries, const Undone& undone, Applied& all) const;
  [[nodiscard]] Effect apply_one(Editing& editing, Entries::const_iterator at, const Undone& undone) const;
  // The edit that an operation at that key undoes or redoes; none: there is no such edit.
  [[nodiscard]] std::optional<Key> target_of(const Key& key, const UndoOperation& undo) const;
  // Adds to what is undone, or takes from it, by the operations that are due until then. Returns the first operation
  // from which on all is to be applied anew.
  [[nodiscard]] std::optional<Key> follow_undos(SimTime until, Undone& undone) const;
  // The first operation that an apply() until then has anew.
  [[nodiscard]] std::optional<Key> first_to_apply(SimTime until) const;
  // Locks (living_scene_locks.cpp).
  // Why a lock keeps the author from an operation; empty: none does. `added`: ids of what the operation has added,
  // where it is one of before that is undone or redone.
  [[nodiscard]] std::string why_locked(Editing& editing, const OperationBody& body, AuthorId author,
                                       const UsedIds& added) const;
  [[nodiscard]] static bool is_inside(Editing& editing, ObjectId locked, NodeId node);
  [[nodiscard]] static bool touches(Editing& editing, ObjectId locked, const OperationBody& body, AuthorId author,
                                    const UsedIds& added);
  // Undos as follow_undos() follows them, with locks that may keep some from what they do.
  void follow_checked_undos(SimTime until, const Key& first, Undone& undone) const;
  [[nodiscard]] std::string why_undo_locked(const Key& target, const State& before, const State& after) const;
  [[nodiscard]] bool may_be_locked(const Key& at, const Undone& undone) const;
  [[nodiscard]] State all_before(const Key& end, SimTime until, const Key& first, const Undone& undone) const;
  [[nodiscard]] const Writer& writer(AuthorId author) const;
  [[nodiscard]] bool is_one_writer(AuthorId a, AuthorId b) const { return writer(a).user == writer(b).user; }
  void note_effect(Entries::iterator at, Effect effect, Change& change);
  // Why the operation changes nothing; empty: it does what it says.
  [[nodiscard]] const std::string& reason_of(Entries::const_iterator at) const;
  void set_reason(Entries::iterator at, std::string why);
  // The outcome of all operations until then. `first`: the first of those that the checkpoints do not have so.
  [[nodiscard]] State all_until(SimTime until, const Key& first, const Undone& undone) const;
  [[nodiscard]] const State& with_all(SimTime until);
  [[nodiscard]] std::vector<Key> undo_candidates(AuthorId author, bool redoes, const Undone& all) const;
  [[nodiscard]] std::string why_not_undo(const Key& target, bool redoes, const State& before,
                                         const std::optional<std::string>& text_before, const State& after) const;
  // The last checkpoint before a key; the file's scene where there is none.
  [[nodiscard]] Checkpoint checkpoint_before(const Key& key) const;
  void thin_checkpoints();

  const std::shared_ptr<const Scene> file_;  // owned by nobody here
  const State begin_;                        // before all operations
  OperationBodies bodies_;
  Entries entries_;
  std::map<Key, std::string> reasons_;
  std::map<Key, UsedIds> used_;
  std::set<Key> due_;                    // not applied yet
  std::set<Key> undos_;                  // of all
  std::map<Key, LockObject> lockings_;   // of all, and what unlocks
  std::optional<Key> anew_{};            // all from there on is to be applied once more
  Undone undone_;                        // of those that are applied
  std::vector<Checkpoint> checkpoints_;  // in order
  State now_;                            // by the last apply()
  std::optional<State> with_all_{};      // by all operations until with_all_until_; none: not known
  SimTime with_all_until_ = SimTime::min();
  Conflicts conflicts_;
  RareBranches rare_;
  WriterOf writer_of_;
  mutable std::map<AuthorId, Writer> writers_;  // as writer_of_ has answered
};

}  // namespace peerd::replication
