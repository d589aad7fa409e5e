#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>

namespace peerd {

// `peerd export RUN|CAPTURE --mcap FILE` writes a recorded world (peerd/lab/recorded) for Foxglove and Rerun. Returns
// the exit code: 0 good, 1 the capture or its world has errors, 2 there is no such thing, 3 FILE can't be written.
//
// With `json` it prints one object to `out`, which is that of error_json where nothing is written: what, file, bytes,
// messages, views [{peer, name}], duration_s, notes.
struct McapOptions {
  std::string what;  // an output folder of peerd sim, or a capture
  std::filesystem::path file;
  std::string world{};  // place of a capture's world now; empty: where it was
  std::uint64_t run = 1;
  std::uint32_t hz = 30;
  std::uint64_t memory_mib = 512;
  std::uint64_t size_max_mib = 1024;  // a larger capture is refused
  bool json = false;
};
[[nodiscard]] int run_mcap_export(const McapOptions& options, std::ostream& out, std::ostream& err);

}  // namespace peerd
