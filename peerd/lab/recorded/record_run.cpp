#include "peerd/lab/recorded/record_run.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/recorded/view_recorder.hpp"
#include "peerd/lab/sim/simulated_run.hpp"
#include "peerd/peer/config/resolve.hpp"

namespace peerd::recorded {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr SizeLimit kSummary{256 * kMiB, "no summary is so long; is this one?", 2};

// Sees all peers of a run and keeps what each has in view. The truth of an object is its owner's: of one that a motion
// drives, that motion at the owner's session time, as the report has it.
class RunRecorder final : public sim::PeersWatch {
 public:
  RunRecorder(const ReadRun& run, const Recorder& how, const std::vector<config::PeerObjects>& objects) : how_(how) {
    const config::RunSettings& settings = run.scenario.runs.front();
    const std::string world = run.rerun.world.filename().string();
    const auto images = view::images_of(local_files(view::kImage_bytes), run.rerun.world.string());
    for (std::size_t i = 0; i < settings.peers.size(); ++i) {
      views_.emplace_back(PeerId{settings.peers[i].id}, settings.peers[i].name, world, images,
                          ViewRecorder::ErrorsOf::kOthers, how.on_scene);
      index_of_[PeerId{settings.peers[i].id}] = i;
      for (const auto& [id, motion] : objects[i].motions) motions_.emplace(id, &motion);
    }
  }

  [[nodiscard]] std::uint32_t rate_hz() const override { return how_.hz; }
  void begin(SimTime start, HostTime true_at) override {
    start_ = start;
    begun_at_ = true_at;
  }

  void see(double t_s, std::span<const sim::SeenPeer> peers) override {
    if (full_) return;
    Truths truths;
    for (std::size_t i = 0; i < peers.size(); ++i) {
      if (peers[i].node == nullptr) continue;
      views_[i].look(*peers[i].node, peers[i].host);
      Truths own;
      views_[i].add_own(own);
      for (auto& [id, truth] : own) {
        const auto motion = motions_.find(id);
        if (motion != motions_.end() && peers[i].node->drives(id)) {
          const SimTime now = peers[i].node->peer().clock().to_session(peers[i].host);
          truth.pose = motion->second->pose(to_seconds(now - *start_));
        }
        truths.insert_or_assign(id, truth);
      }
    }
    for (std::size_t i = 0; i < peers.size(); ++i) {
      if (peers[i].node == nullptr) {
        views_[i].leave_out();
      } else {
        views_[i].keep(t_s, truths);
      }
    }
    last_s_ = t_s;
    std::size_t bytes = 0;
    for (const ViewRecorder& view : views_) bytes += view.size_bytes();
    full_ = bytes > how_.most_bytes;
  }

  void note(HostTime true_now, const PeerNode& node, const replication::Output& output) {
    if (full_ || !start_ || true_now < begun_at_) return;
    views_[index_of_.at(node.peer().id())].note(to_seconds(true_now - begun_at_), output, node, *start_);
  }

  void finish(Recording& recording) {
    for (ViewRecorder& view : views_) {
      recording.rows += view.rows();
      recording.views.push_back(view.finish());
    }
    recording.end_s = last_s_;
    if (full_) recording.notes.push_back(note_of_missing(last_s_, how_));
  }

 private:
  const Recorder& how_;
  std::deque<ViewRecorder> views_;  // by the run's order of peers
  std::map<PeerId, std::size_t> index_of_;
  std::map<ObjectId, const motion::MotionSource*> motions_;
  std::optional<SimTime> start_;
  HostTime begun_at_{};
  double last_s_ = 0;
  bool full_ = false;
};

InputError error_of(const fs::path& folder, const std::string& why, int exit_code = 2) {
  return {"error: " + folder.string() + ": " + why, exit_code};
}

// Both must have the same of these. Outcomes that were compared with those of another run are not computed again.
bool is_same_run(const Json& a, const Json& b) {
  for (const char* const member : {"seed", "traffic", "objects"}) {
    if (a.value(member, Json()) != b.value(member, Json())) return false;
  }
  Json of_a = a.value("collisions", Json::object()), of_b = b.value("collisions", Json::object());
  of_a.erase("wrong");
  of_b.erase("wrong");
  return of_a == of_b;
}

// Empty where the run is as the folder's summary has it.
std::string difference(const ReadRun& run, const measure::RunRecord& record) {
  const measure::ScenarioInfo info{run.rerun.name, "sim", run.scenario.seed, {}};
  const Json now = measure::summarise(info, std::span(&record, 1));
  const Json then = Json::parse(run.summary, nullptr, false);
  if (then.is_object() && then.contains("runs") && run.number < then["runs"].size() &&
      is_same_run(now["runs"][0], then["runs"][run.number])) {
    return "";
  }
  return "what is shown is not what the report says: the program, or a file that the scenario reads, is another one "
         "since; simulate it again with peerd sim";
}

std::string title_of(const ReadRun& run) {
  const config::RunSettings& settings = run.scenario.runs.front();
  std::string title = "simulated run";
  if (const std::size_t runs = run.rerun.configurations.size(); runs > 1) {
    title += fmt::format(" {} of {}", run.number + 1, runs);
  }
  return title + fmt::format(", seed {}", settings.seed);
}

}  // namespace

