// Undo in a LivingScene, against an oracle: the operations that are not undone, applied as if there were no others.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/scene/reader.hpp"
#include "core/vrml/document.hpp"
#include "core/writer/writer.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/edits/scene/living_scene.hpp"

namespace peerd::replication::living_scene_undo_test {

const std::string kHead = "#VRML V2.0 utf8\n";
constexpr AuthorId kAuthors[3]{AuthorId{7}, AuthorId{9}, AuthorId{11}};

Scene read(const std::string& text) {
  ReadResult result = read_world(kHead + text);
  EXPECT_TRUE(result.scene) << text;
  return std::move(result.scene).value_or(Scene{});
}

std::string text_of(const LivingScene& living) {
  const auto written = write_world(*living.scene());
  EXPECT_TRUE(written);
  std::string text = written ? written->text : "";
  for (std::uint32_t n = 0; n < 5; ++n) {
    for (const std::string& key : living.data().keys(NodeId{n}))
      text += key + "=" + *living.data().find(NodeId{n}, key);
  }
  return text;
}

void apply_all(LivingScene& living, SimTime until, SimTime known) {
  while (living.apply(until, known)) {
  }
}

// The operations of three authors, each of whom undoes and redoes some of its own.
class Writers {
 public:
  // `padding`: so many bytes more of each value of data.
  explicit Writers(std::uint64_t seed, std::size_t padding = 0) : random_(seed), padding_(padding) {}

  void make(int count) {
    for (int k = 0; k < count; ++k) {
      const std::size_t i = draw(3);
      const OperationId id{kAuthors[i], static_cast<std::uint32_t>(logs[i].size() + 1)};
      stamp_ += std::chrono::milliseconds(1 + draw(3));
      Operation o{id, stamp_, body(i)};
      logs[i].push_back(o);
      all.push_back(o);
    }
  }
  // Those that are not undone at last, without the undos.
  [[nodiscard]] std::vector<Operation> left() const {
    std::map<std::pair<AuthorId, std::uint32_t>, bool> undone;
    for (const Operation& o : all) {
      if (const auto* undo = std::get_if<UndoOperation>(&o.body)) undone[{o.id.author, undo->number}] = !undo->redoes;
    }
    std::vector<Operation> left;
    for (const Operation& o : all) {
      const auto at = undone.find({o.id.author, o.id.number});
      if (!std::holds_alternative<UndoOperation>(o.body) && (at == undone.end() || !at->second)) left.push_back(o);
    }
    return left;
  }
  std::uint64_t draw(std::uint64_t n) { return random_() % n; }

  std::vector<Operation> all;
  std::vector<Operation> logs[3];
  std::size_t undos = 0;

 private:
  OperationBody body(std::size_t i) {
    const auto object = [&] {
      const std::uint64_t n = draw(6);
      return n < 3 ? ObjectId{static_cast<std::uint32_t>(n)}
                   : ObjectId{static_cast<std::uint32_t>(draw(8)), kAuthors[draw(3)].value};
    };
    switch (draw(8)) {
      case 0:
        if (padding_ == 0 || draw(30) == 0) return RemoveObject{object()};  // of many operations few remove something
        [[fallthrough]];
      case 1:
        return MoveObject{object(), object(), {}};
      case 2:
      case 3:
        return AddNodes{object(), {}, kHead + "Transform { }\n", next_[i], next_[i]++, {}};
      case 4:
        return some_data();
      case 5:
      case 6:
        if (!logs[i].empty()) {
          const Operation& target = logs[i][draw(logs[i].size())];
          if (!std::holds_alternative<UndoOperation>(target.body)) {
            ++undos;
            return UndoOperation{target.id.number, target.stamp, draw(3) == 0};
          }
        }
        [[fallthrough]];
      default:
        return SetField{NodeId{static_cast<std::uint32_t>(draw(3))}, "translation", std::to_string(draw(100)) + " 0 0",
                        0};
    }
  }

  SetData some_data() {
    const NodeId node{static_cast<std::uint32_t>(draw(5))};
    const std::uint64_t value = draw(100);
    if (value < 10) return {node, "k", std::nullopt};
    return {node, "k", std::to_string(value) + std::string(padding_, '.')};
  }

  std::mt19937_64 random_;
  std::size_t padding_;
  SimTime stamp_{};
  std::uint32_t next_[3] = {};
};

TEST(LivingSceneUndo, IsAsIfTheOperationHadNeverBeen) {
  const Scene file = read("DEF A Transform { }\nDEF B Transform { }\nDEF C Transform { }\n");
  std::size_t undos = 0, differs = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Writers writers(seed);
    writers.make(60);
    undos += writers.undos;
    LivingScene oracle(file), in_order(file), any_order(file), without_undos(file);
    for (const Operation& o : writers.left()) oracle.add(o);
    apply_all(oracle, SimTime::max(), SimTime::max());
    for (const Operation& o : writers.all) {
      in_order.add(o);
      apply_all(in_order, o.stamp, SimTime::min());
      if (!std::holds_alternative<UndoOperation>(o.body)) without_undos.add(o);
    }
    apply_all(without_undos, SimTime::max(), SimTime::max());
    // Each log arrives in its order, and the logs anyhow.
    std::size_t taken[3] = {};
    SimTime now{};
    for (std::size_t k = 0; k < writers.all.size();) {
      const std::size_t i = writers.draw(3);
      if (taken[i] == writers.logs[i].size()) continue;
      const Operation& o = writers.logs[i][taken[i]++];
      now = std::max(now, o.stamp);
      any_order.add(o);
      ++k;
      if (writers.draw(3) == 0) apply_all(any_order, now, writers.draw(2) == 0 ? now : SimTime::min());
    }
    apply_all(any_order, SimTime::max(), SimTime::max());
    const std::string expected = text_of(oracle);
    EXPECT_EQ(text_of(in_order), expected);
    EXPECT_EQ(text_of(any_order), expected);
    differs += text_of(without_undos) != expected ? 1 : 0;
    for (const AuthorId author : kAuthors) {
      EXPECT_EQ(any_order.next_ids(author).object, in_order.next_ids(author).object);
    }
  }
  EXPECT_GT(undos, 300u);
  EXPECT_GT(differs, 20u);
}

