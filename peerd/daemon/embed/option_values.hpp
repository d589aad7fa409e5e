#pragma once
#include <functional>
#include <optional>
#include <string>

#include "peerd/daemon/open/peer_options.hpp"
#include "peerd/daemon/open/run_flags.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/peer/node/log_line.hpp"

namespace peerd::embed {

// The options of a peer in a program, by the names that `peerd run` has for them.
class OptionValues {
 public:
  OptionValues();

  // False: there is no such option, or it does not take that value.
  bool set(const std::string& name, const std::string& value);
  // The options of the peer. With join, from or invite it gets the world from others first, which takes a second at
  // least. Errors: options that don't go together, a world that can't be joined.
  [[nodiscard]] Result<PeerOptions> peer_options() const;

  std::function<void(const LogLine&)> log_to{};  // empty: lines are lost

 private:
  [[nodiscard]] bool joins() const { return join_ || !from_.empty() || !invitation_.empty(); }
  [[nodiscard]] Result<void> check() const;
  [[nodiscard]] Result<void> join(PeerOptions& options) const;

  PeerOptions options_;
  RunFlags flags_;
  std::optional<std::string> join_{};  // a world's name; empty: the only one
  std::string from_{}, invitation_{};
};

}  // namespace peerd::embed
