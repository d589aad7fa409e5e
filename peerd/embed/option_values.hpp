#pragma once
#include <functional>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/node/log_line.hpp"
#include "peerd/peer/peer_options.hpp"
#include "peerd/peer/run_flags.hpp"

namespace peerd::embed {

// The options of a peer in a program, by the names that `peerd run` has for them.
class OptionValues {
 public:
  OptionValues();

  // False: there is no such option, or it does not take that value.
  bool set(const std::string& name, const std::string& value);
  // The error says which options don't go together.
  [[nodiscard]] Result<PeerOptions> peer_options() const;

  std::function<void(const LogLine&)> log_to{};  // empty: lines are lost

 private:
  PeerOptions options_;
  RunFlags flags_;
};

}  // namespace peerd::embed
