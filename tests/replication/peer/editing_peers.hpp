#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "core/vrml/document.hpp"
#include "core/writer/writer.hpp"
#include "tests/replication/peer/lan.hpp"

// Three peers on a small network that edit a scene of BALL, CAR and a HOUSE with a WALL in it.
namespace peerd::replication::test {

class EditingPeers : public testing::Test {
 protected:
  EditingPeers()
      : world(box("BALL", "1 1 1", "0 0 0") + box("CAR", "1 1 1", "0 20 0") + "DEF HOUSE Transform { children " +
                  box("WALL", "1 4 9", "9 0 0") + "}\n",
              {"BALL", "CAR", "HOUSE"}) {}

  void begin(Link link = {.latency = 20ms}, std::uint64_t seed = 1) {
    lan = std::make_unique<Lan>(world, link, seed);
    for (std::uint32_t id = 1; id <= 3; ++id) lan->add(config(id));
    lan->run_until(3s);
  }
  void run_on(Duration d) const { lan->run_until(lan->now() + d); }
  OperationId edit(std::size_t i, OperationBody body) const {
    const auto id = lan->peer(i).edit(lan->host_now(i), std::move(body));
    EXPECT_TRUE(id) << id.error();
    return id.value_or(OperationId{});
  }
  // The edit that was undone, or why none was.
  [[nodiscard]] std::string undo(std::size_t i, bool redoes = false) const {
    const auto undone = lan->peer(i).undo(lan->host_now(i), redoes);
    run_on(1s);
    return undone ? undone->kind : undone.error();
  }
  [[nodiscard]] std::string redo(std::size_t i) const { return undo(i, true); }
  [[nodiscard]] const peerd::Scene& scene(std::size_t i = 0) const { return lan->peer(i).scene(); }
  [[nodiscard]] ObjectId object(const std::string& path) const { return scene().find(path).value(); }
  [[nodiscard]] NodeId node(const std::string& path) const {
    return scene().document->ids.id_of(scene().at(object(path)).node);
  }
  [[nodiscard]] SetField placing(const std::string& path, int x) const {
    return {node(path), "translation", std::to_string(x) + " 0 0", 0};
  }
  [[nodiscard]] AddNodes adding(const std::string& name, std::optional<ObjectId> parent = {}) const {
    return {parent, {}, "#VRML V2.0 utf8\n" + box(name, "1 1 1", "5 5 5"), 0, 0, {}};
  }
  [[nodiscard]] std::string text_at(std::size_t i) const {
    const auto written = write_world(scene(i));
    return written ? written->text : written.error();
  }
  void expect_one_world() const {
    for (std::size_t i = 1; i < lan->size(); ++i) {
      EXPECT_EQ(text_at(0), text_at(i)) << "peer " << i + 1;
      EXPECT_TRUE(lan->peer(i).data().changes_since(lan->peer(0).data()).empty()) << "peer " << i + 1;
    }
  }

  World world;
  std::unique_ptr<Lan> lan;
};

}  // namespace peerd::replication::test
