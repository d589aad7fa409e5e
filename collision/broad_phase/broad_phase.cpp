#include "collision/broad_phase/broad_phase.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "collision/broad_phase/dynamic_tree.hpp"
#include "collision/broad_phase/fat_box.hpp"
#include "collision/broad_phase/near_pairs.hpp"
#include "collision/broad_phase/sweep_and_prune.hpp"

namespace peerd::collision {
namespace {

// The twin: as plain as can be.
class BruteForce final : public BroadPhase {
 public:
  void add(BroadIndex object, const WorldBox& box) override {
    if (boxes_.size() <= object) boxes_.resize(object + 1);
    assert(!boxes_[object]);
    boxes_[object] = box;
  }
  void remove(BroadIndex object) override {
    assert(object < boxes_.size() && boxes_[object]);
    boxes_[object].reset();
    std::erase_if(pairs_, [&](BroadPair p) { return p.low == object || p.high == object; });
    for (auto& group : groups_) group.erase(object);
  }
  void move(BroadIndex object, const WorldBox& box) override {
    assert(object < boxes_.size() && boxes_[object]);
    boxes_[object] = box;
    ++counters_.moves;
  }
  bool register_interest(BroadIndex a, BroadIndex b) override { return pairs_.insert(make_broad_pair(a, b)).second; }
  bool unregister_interest(BroadIndex a, BroadIndex b) override { return pairs_.erase(make_broad_pair(a, b)) > 0; }
  bool join(BroadGroup group, BroadIndex object) override {
    if (groups_.size() <= group) groups_.resize(group + 1);
    return groups_[group].insert(object).second;
  }
  bool leave(BroadGroup group, BroadIndex object) override {
    return group < groups_.size() && groups_[group].erase(object) > 0;
  }

  std::span<const BroadPair> tick() override {
    answer_.clear();
    for (const BroadPair pair : pairs_) test(pair);
    for (const auto& group : groups_) {
      for (auto a = group.begin(); a != group.end(); ++a) {
        for (auto b = std::next(a); b != group.end(); ++b) test({*a, *b});
      }
    }
    std::ranges::sort(answer_);
    answer_.erase(std::ranges::unique(answer_).begin(), answer_.end());
    return answer_;
  }
  [[nodiscard]] BroadPhaseCounters counters() const override { return counters_; }

 private:
  void test(BroadPair pair) {
    const WorldBox &a = *boxes_[pair.low], &b = *boxes_[pair.high];
    ++counters_.box_tests;
    if (a.is_empty() || b.is_empty()) return;
    for (int i = 0; i < 3; ++i) {
      if (!(a.lo[i] <= b.hi[i] && b.lo[i] <= a.hi[i])) return;
    }
    answer_.push_back(pair);
  }
  std::vector<std::optional<WorldBox>> boxes_;
  std::set<BroadPair> pairs_;
  std::vector<std::set<BroadIndex>> groups_;
  std::vector<BroadPair> answer_;
  BroadPhaseCounters counters_;
};

// The others. Each object has a fat box; interests whose fat boxes overlap are *near*. Only when an object leaves its
// fat box are its other interests looked at, and that is where the methods differ; in every tick, what is near to a
// moved object is tested exactly.
class Incremental final : public BroadPhase {
 public:
  explicit Incremental(BroadPhaseMethod method) : method_(method) {
    if (method != BroadPhaseMethod::kInterestLists) pair_finder_ = make_finder();
  }

  void add(BroadIndex object, const WorldBox& box) override;
  void remove(BroadIndex object) override;
  void move(BroadIndex object, const WorldBox& box) override;
  bool register_interest(BroadIndex a, BroadIndex b) override;
  bool unregister_interest(BroadIndex a, BroadIndex b) override;
  bool join(BroadGroup group, BroadIndex object) override;
  bool leave(BroadGroup group, BroadIndex object) override;
  std::span<const BroadPair> tick() override;
  [[nodiscard]] BroadPhaseCounters counters() const override;

 private:
  struct Interest {  // in the list of one of the two
    BroadIndex other;
    std::uint32_t reverse_index;  // where in the other's list
  };
  struct State {
    bool exists = false;
    bool in_to_test = false;  // in touched_
    bool changed = false;     // in changed_
  };
  struct Refit {  // of the fat box, the last
    float margin_m = 0.0F;
    std::uint32_t tick = 0;
  };
  struct Group {
    std::unique_ptr<OverlapFinder> finder;
    std::vector<BroadIndex> changed;
  };

