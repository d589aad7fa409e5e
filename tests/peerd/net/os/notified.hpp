#pragma once
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/peerd/comes_true.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::testing_support {

// The socket of a service manager, which a test reads in place of systemd.
class Notified {
 public:
  Notified() : path_(folder_ / "notify.sock"), socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path_.size() >= sizeof address.sun_path) throw std::runtime_error("the path is too long: " + path_);
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("can't bind " + path_);
    }
  }
  Notified(const Notified&) = delete;
  Notified& operator=(const Notified&) = delete;
  ~Notified() { close(socket_); }

  [[nodiscard]] const std::string& path() const { return path_; }
  // Takes the messages that wait.
  [[nodiscard]] std::vector<std::string> messages() const {
    std::vector<std::string> all;
    std::array<char, 4096> buffer{};
    for (;;) {
      const auto size = recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
      if (size < 0) return all;
      all.emplace_back(buffer.data(), static_cast<std::size_t>(size));
    }
  }
  // Waits until a message begins with those words, and returns whether one did.
  [[nodiscard]] bool gets(std::string_view words, double within_s) const {
    const auto has_come = [&] {
      return std::ranges::any_of(messages(), [&](const std::string& each) { return each.starts_with(words); });
    };
    return comes_true(has_come, within_s);
  }

 private:
  ScratchFolder folder_;
  std::string path_;
  int socket_;
};

}  // namespace peerd::testing_support
