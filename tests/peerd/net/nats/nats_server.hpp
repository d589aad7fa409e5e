#pragma once
#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/net/process.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::testing_support {

inline constexpr const char* kNatsServer = "/usr/sbin/nats-server";

// A TCP port of 127.0.0.1 that nobody has at this moment, and that the system gives to no other asker soon.
inline int free_port() {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  const bool bound = bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
                     getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  close(fd);
  if (!bound) throw std::runtime_error("no free port");
  return ntohs(address.sin_port);
}

// The real nats-server as a child of the test, on a port of its own of 127.0.0.1. It may be killed and started again.
class NatsServer {
 public:
  // `more` stands in its configuration after the port.
  NatsServer(const ScratchFolder& folder, std::string name, const std::string& more = "")
      : folder_(folder), name_(std::move(name)), port_(free_port()) {
    configure(more);
    start();
  }

  // Counts from the next start() on.
  void configure(const std::string& more) {
    std::ofstream(folder_ / (name_ + ".conf"))
        << "server_name: " << name_ << "\nlisten: \"127.0.0.1:" << port_ << "\"\nping_interval: \"1s\"\nping_max: 2\n"
        << more;
  }

  void start() {
    process_ = std::make_unique<Process>(folder_, name_, kNatsServer,
                                         std::vector<std::string>{"--config", (folder_ / (name_ + ".conf")).string()});
    const bool is_ready =
        comes_true([&] { return !process_->running() || log().find("Server is ready") != std::string::npos; }, 20);
    if (!is_ready || !process_->running()) throw std::runtime_error("nats-server does not run: " + log());
  }
  void kill() {
    process_->signal(SIGKILL);
    (void)process_->exit_code(5);
  }
  void signal(int number) const { process_->signal(number); }

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::string url(const std::string& user = "", const std::string& scheme = "nats") const {
    return scheme + "://" + (user.empty() ? "" : user + "@") + "127.0.0.1:" + std::to_string(port_);
  }
  [[nodiscard]] std::string log() const { return process_->err(); }

 private:
  const ScratchFolder& folder_;
  std::string name_;
  int port_;
  std::unique_ptr<Process> process_;
};

// The tests of NATS are skipped where its server is not installed.
inline bool has_nats_server() { return access(kNatsServer, X_OK) == 0; }

}  // namespace peerd::testing_support