  [[nodiscard]] std::unique_ptr<OverlapFinder> make_finder() const {
    if (method_ == BroadPhaseMethod::kSweepAndPrune) return std::make_unique<SweepAndPrune>(fat_boxes_);
    return std::make_unique<DynamicTree>(fat_boxes_);
  }
  [[nodiscard]] bool exists(BroadIndex object) const { return object < state_.size() && state_[object].exists; }
  void mark_for_test(BroadIndex object) {
    if (!std::exchange(state_[object].in_to_test, true)) to_test_.push_back(object);
  }
  void mark_for_search(BroadIndex object) {
    if (!std::exchange(state_[object].changed, true)) changed_.push_back(object);
  }
  [[nodiscard]] const Interest* find_interest(BroadIndex a, BroadIndex b) const;
  void erase_interest(BroadIndex object, std::uint32_t i);
  [[nodiscard]] bool share_group(BroadIndex a, BroadIndex b) const;
  void drop(NearPairs::Index i);
  template <class Condition>
  void drop_if(BroadIndex object, const Condition& condition);
  void begin_marks(BroadIndex object);
  void add_near(BroadIndex object, BroadIndex other);

  void refit(BroadIndex object);
  void refit_changed();
  void search_lists();
  void search(OverlapFinder& finder, std::vector<BroadIndex>& changed, bool only_registered);
  void test(NearPairs::Pair& pair);
  void test_near();
  void apply_toggles();

  BroadPhaseMethod method_;
  // By object.
  std::vector<ExactBox> boxes_;
  std::vector<FatBox> fat_boxes_;
  std::vector<Refit> refit_;
  std::vector<State> state_;
  std::vector<std::vector<Interest>> interests_;
  std::vector<std::vector<BroadGroup>> groups_of_;
  std::vector<std::uint64_t> mark_;  // == mark_now_: near to the object that is searched for

