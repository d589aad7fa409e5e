#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/peer/control/control_client.hpp"
#include "tests/net/process.hpp"

namespace peerd::testing_support {

// Peers whose control sockets stand in a folder of the test's own, each by its name.
class ControlledPeers : public testing::Test {
 protected:
  // Each user has settings of their own.
  [[nodiscard]] Process start(const std::string& name, std::vector<std::string> words,
                              const std::string& user = "settings") const {
    const std::string socket = (folder / (name + ".sock")).string();
    words.insert(words.end(), {"--name", name, "--control", socket});
    return Process(folder, name, PEERD_PROGRAM, words, user);
  }
  [[nodiscard]] nlohmann::json ask(const std::string& name, const nlohmann::json& request) const {
    const auto line = control::ask(folder / (name + ".sock"), request.dump());
    return line ? nlohmann::json::parse(*line, nullptr, false) : nlohmann::json();
  }
  template <class Condition>
  static bool wait_until(const Condition& holds) {
    return comes_true(holds, 20);
  }
  [[nodiscard]] bool is_in_session(const std::string& name) const {
    return wait_until([&] {
      const nlohmann::json status = ask(name, {{"do", "status"}});
      return status.is_object() && status.at("session").at("joined").get<bool>();
    });
  }
  [[nodiscard]] std::size_t members_of(const std::string& name) const {
    const nlohmann::json status = ask(name, {{"do", "status"}});
    return status.is_object() ? status.at("members").size() : 0;
  }
  // The world of a peer, as VRML.
  [[nodiscard]] std::string world_of(const std::string& name) const {
    const nlohmann::json reply = ask(name, {{"do", "world"}});
    return reply.is_object() ? reply.value("world", std::string()) : std::string();
  }
  [[nodiscard]] bool add(const std::string& name, const std::string& def) const {
    const std::string text = "DEF " + def + " Transform { children Shape { geometry Sphere { } } }";
    const nlohmann::json reply = ask(name, {{"do", "add"}, {"text", text}});
    EXPECT_TRUE(reply.is_object() && reply.value("done", false)) << name << " answers " << reply.dump();
    return wait_until([&] { return world_of(name).find(def) != std::string::npos; });
  }

  // Waits until all have one world with all of these nodes, and says how long that took.
  void expect_one_world(const std::vector<std::string>& peers, const std::vector<std::string>& nodes,
                        const std::string& after) const {
    const auto began = std::chrono::steady_clock::now();
    const bool one = wait_until([&] {
      const std::string first = world_of(peers.front());
      return std::ranges::all_of(nodes, [&](const auto& node) { return first.find(node) != std::string::npos; }) &&
             std::ranges::all_of(peers, [&](const auto& each) { return world_of(each) == first; });
    });
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    std::cout << "one world " << took_s << " s after " << after << '\n';
    EXPECT_TRUE(one) << after << '\n' << world_of(peers.front()) << '\n' << world_of(peers.back());
  }

  ScratchFolder folder;
};

}  // namespace peerd::testing_support
