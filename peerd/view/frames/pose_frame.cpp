#include "peerd/view/frames/pose_frame.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <utility>

namespace peerd::view {
namespace {

static_assert(std::endian::native == std::endian::little, "rows go out as they are in memory");

// A row of no node: nothing has been sent.
constexpr std::uint32_t kNotSent = ~0U;

Pose composed(const Pose& above, const Pose& relative) {
  return {above * relative.position, (above.orientation * relative.orientation).normalized()};
}

Pose relative_to(const Pose& above, const Pose& pose) {
  const Quat back = above.orientation.conjugate();
  return {back * (pose.position - above.position), (back * pose.orientation).normalized()};
}

bool is_same(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

bool is_near(const PoseRow& row, const PoseStream::Near& near) {
  const Vec3 at(row.position[0], row.position[1], row.position[2]);
  return (at - near.center_m).squaredNorm() <= near.radius_m * near.radius_m;
}

template <class T>
std::byte* put(std::byte* at, const T& value) {
  std::memcpy(at, &value, sizeof value);
  return at + sizeof value;
}

}  // namespace

// Rows are compared by their bits: a threshold that is no number is equal to another one.
bool operator==(const PoseRow& a, const PoseRow& b) {
  return std::memcmp(&a, &b, kPoseRow_bytes) == 0;  // NOLINT(bugprone-suspicious-memory-comparison): no padding
}
static_assert(sizeof(PoseRow) == 2 * sizeof(std::uint32_t) + 2 * sizeof(std::uint16_t) + sizeof(float) +
                                     3 * sizeof(double) + 4 * sizeof(float),
              "it has no padding");

Pose pose_of(const PoseRow& row) {
  const auto& q = row.orientation_xyzw;
  return {Vec3(row.position[0], row.position[1], row.position[2]), Quat(q[3], q[0], q[1], q[2])};
}

void set_pose(PoseRow& row, const Pose& pose) {
  for (int k = 0; k < 3; ++k) row.position[k] = pose.position[k];
  for (int k = 0; k < 4; ++k) row.orientation_xyzw[k] = static_cast<float>(pose.orientation.coeffs()[k]);
}

void PoseTable::reset(std::uint32_t revision, std::shared_ptr<const Scene> scene, Movers movers) {
  assert(scene && movers.above.size() == movers.ids.size() && movers.of_peer.size() == movers.ids.size());
  revision_ = revision;
  motion_.reset();
  file_ways_.clear();
  scene_ = std::move(scene);
  movers_ = std::move(movers);
  const std::size_t count = movers_.ids.size();
  shown_.clear();
  for (const ObjectId id : movers_.ids) shown_.push_back(scene_->rigid_pose(id));
  ghosts_ = shown_;
  carries_.assign(count, false);
  owners_.assign(count, kNobody);
  owners_revision_.reset();
  for (std::size_t i = 0; i < count; ++i) {
    if (movers_.above[i] != Movers::kNone) carries_[movers_.above[i]] = true;
    if (movers_.of_peer[i]) continue;
    if (!motion_) motion_.emplace(*scene_);
    add_file_way(static_cast<std::uint32_t>(i));
  }
  for (auto& rows : rows_) rows.clear();
}

void PoseTable::add_file_way(std::uint32_t mover) {
  FileWay& way = file_ways_.emplace_back();
  way.mover = mover;
  const std::uint32_t above = movers_.above[mover];
  const auto end = above == Movers::kNone ? std::nullopt : std::optional(movers_.ids[above]);
  std::vector<ObjectId> path;
  for (std::optional<ObjectId> id = movers_.ids[mover]; id && id != end; id = scene_->parent_of(*id)) {
    if (scene_->at(*id).kind == NodeKind::kTransform) path.push_back(*id);
  }
  for (auto id = path.rbegin(); id != path.rend(); ++id) {
    if (motion_->moves_in_parent(*id)) way.driven.emplace_back(static_cast<std::uint32_t>(way.fields.size()), *id);
    way.fields.push_back(scene_->transform(*id));
  }
  std::vector<TransformFields> to_above;
  for (std::optional<ObjectId> id = end; id; id = scene_->parent_of(*id)) {
    if (scene_->at(*id).kind == NodeKind::kTransform) to_above.push_back(scene_->transform(*id));
  }
  std::ranges::reverse(to_above);
  way.stretch = stretched_pose(to_above).stretch;
}

Pose PoseTable::relative_pose(FileWay& way, double world_s) {
  for (const auto& [at, id] : way.driven) way.fields[at] = motion_->transform(id, world_s);
  return rigid_pose(way.stretch, way.fields);
}

void PoseTable::follow_owners(const replication::Peer& peer) {
  if (std::exchange(owners_revision_, peer.owners().revision()) == peer.owners().revision()) return;
  for (std::size_t i = 0; i < movers_.ids.size(); ++i) {
    owners_[i] = movers_.of_peer[i] ? peer.owner(movers_.ids[i]) : kNobody;
  }
}

// A mover that nobody owns stands in the frame of the one above as the ghosts have it, and is drawn there: if the one
// above is drawn elsewhere than its ghost, what it carries goes with it.
void PoseTable::place(PeerNode& node, HostTime now) {
  const replication::Peer& peer = node.peer();
  at_ = node.advance_view(now, at_);
  times_ = {};
  if (!at_) return;
  const SimTime t = *at_;
  const auto zero = peer.world_zero();
  times_.session_s = to_seconds(t.time_since_epoch());
  // With a bounded latency all is shown as it was, what the world moves by itself too.
  const std::optional<Duration> bound = node.bound(t);
  if (zero) times_.world_s = to_seconds(t - bound.value_or(Duration{0}) - *zero);
  if (const auto start = node.start()) times_.since_start_s = to_seconds(t - *start);
  const double world_s = zero ? times_.world_s : -1.0;
  follow_owners(peer);
  auto way = file_ways_.begin();
  for (std::size_t i = 0; i < movers_.ids.size(); ++i) {
    const ObjectId id = movers_.ids[i];
    const std::uint32_t above = movers_.above[i];
    if (!movers_.of_peer[i]) {
      assert(way->mover == i);
      const Pose relative = relative_pose(*way++, world_s);
      shown_[i] = above == Movers::kNone ? relative : composed(shown_[above], relative);
      ghosts_[i] = above == Movers::kNone ? relative : composed(ghosts_[above], relative);
      continue;
    }
    const bool goes_along =
        !bound && above != Movers::kNone && !is_same(shown_[above], ghosts_[above]) && owners_[i] == kNobody;
    if (carries_[i] || goes_along) ghosts_[i] = peer.ghost(id, t).pose();
    shown_[i] = goes_along ? composed(shown_[above], relative_to(ghosts_[above], ghosts_[i])) : node.shown(id, t);
  }
}

void PoseTable::refresh(PeerNode& node, HostTime now, PoseKinds kinds) {
  place(node, now);
  for (auto& rows : rows_) rows.clear();
  if (!at_) return;
  const replication::Peer& peer = node.peer();
  const auto asked = [&](PoseKind kind) { return (kinds & set_of(kind)) != 0; };
  for (std::size_t i = 0; i < movers_.ids.size(); ++i) {
    const ObjectId id = movers_.ids[i];
    const PeerId owner = owners_[i];
    const bool own = owner == peer.id();
    PoseRow row;
    row.node = static_cast<std::uint32_t>(i);
    row.owner = owner.value;
    if (own) {
      row.flags = node.drives(id) ? kOwn | kDriven : kOwn;
      if (const auto threshold_m = peer.threshold_m(id)) row.threshold_m = static_cast<float>(*threshold_m);
    } else if (owner != kNobody) {
      if (!peer.receives(id)) row.flags |= kNotReceived;
      if (!peer.members().contains(owner)) row.flags |= kOrphaned;
    }
    if (peer.ghost_difference_m(id, now)) row.flags |= kDiffers;
    if (asked(PoseKind::kShown)) add_row(PoseKind::kShown, row, shown_[i]);
    if (owner == kNobody) continue;
    if (own && asked(PoseKind::kTruth)) add_row(PoseKind::kTruth, row, peer.truth(id, *at_).pose());
    if (asked(PoseKind::kGhost)) add_row(PoseKind::kGhost, row, peer.ghost(id, *at_).pose());
  }
}

void PoseTable::add_row(PoseKind kind, const PoseRow& like, const Pose& pose) {
  PoseRow& row = rows_[static_cast<std::size_t>(kind)].emplace_back(like);
  row.kind = static_cast<std::uint16_t>(kind);
  set_pose(row, pose);
}

void PoseStream::watch(const Watch& watch) {
  watch_ = watch;
  for (auto& sent : sent_) sent.clear();
  looks_.restart();
}

std::span<const std::byte> PoseStream::next(const PoseTable& table, const view::LookTable* looks) {
  if (std::exchange(revision_, table.revision()) != table.revision()) {
    for (auto& sent : sent_) sent.clear();
  }
  const auto is_watched = [&](std::size_t kind) { return (watch_.kinds & set_of(static_cast<PoseKind>(kind))) != 0; };
  std::size_t most = 0;
  for (std::size_t k = 0; k < kPoseKinds; ++k) {
    if (is_watched(k)) most += table.rows(static_cast<PoseKind>(k)).size();
  }
  frame_.resize(kPoseFrameHeader_bytes + most * kPoseRow_bytes);
  std::byte* end = frame_.data() + kPoseFrameHeader_bytes;
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < kPoseKinds; ++k) {
    const auto kind = static_cast<PoseKind>(k);
    if (!is_watched(k)) continue;
    std::vector<PoseRow>& sent = sent_[k];
    if (sent.size() != table.node_count()) sent.assign(table.node_count(), PoseRow{.node = kNotSent});
    for (const PoseRow& row : table.rows(kind)) {
      if (row == sent[row.node] || (watch_.near && !is_near(row, *watch_.near))) continue;
      sent[row.node] = row;
      ++count;
      end = put(end, row);
    }
  }
  frame_.resize(static_cast<std::size_t>(end - frame_.data()));
  const PoseTable::Times& times = table.times();
  std::byte* at = put(frame_.data(), kPoseFrameMagic);
  at = put(at, count);
  at = put(at, times.session_s);
  at = put(at, times.world_s);
  at = put(at, times.since_start_s);
  at = put(at, table.revision());
  at = put(at, static_cast<std::uint32_t>(kPoseRow_bytes));
  assert(at == frame_.data() + kPoseFrameHeader_bytes);
  if (looks != nullptr && watch_.looks) looks_.append(*looks, frame_);
  return frame_;
}

}  // namespace peerd::view
