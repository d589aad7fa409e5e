#pragma once
#include "tests/replication/peer/peers.hpp"

// Three peers on a small network that edit a scene of BALL, CAR and a HOUSE with a WALL in it.
namespace peerd::replication::test {

class EditingPeers : public Peers {
 protected:
  EditingPeers()
      : Peers(box("BALL", "1 1 1", "0 0 0") + box("CAR", "1 1 1", "0 20 0") + "DEF HOUSE Transform { children " +
                  box("WALL", "1 4 9", "9 0 0") + "}\n",
              {"BALL", "CAR", "HOUSE"}) {}

  void begin(Link link = {.latency = 20ms}, std::uint64_t seed = 1) {
    lan = std::make_unique<Lan>(world, link, seed);
    for (std::uint32_t id = 1; id <= 3; ++id) lan->add(config(id));
    lan->run_until(3s);
  }
  // The third peer is apart from the others until they meet.
  void begin_apart() {
    begin();
    lan->part({2});
    run_on(3s);
  }
  void meet() const {
    lan->part({});
    run_on(6s);
    expect_one_world();
  }
  // The edit that was undone, or why none was.
  [[nodiscard]] std::string undo(std::size_t i, bool redoes = false) const {
    const auto undone = lan->peer(i).undo(lan->host_now(i), redoes);
    run_on(1s);
    return undone ? undone->kind : undone.error();
  }
  [[nodiscard]] std::string redo(std::size_t i) const { return undo(i, true); }
  [[nodiscard]] ObjectId object(const std::string& path) const { return scene().find(path).value(); }
  [[nodiscard]] SetField placing(const std::string& path, int x, std::size_t at_peer = 0) const {
    return {node(path, at_peer), "translation", std::to_string(x) + " 0 0", 0};
  }
  [[nodiscard]] AddNodes adding(const std::string& name, std::optional<ObjectId> parent = {}) const {
    return {parent, {}, "#VRML V2.0 utf8\n" + box(name, "1 1 1", "5 5 5"), 0, 0, {}};
  }
  void expect_one_world() const {
    expect_one_scene();
    for (std::size_t i = 1; i < lan->size(); ++i) {
      EXPECT_TRUE(lan->peer(i).data().changes_since(lan->peer(0).data()).empty()) << "peer " << i + 1;
    }
  }
};

}  // namespace peerd::replication::test
