#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/recorded/recording.hpp"
#include "peerd/lab/recorded/view_recorder.hpp"
#include "peerd/lab/sim/simulation.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "peerd/peer/record/rerun.hpp"

namespace peerd::recorded {

// How a recording is made.
struct Recorder {
  std::uint32_t hz = 30;
  std::size_t most_bytes = std::size_t{512} << 20;  // what does not fit any more is left out, and a note says so
  sim::Progress progress{};
  SceneWatch on_scene{};
};

// The note that a recording has no more than so many seconds, as no more fits.
[[nodiscard]] std::string note_of_missing(double last_s, const Recorder& how);

// One run of a simulation's output folder, read and ready to be made once more.
struct ReadRun {
  record::Rerun rerun;
  config::Scenario scenario;  // of that run alone
  std::unique_ptr<const SharedWorld> shared;
  std::string summary;     // the text of summary.json
  std::size_t number = 0;  // the run's, from 0
};

// `number`: of the run, from 1. The error says what the folder is, and what to do.
[[nodiscard]] Result<ReadRun> read_run(const std::filesystem::path& folder, std::size_t number);

// Makes the run once more, with a view of each peer. A note says where it is not as the folder's summary has it.
[[nodiscard]] Result<Recording> record_run(const ReadRun& run, const Recorder& how);

}  // namespace peerd::recorded
