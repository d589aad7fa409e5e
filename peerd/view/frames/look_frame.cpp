#include "peerd/view/frames/look_frame.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <utility>
#include <variant>

namespace peerd::view {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers go out as they are in memory");

template <class T>
void put(std::vector<std::byte>& out, const T& value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

// The nearest mover at or above an instance; none: it stands.
std::optional<ObjectId> mover_above(const Scene& scene, std::span<const ObjectId> sorted, ObjectId id) {
  for (std::optional<ObjectId> at = id; at; at = scene.parent_of(*at)) {
    if (std::ranges::binary_search(sorted, *at)) return at;
  }
  return std::nullopt;
}

}  // namespace

void LookTable::reset(std::shared_ptr<const Scene> scene, std::span<const ObjectId> movers) {
  assert(scene != nullptr);
  shapes_.clear();
  motion_.reset();
  records_.clear();
  scene_ = std::move(scene);
  refreshed_at_.reset();
  ++resets_;
  if (scene_->document == nullptr || scene_->document->routes.empty()) return;  // nothing drives anything
  looks_.emplace(scene_->document);
  motion_.emplace(*scene_);
  forms_ = moving_forms(*scene_, *motion_, Carriers(*scene_, *motion_, {}));
  std::vector<ObjectId> sorted(movers.begin(), movers.end());
  std::ranges::sort(sorted);
  for (const ObjectId shape : forms_.shapes) {
    shapes_.emplace_back(*scene_, *motion_, shape, mover_above(*scene_, sorted, shape));
  }
  const auto add = [&](LookKind kind, std::size_t count) {
    for (std::uint32_t i = 0; i < count; ++i) records_.push_back({kind, i});
  };
  add(LookKind::kPoints, forms_.geometries.size());
  add(LookKind::kPlace, forms_.shapes.size());
  add(LookKind::kValue, looks_->count());
  if (forms_.geometries.empty() && forms_.shapes.empty()) motion_.reset();
}

void LookTable::fill(const Record& record, double world_s) {
  next_.clear();
  switch (record.kind) {
    case LookKind::kPoints: {
      const Geometry form = motion_->geometry(forms_.geometries[record.number], world_s);
      const auto& points = std::get<FaceSetGeometry>(form).points;
      next_.reserve(3 * points.size());
      for (const Eigen::Vector3f& p : points) next_.insert(next_.end(), {p.x(), p.y(), p.z()});
      break;
    }
    case LookKind::kPlace: {
      const Affine at = shapes_[record.number].carrier_from_shape(*motion_, world_s);
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) next_.push_back(static_cast<float>(at.linear(row, column)));
        next_.push_back(static_cast<float>(at.offset[row]));
      }
      break;
    }
    case LookKind::kValue:
      looks_->value(record.number, world_s, next_);
      break;
  }
}

void LookTable::refresh(HostTime now, double world_s) {
  if (records_.empty() || (refreshed_at_ && now - *refreshed_at_ < kRefresh)) return;
  refreshed_at_ = now;
  for (Record& record : records_) {
    fill(record, world_s);
    if (record.version > 0 && std::ranges::equal(next_, record.values)) continue;
    record.values = next_;
    ++record.version;
  }
}

void LookStream::append(const LookTable& table, std::vector<std::byte>& frame) {
  const auto& records = table.records();
  if (std::exchange(resets_, table.resets()) != table.resets() || sent_.size() != records.size()) {
    sent_.assign(records.size(), 0);
    first_ = 0;
  }
  put(frame, kLookMagic);
  const std::size_t count_at = frame.size();
  put(frame, std::uint32_t{0});
  std::uint32_t count = 0;
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::size_t at = (first_ + i) % records.size();
    const LookTable::Record& record = records[at];
    if (record.version == sent_[at]) continue;
    const std::size_t size = kLookRecord_bytes + record.values.size() * sizeof(float);
    if (count > 0 && bytes + size > kFrame_bytes) {
      first_ = at;
      break;
    }
    put(frame, record.kind);
    put(frame, record.number);
    put(frame, static_cast<std::uint32_t>(record.values.size()));
    put(frame, std::uint32_t{0});
    const std::size_t begin = frame.size();
    frame.resize(begin + record.values.size() * sizeof(float));
    if (!record.values.empty()) std::memcpy(frame.data() + begin, record.values.data(), frame.size() - begin);
    sent_[at] = record.version;
    bytes += size;
    ++count;
  }
  std::memcpy(frame.data() + count_at, &count, sizeof count);
}

}  // namespace peerd::view
