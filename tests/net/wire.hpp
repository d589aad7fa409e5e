#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <functional>
#include <string>
#include <system_error>
#include <thread>

#include "peerd/net/os/interfaces.hpp"
#include "tests/peerd/comes_true.hpp"

namespace peerd::net::testing_support {

// A network namespace belongs to a thread, a socket stays in the one where it was opened, and a namespace goes away
// with its last thread, descriptor and socket: nothing to clean up, not even after a crash.
class Namespace {
 public:
  // Moves the calling thread into a new one.
  Namespace() : fd_(unshare(CLONE_NEWNET) == 0 ? ::open("/proc/thread-self/ns/net", O_RDONLY) : -1) {
    if (fd_ < 0) problem_ = std::generic_category().message(errno);
  }
  Namespace(const Namespace&) = delete;
  Namespace& operator=(const Namespace&) = delete;
  ~Namespace() {
    if (fd_ >= 0) close(fd_);
  }
  void enter() const { ASSERT_EQ(setns(fd_, CLONE_NEWNET), 0) << std::generic_category().message(errno); }
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] std::string path() const {
    return "/proc/self/fd/" + std::to_string(fd_);
  }  // in a process that inherits the descriptor

 private:
  int fd_;
  std::string problem_;
};

inline bool shell(const std::string& command) { return std::system((command + " 2>/dev/null").c_str()) == 0; }

// left (interface va: 192.0.2.1, fe80::1) ---- right (interface vb: 192.0.2.2, fe80::2)
struct Wire {
  // Empty, or the reason why there is no wire.
  std::string lay() {
    if (!left.problem().empty() || !right.problem().empty()) {
      return "no network namespaces here: " + left.problem() + right.problem();
    }
    return connect();
  }
  // Makes the pair, again after `ip link del va`.
  [[nodiscard]] std::string connect() const {
    left.enter();
    if (!shell("ip link add va type veth peer name vb && ip link set vb netns " + right.path())) {
      return "no veth pair here (package iproute2, kernel module veth)";
    }
    if (!address("va", "1")) return "the veth pair takes no IPv4 and IPv6 addresses";
    right.enter();
    if (!address("vb", "2")) return "the veth pair takes no IPv4 and IPv6 addresses";
    const bool right_up = comes_up("vb");
    left.enter();
    return right_up && comes_up("va") ? "" : "the veth pair does not come up within 5 s";
  }
  // The carrier comes some milliseconds after the second end is up.
  static bool comes_up(const std::string& name) {
    const auto is_up = [&](const Interface& i) { return i.name == name && i.running && i.has_ipv6; };
    const auto any_is_up = [&] {
      const auto interfaces = list_interfaces();
      return interfaces && std::ranges::any_of(*interfaces, is_up);
    };
    return peerd::testing_support::comes_true(any_is_up, 5);
  }
  // nodad: an address is unusable while its uniqueness is checked, for a second or two.
  static bool address(const std::string& name, const std::string& host) {
    return shell("ip link set lo up && ip link set " + name + " addrgenmode none && ip addr add 192.0.2." + host +
                 "/24 dev " + name + " && ip addr add fe80::" + host + "/64 dev " + name + " nodad && ip link set " +
                 name + " up");
  }

  Namespace left, right;
};

// Runs `body` on a thread of its own, with a wire; skips the test when there can be none.
inline void with_wire(const std::function<void(const Wire&)>& body) {
  std::string missing;
  std::thread([&] {
    try {
      Wire wire;
      missing = wire.lay();
      if (missing.empty()) body(wire);
    } catch (const std::exception& e) {  // GoogleTest catches on its own thread only
      ADD_FAILURE() << e.what();
    }
  }).join();
  if (!missing.empty()) GTEST_SKIP() << missing;
}

}  // namespace peerd::net::testing_support
