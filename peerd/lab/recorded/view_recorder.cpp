#include "peerd/lab/recorded/view_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/input/compression.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/peer/control/event_line.hpp"
#include "peerd/view/picture/gltf_writer.hpp"
#include "peerd/view/picture/scene_picture.hpp"

namespace peerd::recorded {
namespace {

using view::PoseKind;
using view::PoseRow;

constexpr view::PoseKinds kAllKinds =
    view::set_of(PoseKind::kShown) | view::set_of(PoseKind::kTruth) | view::set_of(PoseKind::kGhost);
constexpr float kNotKnown = std::numeric_limits<float>::quiet_NaN();

}  // namespace

ViewRecorder::ViewRecorder(PeerId peer, std::string name, std::string world, view::ImageLoader load_image,
                           ErrorsOf errors_of, SceneWatch on_scene)
    : view_{.peer = peer, .name = std::move(name), .scenes = {}, .stretches = {}, .events = {}, .errors = {}},
      errors_of_(errors_of),
      world_(std::move(world)),
      load_image_(std::move(load_image)),
      on_scene_(std::move(on_scene)) {}

void ViewRecorder::look(PeerNode& node, HostTime now) {
  if (picture_ == nullptr) picture_ = std::make_unique<view::LivePicture>(world_, load_image_);
  if (picture_->follow(node)) {
    scene_ = picture_->input(node, now);
    scene_->revision = revision();
  }
  picture_->refresh(node, now, kAllKinds);
}

void ViewRecorder::add_own(Truths& truths) const {
  for (const PoseRow& row : picture_->poses().rows(PoseKind::kTruth)) {
    truths.insert_or_assign(picture_->movers().ids[row.node], Truth{pose_of(row), view_.peer});
  }
}

void ViewRecorder::keep(double t_s, const Truths& truths) {
  if (scene_) keep_scene(t_s);
  const view::PoseTable& poses = picture_->poses();
  const std::vector<ObjectId>& ids = picture_->movers().ids;
  rows_.clear();
  if (!std::isfinite(poses.times().session_s)) return add_unknown();  // it is in no session yet
  for (const PoseKind kind : {PoseKind::kShown, PoseKind::kGhost}) {
    rows_.insert(rows_.end(), poses.rows(kind).begin(), poses.rows(kind).end());
  }
  for (std::uint32_t node = 0; node < ids.size(); ++node) {
    if (const auto truth = truths.find(ids[node]); truth != truths.end()) {
      rows_.push_back(truth_row(node, truth->second));
    }
  }
  stretches_.add(t_s, revision(), ids.size(), poses.times(), rows_);
  keep_errors(truths);
  ++instants_;
}

void ViewRecorder::leave_out() {
  if (picture_ != nullptr) before_ = revision();
  picture_.reset();
  scene_.reset();
  stretches_.interrupt();
  add_unknown();
}

void ViewRecorder::add_unknown() {
  view_.errors.mean_m.push_back(kNotKnown);
  view_.errors.largest_m.push_back(kNotKnown);
  ++instants_;
}

PoseRow ViewRecorder::truth_row(std::uint32_t node, const Truth& truth) const {
  PoseRow row;
  row.node = node;
  row.owner = truth.owner.value;
  row.kind = static_cast<std::uint16_t>(PoseKind::kTruth);
  if (truth.owner == view_.peer) row.flags = view::kOwn;
  set_pose(row, truth.pose);
  return row;
}

void ViewRecorder::keep_scene(double t_s) {
  const view::ScenePicture drawn = view::picture_of(*std::exchange(scene_, std::nullopt));
  if (on_scene_) on_scene_(view_.peer, t_s, drawn);
  const auto glb = view::write_glb(drawn);
  SceneRevision& kept = view_.scenes.emplace_back();
  kept.revision = revision();
  kept.from_s = t_s;
  if (glb) {
    kept.size_bytes = glb->size();
    kept.glb = compress(*glb);
  } else {
    kept.why_not = glb.error();
  }
  for (std::size_t i = 0; i < drawn.nodes.size(); ++i) {
    if (drawn.nodes[i].id) kept.nodes.push_back({*drawn.nodes[i].id, drawn.node_paths[i]});
  }
  scene_bytes_ += recorded::size_bytes(kept);
}

// The ghost of an object of another peer is this peer's own; of its own ones it is what all others predict.
void ViewRecorder::keep_errors(const Truths& truths) {
  double sum_m = 0, largest_m = 0;
  std::size_t count = 0;
  for (const PoseRow& ghost : picture_->poses().rows(PoseKind::kGhost)) {
    const ObjectId id = picture_->movers().ids[ghost.node];
    const auto truth = truths.find(id);
    if (truth == truths.end()) continue;
    const double error_m = (pose_of(ghost).position - truth->second.pose.position).norm();
    auto& errors = view_.errors.of_object[id];
    other_bytes_ += (instants_ + 1 - errors.size()) * sizeof(float);
    errors.resize(instants_, kNotKnown);
    errors.push_back(static_cast<float>(error_m));
    if ((ghost.owner == view_.peer.value) != (errors_of_ == ErrorsOf::kOwn)) continue;
    sum_m += error_m;
    largest_m = std::max(largest_m, error_m);
    ++count;
  }
  view_.errors.mean_m.push_back(count > 0 ? static_cast<float>(sum_m / static_cast<double>(count)) : kNotKnown);
  view_.errors.largest_m.push_back(count > 0 ? static_cast<float>(largest_m) : kNotKnown);
  other_bytes_ += 2 * sizeof(float);
}

void ViewRecorder::note(double t_s, const replication::Output& output, const PeerNode& node, SimTime zero) {
  if (!control::kind_of(output)) return;
  auto event = parse_ordered_json(control::event_line(output, node));
  for (const char* const member : {"at_s", "known_at_s", "after_s"}) {
    const auto time = event.find(member);
    if (time != event.end()) *time = time->get<double>() - to_seconds(zero.time_since_epoch());
  }
  view_.events.push_back({t_s, json_line(event)});
  other_bytes_ += sizeof(RecordedEvent) + view_.events.back().line.size();
}

RecordedView ViewRecorder::finish() {
  view_.stretches = stretches_.finish();
  return std::move(view_);
}

}  // namespace peerd::recorded
