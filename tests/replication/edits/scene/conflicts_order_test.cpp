// The list of conflicts is a function of the operations that are known: in whatever order these come, it is the same.
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/scene/reader.hpp"
#include "core/vrml/document.hpp"
#include "core/writer/writer.hpp"
#include "replication/edits/scene/living_scene.hpp"

namespace peerd::replication::conflicts_order_test {

constexpr std::size_t kAuthors = 3;
const std::string kHead = "#VRML V2.0 utf8\n";
const std::string kBox = "children Shape { geometry Box { } }";

using Losses = std::map<OperationId, std::optional<OperationId>>;  // the winner by the loser

Losses losses_of(const LivingScene& living, SimTime now) {
  Losses all;
  for (const Conflict& each : living.conflicts().list(now)) {
    all.emplace(each.loser.second, each.winner ? std::optional(each.winner->second) : std::nullopt);
  }
  return all;
}

std::string text_of(const Losses& losses) {
  std::string text;
  const auto name = [](OperationId id) { return std::to_string(id.author.value) + ":" + std::to_string(id.number); };
  for (const auto& [loser, winner] : losses) text += name(loser) + " by " + (winner ? name(*winner) : "none") + "\n";
  return text;
}

// Authors undo one edit in `undo_of`, hear of another author after one in `hears_of`, and move in
// `moves_in_ten` edits of ten: those that cross would often make an object a part of itself, and are refused.
struct Habits {
  std::size_t undo_of = 6, hears_of = 3, moves_in_ten = 0;
};

// Three authors that edit one scene. Each hears of the others now and then, so that many edits cross.
class Authors {
 public:
  Authors(const Scene& file, std::uint64_t seed, const Habits& habits = {}) : habits_(habits), random_(seed) {
    for (std::size_t i = 0; i < kAuthors; ++i) scenes_.emplace_back(file);
  }

  void make(int count) {
    for (int k = 0; k < count; ++k) {
      const std::size_t i = draw(kAuthors);
      if (draw(habits_.hears_of) == 0) hear(i, draw(kAuthors));
      const SimTime now = SimTime{} + std::chrono::milliseconds(10 * k);
      while (scenes_[i].apply(now, now)) {
      }
      edit(i, now + std::chrono::milliseconds(1));
    }
  }
  [[nodiscard]] const std::array<std::vector<Operation>, kAuthors>& logs() const { return logs_; }
  [[nodiscard]] std::size_t draw(std::size_t count) { return random_() % count; }

 private:
  void hear(std::size_t i, std::size_t of) {
    if (i == of) return;
    for (std::size_t& known = heard_[i][of]; known < logs_[of].size(); ++known) scenes_[i].add(logs_[of][known]);
  }
  void edit(std::size_t i, SimTime stamp) {
    LivingScene& own = scenes_[i];
    const AuthorId author{static_cast<std::uint32_t>(7 + i)};
    std::optional<OperationBody> body;
    if (draw(habits_.undo_of) == 0) {
      if (auto undo = own.next_undo(author, draw(3) == 0, stamp)) body = undo->undo;
    } else if (auto draft = own.draft(some_edit(i), author, stamp)) {
      next_[i] += 100;
      body = std::move(draft->body);
    }
    if (!body) return;
    const auto number = static_cast<std::uint32_t>(logs_[i].size() + 1);
    const Operation operation{{author, number}, stamp, *std::move(body), own.conflicts().news_for(author)};
    logs_[i].push_back(operation);
    own.add(operation);
  }
  OperationBody some_edit(std::size_t i) {
    const Scene& scene = *scenes_[i].scene();
    std::vector<ObjectId> transforms;
    for (std::uint32_t at = 0; at < scene.instances.size(); ++at) {
      if (scene.instances[at].kind == NodeKind::kTransform) transforms.push_back(scene.id_of(at));
    }
    const std::string box = kHead + "DEF NEW Transform { " + kBox + " }";
    if (transforms.empty()) return AddNodes{{}, {}, box, next_[i], next_[i], {}};
    const auto object = [&] { return transforms[draw(transforms.size())]; };
    const auto node_of = [&](ObjectId id) { return scene.document->ids.id_of(scene.at(id).node); };
    const ObjectId chosen = object();
    if (habits_.moves_in_ten > 0 && draw(10) < habits_.moves_in_ten) return MoveObject{chosen, object(), {}};
    switch (draw(7)) {
      case 0: {
        const bool is_below = draw(2) == 0;
        const std::string text = draw(4) == 0 ? kHead + "Viewpoint { }" : box;
        return AddNodes{is_below ? std::optional(chosen) : std::nullopt, {}, text, next_[i], next_[i], {}};
      }
      case 1:
        return scene.instances.size() > 4 ? OperationBody(RemoveObject{chosen})
                                          : OperationBody(SetData{node_of(chosen), "k", "v"});
      case 2:
        return MoveObject{chosen, draw(3) == 0 ? std::nullopt : std::optional(object()), {}};
      case 3:
      case 4:
        return SetData{node_of(chosen), draw(2) == 0 ? "k" : "l", std::to_string(draw(100))};
      default:
        return SetField{node_of(chosen), "translation", std::to_string(draw(100)) + " 0 0", next_[i]};
    }
  }