std::vector<ObjectId> ids_of(const Scene& scene) {
  std::vector<ObjectId> ids;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) ids.push_back(scene.id_of(i));
  return ids;
}

// The logs of a peer are packed but for the last operations. One author was away: its whole log comes when all others'
// have been applied, or a part of it is the first that there is.
TEST(LivingSceneUndo, IsTheSameWhereOperationsAreReadFromPackedLogs) {
  const Scene file = read("DEF A Transform { }\nDEF B Transform { }\nDEF C Transform { }\n");
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Writers writers(seed, 10'000);
    writers.make(300);
    LivingScene kept(file);
    for (const Operation& o : writers.all) {
      kept.add(o);
      apply_all(kept, o.stamp, SimTime::min());
    }
    OperationLogs logs;
    LivingScene alike(file);  // gets what from_logs does when that does
    LivingScene from_logs(file, {}, OperationBodies([&](OperationId id) { return logs.operation(id).body; }));
    const auto take = [&](std::size_t author, std::size_t begin, std::size_t end) {
      OperationPart part{kAuthors[author], logs.length(kAuthors[author]), {}};
      for (std::size_t k = begin; k < end; ++k) {
        const auto bytes = encode(writers.logs[author][k]);
        part.bytes.insert(part.bytes.end(), bytes.begin(), bytes.end());
      }
      const auto taken = logs.receive(part);
      ASSERT_TRUE(taken) << taken.error();
      for (const Operation& o : *taken) ASSERT_TRUE(from_logs.add(o) && alike.add(o));
    };
    const auto apply_both = [&](SimTime until) {
      for (LivingScene* living : {&from_logs, &alike}) apply_all(*living, until, SimTime::min());
    };
    const std::size_t away = writers.draw(3), early = writers.draw(2) * writers.logs[away].size() / 3;
    if (early > 0) take(away, 0, early);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; i != away && k < writers.logs[i].size(); k += 10) {
        take(i, k, std::min(k + 10, writers.logs[i].size()));
        if (writers.draw(2) == 0) apply_both(writers.logs[i][k].stamp);
      }
    }
    apply_both(SimTime::max());
    EXPECT_NE(text_of(from_logs), text_of(kept));
    take(away, early, writers.logs[away].size());
    apply_both(SimTime::max());
    EXPECT_EQ(text_of(from_logs), text_of(kept));
    EXPECT_EQ(ids_of(*from_logs.scene()), ids_of(*kept.scene()));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_GT(logs.length(kAuthors[i]), 3 * LogBytes::kBlock_bytes) << "it is packed";
      EXPECT_EQ(from_logs.next_ids(kAuthors[i]).object, kept.next_ids(kAuthors[i]).object);
      for (const Operation& o : writers.logs[i]) EXPECT_EQ(from_logs.find({o.stamp, o.id}), o.body);
      const auto undo = from_logs.next_undo(kAuthors[i], false, SimTime::max());
      const auto expected = kept.next_undo(kAuthors[i], false, SimTime::max());
      ASSERT_EQ(undo.has_value(), expected.has_value());
      if (undo) {
        EXPECT_EQ(undo->undo, expected->undo);
      }
    }
    const auto losses = [](const LivingScene& living) {
      std::vector<std::pair<OperationKey, std::optional<OperationKey>>> all;
      for (const Conflict& each : living.conflicts().list(SimTime{})) all.emplace_back(each.loser, each.winner);
      return all;
    };
    EXPECT_TRUE(losses(from_logs) == losses(alike));
  }
}

TEST(LivingSceneUndo, IsOfEarlierEditsOfItsAuthor) {
  const Scene file = read("DEF A Transform { }\n");
  LivingScene living(file);
  const SimTime first{Duration{10}}, second{Duration{20}};
  living.add({{kAuthors[0], 1}, first, SetField{NodeId{0}, "translation", "1 0 0", 0}});
  living.add({{kAuthors[1], 1}, second, UndoOperation{1, first, false}});   // another's
  living.add({{kAuthors[0], 2}, second, UndoOperation{1, second, false}});  // there is none with that stamp
  living.add({{kAuthors[0], 3}, SimTime{Duration{30}}, UndoOperation{2, second, false}});  // an undo
  std::size_t refused = 0;
  while (const auto change = living.apply(SimTime::max(), SimTime::min())) {
    for (const auto& outcome : change->outcomes) refused += outcome.refused.empty() ? 0 : 1;
  }
  EXPECT_EQ(refused, 3u);
  EXPECT_NE(text_of(living).find("1 0 0"), std::string::npos);
}

}  // namespace peerd::replication::living_scene_undo_test
