#pragma once
#include <string>
#include <utility>
#include <vector>

#include "peerd/input/input_error.hpp"
#include "peerd/lab/measure/network_measured.hpp"

namespace peerd::live {

// A socket for the probes of one peer. It stays in the network namespace in which it was opened.
class ProbeSocket {
 public:
  [[nodiscard]] static Result<ProbeSocket> open(const std::string& address);
  ProbeSocket(ProbeSocket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  ProbeSocket& operator=(ProbeSocket&&) = delete;
  ~ProbeSocket();
  [[nodiscard]] int fd() const { return fd_; }

 private:
  explicit ProbeSocket(int fd) : fd_(fd) {}
  int fd_;
};

// Every socket sends a number of datagrams to all others, one each 10 ms, and listens for `patience_ms` longer. The
// function fills in the probes of links[from * sockets + to] and by how much each wait of 10 ms was too long. A delay
// is from just before the system call to the receiving kernel's timestamp; both are read from one clock, because all
// namespaces have one kernel.
[[nodiscard]] Result<void> probe(const std::vector<ProbeSocket>& sockets, double patience_ms,
                                 std::vector<measure::LinkMeasured>& links, std::vector<double>& oversleep_ms);

}  // namespace peerd::live
