#pragma once
#include <optional>
#include <string>

#include "core/time.hpp"
#include "peerd/input/input_error.hpp"

namespace peerd::net {

// The program that started this one as a service and wants to know how it is: systemd, by sd_notify(3). Where none did,
// all calls do nothing and succeed.
class ServiceManager {
 public:
  // Takes from the environment whether there is one, and what it wants, so that children of this process do not speak
  // for it.
  [[nodiscard]] static ServiceManager of_environment();

  [[nodiscard]] bool is_there() const { return !socket_.empty(); }
  // It ends this process if alive() is not called for so long. None: it does not watch.
  [[nodiscard]] std::optional<Duration> watches_for() const { return watches_for_; }

  [[nodiscard]] Result<void> ready() const { return notify("READY=1"); }
  [[nodiscard]] Result<void> alive() const { return notify("WATCHDOG=1"); }
  [[nodiscard]] Result<void> stopping() const { return notify("STOPPING=1"); }
  // Until ready() is called again.
  [[nodiscard]] Result<void> reloading() const;
  // One line for people.
  [[nodiscard]] Result<void> status(const std::string& text) const;

 private:
  [[nodiscard]] Result<void> notify(const std::string& state) const;

  std::string socket_;  // empty: there is no manager
  std::optional<Duration> watches_for_;
};

}  // namespace peerd::net
