#pragma once
#include "tests/sim/chance.hpp"
#include "tests/sim/living/world.hpp"

namespace peerd::living {

// A number of the file: what is drawn is rounded to binary32 at once, so that the text says it exactly.
[[nodiscard]] float draw(sim::testing_support::Chance& chance, double low, double high);

// A form some `size_m` wide: a primitive, a prism over an L or a U, an arrow, an open box, a tetrahedron, a fan. None
// of them bends.
[[nodiscard]] Form make_form(sim::testing_support::Chance& chance, double size_m);
// A sheet, or a tetrahedron, whose points move by up to some third of `size_m` between the keys of a path of `clock`.
[[nodiscard]] Form make_bending_form(sim::testing_support::Chance& chance, double size_m, int clock, double cycle_s);

// The keys of a path of `segments` pieces, none of them shorter than 0.1 s if the cycle has so much for each.
[[nodiscard]] std::vector<float> make_keys(sim::testing_support::Chance& chance, std::size_t segments, double cycle_s);

}  // namespace peerd::living
