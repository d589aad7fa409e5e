#pragma once
#include <string>

#include "peerd/config/scenario.hpp"

namespace peerd::netem {

// What `tc qdisc replace dev DEVICE root` takes so that the kernel's netem does to one direction what the simulator's
// Link does with the same settings. netem's own `reorder` lets a share of the packets pass at once, the simulator holds
// a share back; and its `delay MEAN SPREAD` is symmetric: so both are told as one distribution of the delay, a table
// that netem draws from.
struct NetemSettings {
  std::string options;  // "netem limit .. delay .."
  // The text of that table, to be found by tc as kTable.dist; empty: none is named.
  std::string table;
};

inline constexpr const char* kTable = "peerd";  // its name in `options`

[[nodiscard]] NetemSettings netem_settings(const config::LinkSettings& link);

}  // namespace peerd::netem
