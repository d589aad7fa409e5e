#pragma once
#include <string>

#include "peerd/peer/config/scenario.hpp"

namespace peerd::live {

// The arguments of `tc qdisc replace dev DEVICE root` with which the kernel's netem does to one direction what the
// simulator's Link does with the same settings. netem's own `reorder` lets a share of the packets pass at once, while
// the simulator holds a share back, and netem's `delay MEAN SPREAD` is symmetric. So both are given as one distribution
// of the delay, a table that netem draws from.
struct NetemSettings {
  std::string options;  // "netem limit .. delay .."
  // The text of that table, which tc must find as kTable.dist. It is empty where the options name none.
  std::string table;
};

inline constexpr const char* kTable = "peerd";  // the table's name in `options`

[[nodiscard]] NetemSettings netem_settings(const config::LinkSettings& link);

}  // namespace peerd::live
