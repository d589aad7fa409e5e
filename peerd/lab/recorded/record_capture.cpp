#include "peerd/lab/recorded/record_capture.hpp"

#include <span>
#include <string>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/text_file.hpp"
#include "peerd/lab/recorded/replay.hpp"
#include "peerd/lab/recorded/view_recorder.hpp"
#include "replication/settings/output/tick_grid.hpp"

namespace peerd::recorded {
namespace {

// Keeps what the peer has in view at instants of its own clock, from the capture's begin.
class CaptureRecorder final : public ReplayWatch {
 public:
  CaptureRecorder(PeerNode& node, const std::filesystem::path& world, HostTime begin, const Recorder& how)
      : node_(node),
        how_(how),
        begin_(begin),
        view_(node.peer().id(), node.name(), world.filename().string(),
              view::images_of(local_files(view::kImage_bytes), world.string()), ViewRecorder::ErrorsOf::kOwn,
              how.on_scene) {}

  void before(HostTime at) override {
    for (; !full_; ++next_) {
      const Duration since = replication::TickGrid(how_.hz).time_of(next_).time_since_epoch();
      if (begin_ + since > at) return;
      view_.look(node_, begin_ + since);
      Truths own;
      view_.add_own(own);
      last_s_ = to_seconds(since);
      view_.keep(last_s_, own);
      full_ = view_.size_bytes() > how_.most_bytes;
    }
  }

  // Session time is the host's, shifted by what the peer has agreed on.
  void on_output(HostTime at, const replication::Output& output) override {
    if (full_ || !node_.peer().clock().synchronised()) return;
    view_.note(to_seconds(at - begin_), output, node_, node_.peer().clock().to_session(begin_));
  }
  void on_line(HostTime /*at*/, const LogLine& /*line*/) override {}

  void finish(Recording& recording) {
    recording.rows = view_.rows();
    recording.views.push_back(view_.finish());
    recording.end_s = last_s_;
    if (full_) recording.notes.push_back(note_of_missing(last_s_, how_));
  }

 private:
  PeerNode& node_;
  const Recorder& how_;
  HostTime begin_;
  ViewRecorder view_;
  std::int64_t next_ = 0;  // instant
  double last_s_ = 0;
  bool full_ = false;
};

}  // namespace

Result<Recording> record_capture(const CaptureFile& file, const Recorder& how) {
  const auto bytes = read_text_file(file.path, {file.size_max_mib * kMiB, "--size-max allows more"});
  if (!bytes) return std::unexpected(bytes.error());
  const auto unreadable = [&](const std::string& why) {
    return std::unexpected(InputError{file.path.string() + ": error: " + why, kFinding});
  };
  auto capture = record::CaptureReader::open(std::as_bytes(std::span(*bytes)));
  if (!capture) return unreadable(capture.error());
  const auto recorded = make_recorded_peer(capture->setup(), record::signatures_in(std::as_bytes(std::span(*bytes))),
                                           file.path, file.world);
  if (!recorded) return std::unexpected(recorded.error());
  PeerNode& node = *recorded->node;
  CaptureRecorder recorder(node, recorded->world, capture->begin(), how);
  const auto outcome = Replay(*recorded, *capture, &recorder).run();
  if (!outcome) return unreadable(outcome.error().text);
  recorder.before(outcome->end);
  Recording recording{.kind = Recording::Kind::kCapture,
                      .name = file.path.filename().string(),
                      .title = "capture of peer " + node.name(),
                      .world = recorded->world.filename().string(),
                      .hz = how.hz};
  recorder.finish(recording);
  for (const config::PeerSettings& peer : recorded->run.peers) recording.peers.emplace_back(PeerId{peer.id}, peer.name);
  if (const auto& d = outcome->difference) {
    recording.notes.push_back(
        fmt::format("the peer does something else than it did, {:.3f} s after its begin, so it "
                    "ends there: {}",
                    to_seconds(d->at - capture->begin()), d->what));
  }
  if (capture->cut_off()) recording.notes.emplace_back("the capture ends in the middle of a packet");
  return recording;
}

Result<Recording> record(const CaptureFile& what, std::uint64_t run, const Recorder& how) {
  if (!std::filesystem::is_directory(what.path)) return record_capture(what, how);
  const auto read = read_run(what.path, run);
  if (!read) return std::unexpected(read.error());
  return record_run(*read, how);
}

}  // namespace peerd::recorded