  Habits habits_;
  std::mt19937_64 random_;
  std::deque<LivingScene> scenes_;  // which do not move
  std::array<std::vector<Operation>, kAuthors> logs_;
  std::array<std::array<std::size_t, kAuthors>, kAuthors> heard_{};
  std::array<std::uint32_t, kAuthors> next_{};  // ids
};

void expect_same_in_any_order(std::uint64_t seed, const Habits& habits) {
  const ReadResult file = read_world(kHead + "DEF A Transform { " + kBox + " } DEF B Transform { " + kBox +
                                     " } DEF C Transform { children DEF D Transform { " + kBox + " } }");
  ASSERT_TRUE(file.scene);
  Authors authors(*file.scene, seed, habits);
  authors.make(120);
  const SimTime end = SimTime{} + std::chrono::seconds(10);
  LivingScene at_once(*file.scene);
  for (const auto& log : authors.logs()) {
    for (const Operation& each : log) at_once.add(each);
  }
  while (at_once.apply(end, end)) {
  }
  const Losses expected = losses_of(at_once, end);
  for (int receiver = 0; receiver < 6; ++receiver) {
    LivingScene living(*file.scene);
    std::array<std::size_t, kAuthors> next{};
    std::optional<SimTime> latest;
    for (;;) {
      std::vector<std::size_t> left;
      for (std::size_t i = 0; i < kAuthors; ++i) {
        if (next[i] < authors.logs()[i].size()) left.push_back(i);
      }
      if (left.empty()) break;
      const std::size_t of = left[authors.draw(left.size())];
      const Operation& each = authors.logs()[of][next[of]++];
      latest = std::max(latest.value_or(each.stamp), each.stamp);
      living.add(each);
      while (authors.draw(2) == 0 && living.apply(*latest, *latest)) {
      }
    }
    while (living.apply(end, end)) {
    }
    EXPECT_EQ(write_world(*living.scene())->text, write_world(*at_once.scene())->text) << "receiver " << receiver;
    EXPECT_EQ(text_of(losses_of(living, end)), text_of(expected)) << "receiver " << receiver;
  }
}

class ConflictsInAnyOrder : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, ConflictsInAnyOrder, testing::Range(std::uint64_t{1}, std::uint64_t{41}),
                         testing::PrintToStringParamName());

TEST_P(ConflictsInAnyOrder, AreTheSame) { expect_same_in_any_order(GetParam(), {}); }

TEST_P(ConflictsInAnyOrder, AreTheSameWhereMuchIsRefusedAndUndone) {
  expect_same_in_any_order(GetParam(), {.undo_of = 3, .hears_of = 6, .moves_in_ten = 6});
}

TEST(CrossingEdits, AreThere) {
  const ReadResult file = read_world(kHead + "DEF A Transform { " + kBox + " } DEF B Transform { " + kBox + " }");
  ASSERT_TRUE(file.scene);
  Authors authors(*file.scene, 1);
  authors.make(120);
  LivingScene living(*file.scene);
  for (const auto& log : authors.logs()) {
    for (const Operation& each : log) living.add(each);
  }
  const SimTime end = SimTime{} + std::chrono::seconds(10);
  while (living.apply(end, end)) {
  }
  EXPECT_GT(losses_of(living, end).size(), 10u);
}

}  // namespace peerd::replication::conflicts_order_test