  std::unique_ptr<OverlapFinder> pair_finder_;  // over the objects that have interests; none with lists
  std::vector<Group> groups_;
  NearPairs near_;
  std::size_t count_ = 0;
  std::uint64_t mark_now_ = 0;
  std::uint32_t tick_ = 0;
  std::vector<BroadIndex> to_test_;  // what is near to them is tested
  std::vector<BroadIndex> changed_;  // and what is near is looked for: they left their fat boxes, or have new interests
  std::vector<BroadIndex> pair_changed_;
  std::vector<OverlapFinder::Found> found_;
  std::vector<BroadPair> toggled_;  // began or ended since the last tick; twice is not at all
  std::vector<BroadPair> answer_, merged_;
  BroadPhaseCounters counters_;
};

void Incremental::add(BroadIndex object, const WorldBox& box) {
  if (state_.size() <= object) {
    const std::size_t n = std::size_t{object} + 1;
    boxes_.resize(n, ExactBox::none());
    fat_boxes_.resize(n, FatBox::none());
    refit_.resize(n);
    state_.resize(n);
    interests_.resize(n);
    groups_of_.resize(n);
    mark_.resize(n);
    near_.grow(n);
    // What the number of objects doesn't bound grows by doubling; from here, so that it does so early if at all.
    const std::size_t room = boxes_.capacity();
    for (auto* list : {&to_test_, &changed_, &pair_changed_}) list->reserve(room);
    for (auto* list : {&toggled_, &answer_, &merged_}) list->reserve(room);
    found_.reserve(4 * room);
    near_.reserve(4 * room);
  }
  assert(!exists(object));
  state_[object].exists = true;
  boxes_[object] = ExactBox::of(box);
  ++count_;
  mark_for_test(object);
  mark_for_search(object);
}

void Incremental::remove(BroadIndex object) {
  assert(exists(object));
  drop_if(object, [](BroadIndex) { return true; });
  if (pair_finder_ && !interests_[object].empty()) pair_finder_->erase(object);
  while (!interests_[object].empty()) {
    const Interest interest = interests_[object].back();
    erase_interest(interest.other, interest.reverse_index);
    interests_[object].pop_back();
    if (pair_finder_ && interests_[interest.other].empty()) pair_finder_->erase(interest.other);
  }
  for (const BroadGroup group : groups_of_[object]) groups_[group].finder->erase(object);
  groups_of_[object].clear();
  boxes_[object] = ExactBox::none();
  fat_boxes_[object] = FatBox::none();
  state_[object].exists = false;
  --count_;
}

void Incremental::move(BroadIndex object, const WorldBox& box) {
  assert(exists(object));
  const ExactBox to = ExactBox::of(box);
  ExactBox& from = boxes_[object];
  if (to == from || (to.is_none() && from.is_none())) return;
  from = to;
  ++counters_.moves;
  mark_for_test(object);
  if (!contains(fat_boxes_[object], to)) mark_for_search(object);
}

const Incremental::Interest* Incremental::find_interest(BroadIndex a, BroadIndex b) const {
  if (interests_[b].size() < interests_[a].size()) {
    const Interest* of_b = find_interest(b, a);
    return of_b == nullptr ? nullptr : &interests_[a][of_b->reverse_index];
  }
  const auto found = std::ranges::find(interests_[a], b, &Interest::other);
  return found == interests_[a].end() ? nullptr : &*found;
}

// The last one of the list takes its place.
void Incremental::erase_interest(BroadIndex object, std::uint32_t i) {
  auto& list = interests_[object];
  list[i] = list.back();
  list.pop_back();
  if (i < list.size()) interests_[list[i].other][list[i].reverse_index].reverse_index = i;
}

bool Incremental::share_group(BroadIndex a, BroadIndex b) const {
  return std::ranges::any_of(groups_of_[a],
                             [&](BroadGroup g) { return std::ranges::find(groups_of_[b], g) != groups_of_[b].end(); });
}

bool Incremental::register_interest(BroadIndex a, BroadIndex b) {
  assert(a != b && exists(a) && exists(b));
  if (find_interest(a, b) != nullptr) return false;
  for (const BroadIndex object : {a, b}) {
    if (!pair_finder_ || !interests_[object].empty()) continue;
    pair_finder_->insert(object);
    mark_for_test(object);
    mark_for_search(object);
  }
  interests_[a].push_back({b, static_cast<std::uint32_t>(interests_[b].size())});
  interests_[b].push_back({a, static_cast<std::uint32_t>(interests_[a].size() - 1)});
  ++counters_.box_tests;
  if (overlap(fat_boxes_[a], fat_boxes_[b]) && near_.find(a, b) == NearPairs::kNone) {
    near_.add(make_broad_pair(a, b));
    mark_for_test(a);
  }
  return true;
}

bool Incremental::unregister_interest(BroadIndex a, BroadIndex b) {
  assert(a != b && exists(a) && exists(b));
  const Interest* interest = find_interest(a, b);
  if (interest == nullptr) return false;
  const std::uint32_t reverse_index = interest->reverse_index;
  const auto i = static_cast<std::uint32_t>(interest - interests_[a].data());
  erase_interest(a, i);
  erase_interest(b, reverse_index);
  for (const BroadIndex object : {a, b}) {
    if (pair_finder_ && interests_[object].empty()) pair_finder_->erase(object);
  }
  if (const auto near = near_.find(a, b); near != NearPairs::kNone && !share_group(a, b)) drop(near);
  return true;
}

bool Incremental::join(BroadGroup group, BroadIndex object) {
  assert(exists(object));
  if (groups_.size() <= group) groups_.resize(std::size_t{group} + 1);
  if (!groups_[group].finder) groups_[group].finder = make_finder();
  auto& groups = groups_of_[object];
  if (std::ranges::find(groups, group) != groups.end()) return false;
  groups.push_back(group);
  groups_[group].finder->insert(object);
  mark_for_test(object);
  mark_for_search(object);
  return true;
}

bool Incremental::leave(BroadGroup group, BroadIndex object) {
  assert(exists(object));
  if (std::erase(groups_of_[object], group) == 0) return false;
  groups_[group].finder->erase(object);
  drop_if(object, [&](BroadIndex o) { return !share_group(object, o) && find_interest(object, o) == nullptr; });
  return true;
}

void Incremental::drop(NearPairs::Index i) {
  if (near_[i].overlapping) toggled_.push_back(near_[i].pair());
  near_.erase(i);
}

template <class Condition>
void Incremental::drop_if(BroadIndex object, const Condition& condition) {
  for (auto i = near_.first(object); i != NearPairs::kNone;) {
    auto next = near_.next(i, object);
    if (condition(near_[i].other(object))) {
      if (next == near_.all().size() - 1) next = i;  // which takes its place
      drop(i);
    }
    i = next;
  }
}

std::span<const BroadPair> Incremental::tick() {
  ++tick_;
  refit_changed();
  if (method_ == BroadPhaseMethod::kInterestLists) {
    search_lists();
  } else {
    for (const BroadIndex object : changed_) {
      if (!interests_[object].empty()) pair_changed_.push_back(object);
    }
    search(*pair_finder_, pair_changed_, true);
  }
  for (const BroadIndex object : changed_) {
    for (const BroadGroup group : groups_of_[object]) groups_[group].changed.push_back(object);
  }
  for (Group& group : groups_) {
    if (!group.changed.empty()) search(*group.finder, group.changed, false);
  }
  for (const BroadIndex object : changed_) state_[object].changed = false;
  changed_.clear();
  test_near();
  for (const BroadIndex object : to_test_) state_[object].in_to_test = false;
  to_test_.clear();
  apply_toggles();
  return answer_;
}

// The room is by how far the sides went since the last time, a tick.
void Incremental::refit(BroadIndex object) {
  const ExactBox& box = boxes_[object];
  FatBox& fat = fat_boxes_[object];
  Refit& last = refit_[object];
  double step_m = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {  // what is NaN, as of infinite sides that stay, is passed over
    step_m = std::max(step_m, std::abs(box.lo[i] - (fat.lo[i] + last.margin_m)));
    step_m = std::max(step_m, std::abs(box.hi[i] - (fat.hi[i] - last.margin_m)));
  }
  // More for some and less for others, by index: or all that started together leave their boxes together, ever again.
  const double share = 0.75 + 0.5 * 0x1p-32 * (object * 0x9e37'79b1u);
  const double margin_m = fat_margin_m(box, share * step_m / std::max(tick_ - last.tick, 1u));
  fat = fattened(box, margin_m);
  last = {static_cast<float>(margin_m), tick_};
  ++counters_.refits;
}

void Incremental::refit_changed() {
  for (const BroadIndex object : changed_) {
    if (!contains(fat_boxes_[object], boxes_[object])) refit(object);
  }
  for (const BroadIndex object : changed_) {
    drop_if(object, [&](BroadIndex other) {
      ++counters_.box_tests;
      return !overlap(fat_boxes_[object], fat_boxes_[other]);
    });
  }
}

void Incremental::begin_marks(BroadIndex object) {
  ++mark_now_;
  for (auto i = near_.first(object); i != NearPairs::kNone; i = near_.next(i, object)) {
    mark_[near_[i].other(object)] = mark_now_;
  }
}

void Incremental::add_near(BroadIndex object, BroadIndex other) {
  if (std::exchange(mark_[other], mark_now_) != mark_now_) near_.add(make_broad_pair(object, other));
}

void Incremental::search_lists() {
  for (const BroadIndex object : changed_) {
    if (interests_[object].empty()) continue;
    begin_marks(object);
    const FatBox fat = fat_boxes_[object];
    counters_.box_tests += interests_[object].size();
    for (const Interest& interest : interests_[object]) {
      if (overlap(fat, fat_boxes_[interest.other])) add_near(object, interest.other);
    }
  }
}

void Incremental::search(OverlapFinder& finder, std::vector<BroadIndex>& changed, bool only_registered) {
  found_.clear();
  finder.update(changed, found_);
  changed.clear();
  const OverlapFinder::Found* last = nullptr;
  for (const OverlapFinder::Found& f : found_) {
    if (only_registered && find_interest(f.changed, f.other) == nullptr) continue;
    if (last == nullptr || last->changed != f.changed) begin_marks(f.changed);
    last = &f;
    add_near(f.changed, f.other);
  }
}

void Incremental::test(NearPairs::Pair& pair) {
  ++counters_.box_tests;
  const bool now = overlap(boxes_[pair.object[0]], boxes_[pair.object[1]]);
  if (now == pair.overlapping) return;
  pair.overlapping = now;
  toggled_.push_back(pair.pair());
}

// When much has moved, all near pairs in their order in memory; otherwise the moved objects' own.
void Incremental::test_near() {
  if (2 * to_test_.size() > count_) {
    for (NearPairs::Pair& pair : near_.all()) {
      if (state_[pair.object[0]].in_to_test || state_[pair.object[1]].in_to_test) test(pair);
    }
    return;
  }
  for (const BroadIndex object : to_test_) {
    for (auto i = near_.first(object); i != NearPairs::kNone; i = near_.next(i, object)) {
      const BroadIndex other = near_[i].other(object);
      if (other > object || !state_[other].in_to_test) test(near_[i]);
    }
  }
}

void Incremental::apply_toggles() {
  if (toggled_.empty()) return;
  std::ranges::sort(toggled_);
  auto kept = toggled_.begin();
  for (auto i = toggled_.begin(); i != toggled_.end();) {
    const auto end = std::find_if(i, toggled_.end(), [&](BroadPair p) { return p != *i; });
    if ((end - i) % 2 != 0) *kept++ = *i;
    i = end;
  }
  merged_.clear();
  std::set_symmetric_difference(answer_.begin(), answer_.end(), toggled_.begin(), kept, std::back_inserter(merged_));
  std::swap(answer_, merged_);
  toggled_.clear();
}

BroadPhaseCounters Incremental::counters() const {
  BroadPhaseCounters sum = counters_;
  if (pair_finder_) sum.box_tests += pair_finder_->box_tests();
  for (const Group& group : groups_) {
    if (group.finder) sum.box_tests += group.finder->box_tests();
  }
  return sum;
}

}  // namespace

std::unique_ptr<BroadPhase> make_broad_phase(BroadPhaseMethod method) {
  if (method == BroadPhaseMethod::kBruteForce) return std::make_unique<BruteForce>();
  return std::make_unique<Incremental>(method);
}

}  // namespace peerd::collision