std::string note_of_missing(double last_s, const Recorder& how) {
  constexpr const char* kSentence =
      "only the first {:.3g} s are here, for more does not fit into {} MiB: --memory allows more, a lower --hz needs "
      "less";
  return fmt::format(kSentence, last_s, how.most_bytes / kMiB);
}

Result<ReadRun> read_run(const fs::path& folder, std::size_t number) {
  ReadRun run;
  std::error_code none;
  if (!fs::exists(folder / "summary.json", none)) {
    return std::unexpected(error_of(folder, "it is no output folder of peerd sim: it has no summary.json"));
  }
  auto summary = read_text_file(folder / "summary.json", kSummary);
  if (!summary) return std::unexpected(summary.error());
  run.summary = *std::move(summary);
  const auto parsed = json_if_valid(run.summary);
  if (!parsed.is_object()) return std::unexpected(error_of(folder, "its summary.json can't be read", 1));
  if (parsed.value("mode", "") != "sim") {
    return std::unexpected(error_of(folder,
                                    "real processes have made this run, and a report does not keep what they saw; "
                                    "record a peer with peerd record, and view its capture"));
  }
  if (!fs::exists(folder / record::kRerunFile, none)) {
    return std::unexpected(error_of(folder, std::string("an older peerd has made this run: it has no ") +
                                                record::kRerunFile + "; simulate it again with peerd sim"));
  }
  const auto text = read_text_file(folder / record::kRerunFile, kSummary);
  if (!text) return std::unexpected(text.error());
  auto rerun = record::rerun_from(*text);
  if (!rerun) return std::unexpected(error_of(folder / record::kRerunFile, rerun.error(), 1));
  run.rerun = *std::move(rerun);
  if (number < 1 || number > run.rerun.configurations.size()) {
    return std::unexpected(
        error_of(folder, fmt::format("--run: it has runs 1 to {}", run.rerun.configurations.size())));
  }
  run.number = number - 1;
  config::ScenarioRequest request;
  request.file = run.rerun.file;
  request.text = run.rerun.configurations[run.number];
  request.sweep = false;
  auto scenario = config::read_scenario(request);
  if (!scenario) return std::unexpected(scenario.error());
  run.scenario = *std::move(scenario);
  auto shared = share_world(run.rerun.world, run.rerun.reading, run.scenario.runs);
  if (!shared) return std::unexpected(shared.error());
  run.shared = *std::move(shared);
  if (run.shared->world.hash != run.rerun.world_hash) {
    return std::unexpected(
        error_of(run.rerun.world, "it is not the world of that run any more; simulate it again with peerd sim", 1));
  }
  return run;
}

Result<Recording> record_run(const ReadRun& run, const Recorder& how) {
  config::RunSettings settings = run.scenario.runs.front();
  settings.compare_outcomes = false;  // that would be a second run, of which nothing is shown
  const auto objects = config::resolve(settings, run.shared->world.scene);
  if (!objects) return std::unexpected(objects.error());
  RunRecorder recorder(run, how, *objects);
  const auto record = sim::simulated_run(
      settings, *run.shared,
      [&](HostTime now, const PeerNode& node, const replication::Output& output) { recorder.note(now, node, output); },
      {}, nullptr, {.limits = {0, 0, 0}, .parts = {}}, how.progress, &recorder);
  if (!record) return std::unexpected(record.error());
  Recording recording{.kind = Recording::Kind::kRun,
                      .name = run.rerun.name,
                      .title = title_of(run),
                      .world = run.rerun.world.filename().string(),
                      .hz = how.hz};
  recorder.finish(recording);
  for (const config::PeerSettings& peer : settings.peers) recording.peers.emplace_back(PeerId{peer.id}, peer.name);
  for (const config::ScenarioEvent& event : settings.events) recording.happenings.emplace_back(event.at_s, event.name);
  if (record->stopped) {
    recording.notes.push_back(fmt::format("the run was stopped at {:.3g} s", record->duration_s));
  } else if (const std::string other = difference(run, *record); !other.empty()) {
    recording.notes.push_back(other);
  }
  return recording;
}

}  // namespace peerd::recorded
