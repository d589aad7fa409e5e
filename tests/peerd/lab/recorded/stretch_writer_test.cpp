#include "peerd/lab/recorded/stretch_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "peerd/lab/recorded/stretch_reader.hpp"

namespace peerd::recorded::stretch_writer_test {

using testing::SizeIs;
using view::PoseKind;
using view::PoseRow;

constexpr std::size_t kNodes = 5;
constexpr double kHz = 30.0;
constexpr double kStep_m = 1.0 / 1'048'576.0;  // that places are kept in

PoseRow row_of(std::uint32_t node, PoseKind kind, std::uint32_t owner, double x) {
  PoseRow row{.node = node, .owner = owner, .kind = static_cast<std::uint16_t>(kind)};
  row.position[0] = x;
  return row;
}

using Key = std::pair<std::uint16_t, std::uint32_t>;  // kind, node
using State = std::map<Key, PoseRow>;

// A reader has that at each instant of a stretch, from its first frame on.
std::vector<std::pair<double, State>> read(const Stretch& stretch) {
  std::vector<std::pair<double, State>> states;
  State state;
  read_frames(stretch, [&](double t_s, std::span<const PoseRow> rows) {
    for (const PoseRow& row : rows) {
      if (row.owner == 0 && static_cast<PoseKind>(row.kind) != PoseKind::kShown) {
        state.erase({row.kind, row.node});
      } else {
        state[{row.kind, row.node}] = row;
      }
    }
    states.emplace_back(t_s, state);
  });
  return states;
}

// Random rows that come and go; each stretch alone must give what was there at each of its instants.
TEST(StretchWriter, EachStretchAloneHasAllInstantsOfItsTime) {
  std::mt19937 random(7);
  StretchWriter writer;
  std::vector<std::pair<double, State>> then;
  for (int i = 0; i < 200; ++i) {
    std::vector<PoseRow> rows;
    for (std::uint32_t node = 0; node < kNodes; ++node) {
      const double x = random() % 3 == 0 ? 1e-3 * static_cast<double>(random() % 1000) : 0.5;
      rows.push_back(row_of(node, PoseKind::kShown, node % 2, x));
      if (random() % 4 != 0) rows.push_back(row_of(node, PoseKind::kGhost, 1, 2 * x));
      if (random() % 4 != 0) rows.push_back(row_of(node, PoseKind::kTruth, 1, 3 * x));
    }
    writer.add(i / kHz, 1, kNodes, {}, rows);
    State state;
    for (const PoseRow& row : rows) state[{row.kind, row.node}] = row;
    then.emplace_back(i / kHz, state);
  }
  const std::vector<Stretch> stretches = writer.finish();
  ASSERT_THAT(stretches, SizeIs(4)) << "200 instants are 6.6 s";
  for (const Stretch& stretch : stretches) {
    std::size_t i = static_cast<std::size_t>(std::lround(stretch.from_s * kHz));
    const auto states = read(stretch);
    EXPECT_DOUBLE_EQ(states.back().first, stretch.until_s);
    for (const auto& [t_s, state] : states) {
      SCOPED_TRACE(t_s);
      ASSERT_LT(i, then.size());
      EXPECT_DOUBLE_EQ(t_s, then[i].first);
      ASSERT_EQ(state.size(), then[i].second.size());
      for (const auto& [key, row] : state) {
        const PoseRow& expected = then[i].second.at(key);
        EXPECT_EQ(row.owner, expected.owner);
        EXPECT_NEAR(row.position[0], expected.position[0], kStep_m / 2);
      }
      ++i;
    }
  }
}

TEST(StretchWriter, AnInstantIsInOneStretchAndBeginsTheNextOne) {
  StretchWriter writer;
  for (int i = 0; i <= 120; ++i) writer.add(i / kHz, 1, 1, {}, std::vector{row_of(0, PoseKind::kShown, 0, i)});
  const auto stretches = writer.finish();
  ASSERT_THAT(stretches, SizeIs(3));
  EXPECT_DOUBLE_EQ(stretches[0].until_s, stretches[1].from_s);
  EXPECT_DOUBLE_EQ(stretches[1].from_s, 2.0);
  EXPECT_DOUBLE_EQ(stretches[2].from_s, 4.0) << "the last instant alone";
}

TEST(StretchWriter, AnotherSceneBeginsAnotherStretch) {
  StretchWriter writer;
  writer.add(0.0, 1, 1, {}, std::vector{row_of(0, PoseKind::kShown, 0, 1)});
  writer.add(0.1, 2, 3, {}, std::vector{row_of(2, PoseKind::kShown, 0, 1)});
  const auto stretches = writer.finish();
  ASSERT_THAT(stretches, SizeIs(2));
  EXPECT_EQ(stretches[0].revision, 1u);
  EXPECT_EQ(stretches[1].revision, 2u);
  EXPECT_THAT(read(stretches[1]).front().second, SizeIs(1)) << "what the other scene had is not in this one";
}

TEST(StretchWriter, WhatStandsIsKeptOnce) {
  StretchWriter writer;
  for (int i = 0; i < 30; ++i) writer.add(i / kHz, 1, 1, {}, std::vector{row_of(0, PoseKind::kShown, 0, 1)});
  (void)writer.finish();
  EXPECT_EQ(writer.rows(), 1u);
}

}  // namespace peerd::recorded::stretch_writer_test
