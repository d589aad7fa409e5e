#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/vrml/document.hpp"
#include "core/writer/writer.hpp"
#include "tests/replication/peer/lan.hpp"

// The fixture of most tests of whole peers: a world, a network that a test sets up itself, and what peers make of it.
namespace peerd::replication::test {

class Peers : public testing::Test {
 protected:
  explicit Peers(const std::string& text, const std::vector<const char*>& owned = {}) : world(text, owned) {}

  void run_on(Duration d) const { lan->run_until(lan->now() + d); }
  [[nodiscard]] bool runs(std::size_t i) const { return lan->node(i).running; }

  // ---- edits ----

  OperationId edit(std::size_t i, OperationBody body) const {
    const auto id = lan->peer(i).edit(lan->host_now(i), std::move(body));
    EXPECT_TRUE(id) << id.error();
    return id.value_or(OperationId{});
  }
  // Why the peer may not make the edit; empty: it has made it.
  [[nodiscard]] std::string refusal(std::size_t i, OperationBody body) const {
    const auto id = lan->peer(i).edit(lan->host_now(i), std::move(body));
    return id ? "" : id.error();
  }
  [[nodiscard]] const peerd::Scene& scene(std::size_t i = 0) const { return lan->peer(i).scene(); }
  [[nodiscard]] NodeId node(const std::string& path, std::size_t i = 0) const {
    return scene(i).document->ids.id_of(scene(i).at(scene(i).find(path).value()).node);
  }
  [[nodiscard]] std::string text_at(std::size_t i) const {
    const auto written = write_world(scene(i));
    return written ? written->text : written.error();
  }
  // Expects that all running peers have the same scene as the first one.
  void expect_one_scene() const {
    for (std::size_t i = 1; i < lan->size(); ++i) {
      if (runs(i)) {
        EXPECT_EQ(text_at(0), text_at(i)) << "peer " << i + 1;
      }
    }
  }

  // ---- owners and ghosts ----

  void push(std::size_t i, const char* path, const Vec3& velocity) const {
    EXPECT_TRUE(lan->peer(i).change_velocity(lan->host_now(i), world[path], velocity, true));
  }
  [[nodiscard]] KinematicState ghost(std::size_t i, const char* path, Duration ago = 0s) const {
    return lan->peer(i).ghost(world[path], lan->session_now(i) - ago);
  }
  [[nodiscard]] std::vector<std::uint32_t> owners_of(const char* path) const {
    std::vector<std::uint32_t> owners;
    for (std::size_t i = 0; i < lan->size(); ++i) owners.push_back(lan->peer(i).owner(world[path]).value);
    return owners;
  }
  // Expects this owner at all running peers.
  void expect_owner(const char* path, PeerId owner) const {
    for (std::size_t i = 0; i < lan->size(); ++i) {
      if (runs(i)) {
        EXPECT_EQ(lan->peer(i).owner(world[path]), owner) << path << " at peer " << i + 1;
      }
    }
  }
  // Expects that all running peers have the same ghost of the object as the first one, bit for bit, `ago` before now.
  void expect_one_ghost(const char* path, Duration ago = 100ms) const {
    const SimTime t = lan->session_now(0) - ago;
    const KinematicState first = lan->peer(0).ghost(world[path], t);
    for (std::size_t i = 1; i < lan->size(); ++i) {
      if (!runs(i)) continue;
      const KinematicState other = lan->peer(i).ghost(world[path], t);
      EXPECT_TRUE(same_bits(first, other)) << path << " at peer " << i + 1 << ": " << other.position.transpose()
                                           << ", and not " << first.position.transpose();
    }
  }

  World world;
  std::unique_ptr<Lan> lan;
};

}  // namespace peerd::replication::test
