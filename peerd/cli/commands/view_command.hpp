#pragma once
#include <cstdint>
#include <functional>
#include <string>

namespace peerd {

struct ViewOptions {
  std::string what{};    // an output folder of peerd sim, a capture, or a control socket; empty: the peer of `name`
  std::string name{};    // of a running peer; empty: the only peer of this user
  std::string listen{};  // ADDRESS:PORT of the page
  std::string world{};   // place of a capture's world now; empty: where it was
  std::uint64_t run = 1;
  std::uint32_t hz = 30;
  std::uint64_t memory_mib = 512;
  std::uint64_t size_max_mib = 1024;  // a larger capture is refused
};

// `peerd view`: says where the page of a running peer is, or has `view_recorded` serve the page of a recording. Returns
// the exit code.
[[nodiscard]] int run_view(const ViewOptions& options, const std::function<int(const ViewOptions&)>& view_recorded);

}  // namespace peerd
