#include "replication/physics/world/tick_detection.hpp"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include "core/transform.hpp"

namespace peerd::replication {
namespace {

constexpr std::int64_t kNanosecondsOfASecond = 1'000'000'000;
constexpr std::size_t kSoupsMax = 4096;

KinematicState state_at(const MovingPart& part, SimTime t) {
  return part.chain.empty() ? KinematicState{} : composed_at(part.chain, t);
}

// The middle of the body in the frame of the parts.
Vec3 middle_of(const collision::Body& body, const KinematicState& state) {
  return state.position + multiply(Mat3(state.orientation.toRotationMatrix()), body.center);
}

// A polygon of the collidee that is met, and its normal on the side of the collider.
struct Met {
  std::uint32_t polygon = 0;
  Vec3 normal;
};

// PolygonChoice finds the pair that a contact is of: the first, in their order, whose collidee's polygon faces the
// middle of the collider, and towards which that moves where the two answer each other. Where no polygon faces it, the
// first polygon counts behind which it is. So a body that has been answered leaves, and does not meet the sides around
// it.
class PolygonChoice {
 public:
  PolygonChoice(const PartQuery& query, const KinematicState& a, const KinematicState& b)
      : soup_(query.b.front().body->surface->soup()),
        surface_(*query.b.front().body->surface),
        place_(b.position),
        rotation_(b.orientation.toRotationMatrix()),
        middle_(middle_of(*query.a.front().body, a)),
        middle_b_(middle_of(*query.b.front().body, b)),
        velocity_(a.velocity - b.velocity),
        must_approach_(query.as != collision::MeetAs::kPolygons) {}

  [[nodiscard]] std::optional<Met> of(std::span<const collision::PolygonPair> pairs) const {
    std::optional<Met> behind;
    bool in_front = false;
    for (const collision::PolygonPair& pair : pairs) {
      const Vec3 n = normal_of(pair.b);
      const bool faces = n.dot(middle_ - corner_of(pair.b)) >= 0.0;
      Met met{pair.b, faces ? n : Vec3(-n)};
      in_front = in_front || faces;
      if (must_approach_ && !(met.normal.dot(velocity_) < -kParallel * velocity_.norm())) continue;
      if (faces) return met;
      if (!behind) behind = met;
    }
    return in_front ? std::nullopt : behind;
  }

 private:
  static constexpr double kParallel = 0x1p-30;  // the sine of an angle that may be rounding

  // A polygon without an area has the direction between the middles of the two bodies as its normal.
  [[nodiscard]] Vec3 normal_of(std::uint32_t polygon) const {
    if (const auto normal = surface_.normal(polygon)) return multiply(rotation_, *normal);
    const Vec3 apart = middle_ - middle_b_;
    return apart.norm() > 0.0 ? Vec3(apart.normalized()) : Vec3::UnitY();
  }
  [[nodiscard]] Vec3 corner_of(std::uint32_t polygon) const {
    const auto face = std::ranges::lower_bound(soup_.faces, polygon, {}, &collision::TriangleSoup::Face::polygon);
    assert(face != soup_.faces.end() && face->polygon == polygon);
    return place_ + multiply(rotation_, soup_.vertices[face->corners[0]]);
  }

  const collision::TriangleSoup& soup_;
  const collision::Surface& surface_;
  Vec3 place_;
  Mat3 rotation_;
  Vec3 middle_, middle_b_, velocity_;
  bool must_approach_;
};

bool has_polygons(std::span<const MovingPart> side) {
  return side.size() == 1 && side.front().body != nullptr && side.front().body->surface != nullptr &&
         !side.front().body->surface->soup().faces.empty();
}

}  // namespace

TickDetection::TickDetection(std::unique_ptr<collision::NarrowPhase> engine, std::uint32_t hz)
    : engine_(std::move(engine)), hz_(hz) {
  assert(engine_ != nullptr && hz > 0 && hz <= kNanosecondsOfASecond);
}

bool TickDetection::answers(const PartQuery& query) {
  return query.type != CollisionType::kBox && !query.is_flexible() && has_polygons(query.a) && has_polygons(query.b);
}

// Tick k of a second is at k / hz, rounded down to a nanosecond.
SimTime TickDetection::last_tick_until(SimTime t) const {
  const SimTime second = floor_to(t, std::chrono::seconds(1));
  const std::int64_t number = (((t - second).count() + 1) * hz_ - 1) / kNanosecondsOfASecond;
  return second + Duration{number * kNanosecondsOfASecond / hz_};
}

SimTime TickDetection::next_tick_after(SimTime t) const {
  const SimTime second = floor_to(t, std::chrono::seconds(1));
  const std::int64_t number = (((t - second).count() + 1) * hz_ - 1) / kNanosecondsOfASecond + 1;
  return second + Duration{number * kNanosecondsOfASecond / hz_};
}

collision::NumberedSoup TickDetection::numbered(const std::shared_ptr<collision::Surface>& surface) {
  if (numbers_.size() >= kSoupsMax) {
    std::erase_if(numbers_, [](const auto& each) { return each.first.expired(); });
  }
  const auto [at, is_new] = numbers_.try_emplace(surface, last_number_ + 1);
  if (is_new) ++last_number_;
  return {at->second, &surface->soup()};
}

std::vector<collision::PolygonPair> TickDetection::pairs(const PartQuery& query, const KinematicState& a,
                                                         const KinematicState& b) {
  collision::NumberedSoup soup_a = numbered(query.a.front().body->surface);
  collision::NumberedSoup soup_b = numbered(query.b.front().body->surface);
  soup_a.pose = a.pose();  // of parts that one carrier moves, in its frame
  soup_b.pose = b.pose();
  return engine_->all_pairs(soup_a, soup_b, collision::RelativeMotion(a.pose(), b.pose()));
}

PartContact TickDetection::first_contact(const PartQuery& query, SimTime from, SimTime until, std::uint64_t& searches) {
  assert(answers(query) && from < until);
  PartContact found;
  found.at = from;
  found.a = state_at(query.a.front(), from);
  found.b = state_at(query.b.front(), from);
  const SimTime last = last_tick_until(from);
  for (SimTime t = last == from ? from : next_tick_after(from); t < until; t = next_tick_after(t)) {
    const KinematicState a = state_at(query.a.front(), t), b = state_at(query.b.front(), t);
    ++searches;
    const auto met = PolygonChoice(query, a, b).of(pairs(query, a, b));
    if (!met) continue;
    const ShapePolygon polygon = query.b.front().body->surface->polygon(met->polygon);
    found.contact.state = collision::ContactState::kContact;
    found.contact.time_s = to_seconds(t - from);
    found.contact.normal_world = found.contact.separating_normal_world = met->normal;
    found.contact.collidee_shape = polygon.shape;
    found.contact.collidee_polygon = polygon.polygon;
    found.at = t;
    return found;
  }
  return found;
}

bool TickDetection::touch(const PartQuery& query, SimTime t) {
  assert(answers(query));
  const SimTime tick = last_tick_until(t);
  return !pairs(query, state_at(query.a.front(), tick), state_at(query.b.front(), tick)).empty();
}

}  // namespace peerd::replication
