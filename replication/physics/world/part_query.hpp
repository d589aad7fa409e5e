#pragma once
#include <algorithm>
#include <cstdint>
#include <span>

#include "collision/contact/contact_time.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/composed_motion.hpp"
#include "replication/physics/world/flexible_parts.hpp"

namespace peerd::replication {

class TickDetection;

// A part of an end of an interest, and what moves it in the frame in which it is to meet others: a rigid body, or a
// flexible part, whose chain is empty where nothing carries it.
struct MovingPart {
  Chain chain;
  const collision::Body* body = nullptr;
  FlexibleParts* flexible = nullptr;  // where there is no body
  std::uint32_t form = 0;             // in `flexible`
};

// Two sides that may meet: a part each, or for CollisionType::kBox all parts of two ends.
struct PartQuery {
  std::span<const MovingPart> a, b;
  CollisionType type = CollisionType::kWitness;
  collision::MeetAs as = collision::MeetAs::kSurfaces;
  TickDetection* detection = nullptr;  // finds contacts at ticks; none: contact times

  [[nodiscard]] bool is_flexible() const {
    const auto flexes = [](const MovingPart& part) { return part.flexible != nullptr; };
    return std::ranges::any_of(a, flexes) || std::ranges::any_of(b, flexes);
  }
};

// When two sides of a question first come to touch.
struct PartContact {
  collision::Contact contact;  // its normal is in the frame of the parts
  SimTime at;                  // the contact time, rounded down to a nanosecond
  KinematicState a, b;         // of the first part of each side, where the search began
};

// How coarse the pieces of composed motion are at first [m], and how fine where two parts come so near.
inline constexpr double kCoarseError_m = 1e-3, kFineError_m = 2.5e-7;

}  // namespace peerd::replication
