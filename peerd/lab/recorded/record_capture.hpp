#pragma once
#include <cstdint>
#include <filesystem>

#include "peerd/lab/recorded/record_run.hpp"
#include "peerd/lab/recorded/recording.hpp"

namespace peerd::recorded {

struct CaptureFile {
  std::filesystem::path path{};
  std::filesystem::path world{};      // place of its world now; empty: where it was
  std::uint64_t size_max_mib = 1024;  // a larger one is refused
};

// Runs a captured peer once more, with its view. Where objects of others really were is not known. A note says where it
// does not do what it did.
[[nodiscard]] Result<Recording> record_capture(const CaptureFile& file, const Recorder& how);

// Records the run of that number, from 1, where the path is a folder of peerd sim, and else a capture.
[[nodiscard]] Result<Recording> record(const CaptureFile& what, std::uint64_t run, const Recorder& how);

}  // namespace peerd::recorded
